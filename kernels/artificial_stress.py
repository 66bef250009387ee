"""Artificial stress against the tensile instability (Gray, Monaghan & Swift 2001; method section 3)."""

import functools

import warp as wp

from .spec import Spec
from .tensor import make_tensor

EPSILON = 0.3
"""Strength of the artificial stress; the exponent n = 4 is in the pair loop."""


@functools.cache
def make_artificial_stress(s: Spec) -> wp.Kernel:
    """Build the kernel: closed form in 1D and 2D, a symmetric eigendecomposition in 3D."""
    real, mat = s.real, s.mat
    eps, half, zero, two_thirds = real(EPSILON), real(0.5), real(0.0), real(2.0 / 3.0)
    tensor = make_tensor(s)

    if s.dim == 1:

        @wp.func
        def tensile(T: mat):
            return mat(wp.max(T[0, 0], zero), zero, zero, zero, zero, zero, zero, zero, zero)

    elif s.dim == 2:

        @wp.func
        def tensile(T: mat):
            """The tensile part of the in-plane stress, Σ max(s_k, 0) n_k ⊗ n_k."""
            mean = half * (T[0, 0] + T[1, 1])
            diff = half * (T[0, 0] - T[1, 1])
            shear = half * (T[0, 1] + T[1, 0])
            radius = wp.sqrt(diff * diff + shear * shear)
            high = wp.max(mean + radius, zero)
            low = wp.max(mean - radius, zero)
            centre = half * (high + low)
            scale = real(0.0)
            if radius > zero:
                scale = half * (high - low) / radius
            out = mat()
            out[0, 0] = centre + scale * diff
            out[1, 1] = centre - scale * diff
            out[0, 1] = scale * shear
            out[1, 0] = scale * shear
            return out

    else:

        @wp.func
        def tensile(T: mat):
            """The tensile part of the stress, Σ max(s_k, 0) n_k ⊗ n_k; no s_k exceeds the mean plus 2/3 of von Mises."""
            dev = tensor.deviator(T)
            if wp.trace(T) / real(3.0) + two_thirds * tensor.von_mises(dev) <= zero:
                return mat()
            Q, d = wp.eig3(half * (T + wp.transpose(T)))
            return Q * wp.diag(wp.max(d, s.vec())) * wp.transpose(Q)

    @wp.kernel(module=s.module(__name__))
    def artificial_stress(
        offset: wp.int32,
        # in:
        sig: wp.array[s.sym],
        rho: wp.array[real],
        dt: wp.array[real],
        # out:
        R: wp.array[s.sym],
    ):
        """R_a = -0.3 tensile(σ_a) / ρ_a² [Pa m⁶/kg²] (section 3; Gray et al. 2001)."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        R[i] = (-eps / (rho[i] * rho[i])) * tensor.pack(tensile(tensor.unpack(sig[i])))

    return artificial_stress
