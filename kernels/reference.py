"""What the loops over reference neighbours need of a pair, found once and kept (method section 4; paper A eq 2).

Kept are V0_b W'/r and, with the correction, V0_b W, from which both gradients of a pair follow: with X = X_a - X_b
V0_b g0_ab = K_a (V0_b W'/r X - V0_b W G_a) and V0_b g0_ba = -K_b (V0_b W'/r X + V0_b W G_b). That is a third of the memory
that the two gradients would take, and reading them is what the loops wait for. There is no limiter of the ratio to the
plain gradient as in the present configuration: a lattice has no need of one, and F stays exact everywhere.
"""

import functools

import warp as wp

from .kernel_type import ERODED
from .lanes import make_lanes
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_reference(s: Spec, smoothing: Smoothing, corrected: bool, planes: bool) -> wp.Kernel:
    """Build the kernel that fills the rows."""
    real, vec, point = s.real, s.vec, s.point
    mirror, dot = make_mirror(s, planes), make_tensor(s).dot
    w, dw_r = smoothing.w, smoothing.dw_r
    lanes = make_lanes(s)
    last_end, stride = lanes.last_end, lanes.stride
    options = (smoothing.name, "corrected" * corrected, "planes" * planes)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options))))
    def reference_pairs(
        offset: wp.int32,
        # in:
        X: wp.array[point],
        vol0: wp.array[real],
        kernel_type: wp.array[wp.int32],
        G0: wp.array[vec],
        h: real,
        plane: point,
        dt: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        # out:
        slope0: wp.array[real],
        w0: wp.array[real],
        q0_sum: wp.array[vec],
    ):
        """slope0 = V0_b W'/r [1/m²], w0 = V0_b W [-] and q0_sum = Σ V0_b K⁻¹ g0_ab [1/m]; zero of eroded neighbours."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        sum_s, sum_w = vec(), real(0.0)
        for k in range(start0[i], last_end(start0[i], n_neigh0[i]), stride):
            j = mirror.index(neigh0[k])
            Xij = mirror.apart(X[i], X[j], mirror.sign(neigh0[k]), plane)
            r, V_j = wp.sqrt(dot(Xij, Xij)), real(vol0[j])
            if kernel_type[j] == ERODED:
                V_j = real(0.0)
            slope = V_j * dw_r(r, h)
            slope0[k] = slope
            sum_s += slope * Xij
            if wp.static(corrected):
                w0[k] = V_j * w(r, h)
                sum_w += V_j * w(r, h)
        if wp.static(corrected):
            sum_s -= sum_w * G0[i]
        q0_sum[i] = sum_s

    return reference_pairs
