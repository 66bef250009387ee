"""Control of zero-energy modes of Total Lagrangian particles (Ganzenmüller 2015)."""

import functools

import warp as wp

from .spec import Spec
from .tensor import make_tensor

CLOSEST = 1e-6
"""Floor of the distance of a pair over its reference one: a pair that meets has no direction."""


@functools.cache
def make_hourglass(s: Spec) -> wp.Function:
    """Build the pair function for one specialisation."""
    real, vec, mat = s.real, s.vec, s.mat
    tensor = make_tensor(s)
    dot, product = tensor.dot, tensor.product
    half, closest2 = real(0.5), real(CLOSEST**2)

    @wp.func
    def hourglass_force(
        Xij: vec, xij: vec, F_i: mat, F_j: mat, w0: real, alpha: real, E_i: real, E_j: real
    ) -> real:
        """s [Pa/m^(dim+1)] of the force f_ab = V0_a V0_b s x_ab/|x_ab| of b on a.

        s = α/2 W(X)/|X|² (E_a δ_a + E_b δ_b), X = X_a - X_b, δ_a = (F_a X - x)·x/|x| [m]: how much closer the pair
        is than its particles' deformation gradients say. It drives them apart where they are too close, is the same seen
        from b, and vanishes where the motion is affine (Ganzenmüller 2015, CMAME 286, 87-106, with E Young's modulus).
        """
        R2, r2 = dot(Xij, Xij), dot(xij, xij)
        r = wp.sqrt(wp.max(r2, closest2 * R2))
        error_i = dot(product(F_i, Xij), xij) - r2
        error_j = dot(product(F_j, Xij), xij) - r2
        return half * alpha * w0 * (E_i * error_i + E_j * error_j) / (R2 * r)

    return hourglass_force
