"""Velocity gradient and density of Eulerian particles."""

import functools

import warp as wp

from .correction import make_gradient
from .coupling import make_counts
from .kernel_type import EULERIAN
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_kinematics(
    s: Spec,
    smoothing: Smoothing,
    corrected: bool,
    planes: bool,
    separate: bool = False,
    coupled: bool = False,
) -> wp.Kernel:
    """Build the velocity-gradient loop.

    Args:
        s: Specialisation.
        smoothing: Smoothing kernel.
        corrected: Mixed correction of the gradients.
        planes: Neighbour entries may be mirror images.
        separate: Neighbours of another body do not count.
        coupled: There are Lagrangian particles: their gradient is not found here.
    """
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    read = make_reads(s)
    lanes = make_lanes(s)
    worth, row_end = lanes.worth, lanes.row_end
    dim, counts = s.dim, make_counts(separate)
    options = (
        smoothing.name,
        "corrected" * corrected,
        "planes" * planes,
        "separate" * separate,
        "coupled" * coupled,
    )
    variant = "_".join(filter(None, options))

    @wp.kernel(module=s.module(__name__, variant, lanes=True))
    def velocity_gradient(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        vol: wp.array[real],
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        K: wp.array[mat],
        G: wp.array[vec],
        h: real,
        gradient_ratio: real,
        plane: point,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdx: wp.array[mat],
    ):
        """dvdx_a = Σ V_b (v_b - v_a) ⊗ g_ab [1/s] (section 3): exact for a linear v with corrected gradients."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        if wp.static(coupled):
            if kernel_type[i] != EULERIAN:
                return
        first = start[i]
        last = row_end(first, n_neigh[i])
        own = i * wp.static(int(corrected))  # K and G are one long where there is no correction
        xi, vi = read.point(x, i), read.vec(v, i)
        r_max2 = support * support * h * h
        # scalars, not a matrix: the compiler keeps them in registers
        xx, xy, xz = real(0.0), real(0.0), real(0.0)
        yx, yy, yz = real(0.0), real(0.0), real(0.0)
        zx, zy, zz = real(0.0), real(0.0), real(0.0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            sign = mirror.sign(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), sign, plane)
            r2 = tensor.dot(xij, xij)
            near = r2 < r_max2 and read.integer(neigh, k) != i
            if wp.static(separate):
                near = near and counts(body[i], read.integer(body, j), read.integer(kernel_type, j))
            if worth(near):
                r = wp.sqrt(r2)
                vji = mirror.vector(read.vec(v, j), sign) - vi
                dw, w_ij = wp.where(near, dw_r(r, h), real(0.0)), real(0.0)
                if wp.static(corrected):
                    w_ij = wp.where(near, w(r, h), real(0.0))
                g = of_pair(xij, dw, w_ij, read.mat(K, own), read.vec(G, own), h, gradient_ratio)
                u = read.real(vol, j) * vji
                xx += u[0] * g[0]
                if wp.static(dim > 1):
                    xy += u[0] * g[1]
                    yx += u[1] * g[0]
                    yy += u[1] * g[1]
                if wp.static(dim > 2):
                    xz += u[0] * g[2]
                    yz += u[1] * g[2]
                    zx += u[2] * g[0]
                    zy += u[2] * g[1]
                    zz += u[2] * g[2]
            k += 1
        dvdx[i] = mat(xx, xy, xz, yx, yy, yz, zx, zy, zz)

    return velocity_gradient
