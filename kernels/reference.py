"""Gradients in the reference configuration, found once and kept (method section 4; paper A eq 2)."""

import functools

import warp as wp

from .correction import make_gradient
from .kernel_type import ERODED
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_reference(s: Spec, smoothing: Smoothing, corrected: bool, planes: bool) -> wp.Kernel:
    """Build the kernel that fills the rows of gradients."""
    real, vec, mat = s.real, s.vec, s.mat
    mirror, dot, of_pair = make_mirror(s, planes), make_tensor(s).dot, make_gradient(s, corrected)
    w, dw_r = smoothing.w, smoothing.dw_r
    on = wp.constant(int(corrected))
    options = (smoothing.name, "corrected" * corrected, "planes" * planes)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options))))
    def reference_gradient(
        offset: wp.int32,
        # in:
        X: wp.array[vec],
        vol0: wp.array[real],
        kernel_type: wp.array[wp.int32],
        K: wp.array[mat],
        G: wp.array[vec],
        h: real,
        gradient_ratio: real,
        plane: vec,
        dt: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        # out:
        g0: wp.array[vec],
        g0_back: wp.array[vec],
    ):
        """g0 = V0_b g0_ab and g0_back = V0_b g0_ba [1/m], of X and V0 alone; without correction g0_ba = -g0_ab is not kept.

        An eroded neighbour has none.
        """
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        own = i * on
        for k in range(start0[i], start0[i] + n_neigh0[i]):
            j = mirror.index(neigh0[k])
            sign = mirror.sign(neigh0[k])
            Xij = X[i] - mirror.point(X[j], sign, plane)
            r = wp.sqrt(dot(Xij, Xij))
            dw, w_ij, V_j = dw_r(r, h), w(r, h), real(vol0[j])
            if kernel_type[j] == ERODED:
                V_j = real(0.0)
            g0[k] = V_j * of_pair(Xij, dw, w_ij, K[own], G[own], h, gradient_ratio)
            if wp.static(corrected):
                K_j, G_j = mirror.tensor(K[j], sign), mirror.vector(G[j], sign)
                g0_back[k] = V_j * of_pair(-Xij, dw, w_ij, K_j, G_j, h, gradient_ratio)

    return reference_gradient
