"""Velocity gradient and density of Eulerian particles."""

import functools

import warp as wp

from .correction import make_gradient
from .coupling import KINEMATICS, PURE, Coupling, make_coupling
from .kernel_type import EULERIAN
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
    coupling: Coupling = PURE,
    kept: bool = False,
) -> wp.Kernel:
    """Build the velocity-gradient loop; that of Lagrangian particles is not found here.

    Args:
        s: Specialisation.
        smoothing: Smoothing kernel.
        corrected: Mixed-corrected gradients.
        planes: Neighbour entries may be mirror images.
        coupling: Which pairs count.
        kept: The force loop has left behind the pairs that count, with their (dW/dr)/r.
    """
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    terms_of, coupled = make_coupling(s, coupling), bool(coupling.form)
    picky = bool(coupling.tag) and not kept  # not every pair within the support counts
    dim = s.dim
    pairs = "kept" if kept else coupling.tag
    options = (smoothing.name, "corrected" * corrected, "planes" * planes, "coupled" * coupled, pairs)
    variant = "_".join(filter(None, options))

    @wp.kernel(module=s.module(__name__, variant))
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
        n_near: wp.array[wp.int32],
        near: wp.array[wp.int32],
        slope: wp.array[real],
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
        own = i * wp.static(int(corrected))  # K and G are one long where there is no correction
        xi, vi = x[i], v[i]
        # scalars, not a matrix: the compiler keeps them in registers
        xx, xy, xz = real(0.0), real(0.0), real(0.0)
        yx, yy, yz = real(0.0), real(0.0), real(0.0)
        zx, zy, zz = real(0.0), real(0.0), real(0.0)
        for k in range(first, first + n_near[i]):
            j = mirror.index(near[k])
            sign = mirror.sign(near[k])
            xij = mirror.apart(xi, x[j], sign, plane)
            dw = real(0.0)
            if wp.static(kept):
                dw = slope[k]
            else:
                r2 = tensor.dot(xij, xij)
                if r2 >= support * support * h * h:
                    continue
                dw = dw_r(wp.sqrt(r2), h)
            if wp.static(picky):
                bits = terms_of(kernel_type[i], kernel_type[j], body[i] == body[j], vec(), support * h)
                if (bits & wp.static(KINEMATICS)) == 0:
                    continue
            vji = mirror.vector(v[j], sign) - vi
            w_ij = real(0.0)
            if wp.static(corrected):
                w_ij = w(wp.sqrt(tensor.dot(xij, xij)), h)
            g = of_pair(xij, dw, w_ij, K[own], G[own], h, gradient_ratio)
            u = vol[j] * vji
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
        dvdx[i] = mat(xx, xy, xz, yx, yy, yz, zx, zy, zz)

    return velocity_gradient
