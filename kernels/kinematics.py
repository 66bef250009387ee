"""Velocity gradient and density of Eulerian particles."""

import functools

import warp as wp

from .correction import make_gradient
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_kinematics(s: Spec, smoothing: Smoothing, corrected: bool, planes: bool) -> wp.Kernel:
    """Build the velocity-gradient loop."""
    real, vec, mat = s.real, s.vec, s.mat
    mirror, tensor, gradient = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    variant = "_".join(p for p in (smoothing.name, "corrected" * corrected, "planes" * planes) if p)

    @wp.func
    def outer(a: vec, b: vec):
        """a ⊗ b in the components that move."""
        out = mat()
        for p in range(wp.static(s.dim)):
            for q in range(wp.static(s.dim)):
                out[p, q] = a[p] * b[q]
        return out

    @wp.kernel(module=s.module(__name__, variant))
    def velocity_gradient(
        offset: wp.int32,
        # in:
        x: wp.array[vec],
        v: wp.array[vec],
        vol: wp.array[real],
        K: wp.array[mat],
        G: wp.array[vec],
        h: real,
        gradient_ratio: real,
        plane: vec,
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
        first = start[i]
        xi, vi = x[i], v[i]
        r_max2 = support * support * h * h
        L = mat()
        for k in range(first, first + n_neigh[i]):
            j = mirror.index(neigh[k])
            sign = mirror.sign(neigh[k])
            xij = xi - mirror.point(x[j], sign, plane)
            r2 = tensor.dot(xij, xij)
            if r2 < r_max2:
                r = wp.sqrt(r2)
                vji = mirror.vector(v[j], sign) - vi
                if wp.static(corrected):
                    g = gradient.of_pair(xij, dw_r(r, h), w(r, h), K[i], G[i], h, gradient_ratio)
                    L += outer(vol[j] * vji, g)
                else:
                    L += outer((vol[j] * dw_r(r, h)) * vji, xij)
        dvdx[i] = L

    return velocity_gradient
