"""Equivalent strain of a deformation gradient, the measure that decides on conversion (method section 5)."""

import functools
import math
from collections.abc import Callable

import warp as wp

from .spec import Spec

SMALLEST_STRETCH2 = 1e-30
"""Floor of a squared principal stretch: round-off can make that of a flattened particle negative."""


@functools.cache
def make_strain(s: Spec, measure: str) -> wp.Function:
    """Build ``(F: mat, thickness, threshold) -> sqrt(2/3 ε':ε')`` [1], ε' the deviator of the strain measure.

    All three measures are isotropic functions of the stretches: a rotation before or after changes nothing. Out of the
    plane, F_zz is ``thickness`` in two dimensions (1 in plane strain) and F_yy = F_zz = 1 in one; whatever F holds
    there is not read. ``threshold`` saves the logarithmic measure of three dimensions work, nothing else reads it.
    """
    return MEASURES[measure](s)


def _whole(s: Spec) -> wp.Function:
    """F with the components that the problem's dimension prescribes."""
    real, mat = s.real, s.mat
    zero, one = real(0.0), real(1.0)

    if s.dim == 1:

        @wp.func
        def whole(F: mat, thickness: real):
            return mat(F[0, 0], zero, zero, zero, one, zero, zero, zero, one)

    elif s.dim == 2:

        @wp.func
        def whole(F: mat, thickness: real):
            return mat(F[0, 0], F[0, 1], zero, F[1, 0], F[1, 1], zero, zero, zero, thickness)

    else:

        @wp.func
        def whole(F: mat, thickness: real):
            return F

    return whole


def _magnitude(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    two_thirds, third = real(2.0 / 3.0), real(1.0 / 3.0)

    @wp.func
    def magnitude(A: mat):
        """sqrt(2/3 A':A') of the deviator A' of A."""
        dev = A - third * wp.trace(A) * wp.identity(n=3, dtype=real)
        return wp.sqrt(two_thirds * wp.ddot(dev, dev))

    return magnitude


def _green_lagrange(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    whole, magnitude = _whole(s), _magnitude(s)
    half = real(0.5)

    @wp.func
    def green_lagrange(F: mat, thickness: real, threshold: real):
        """Of E = (Fᵀ F - I)/2."""
        G = whole(F, thickness)
        return half * magnitude(wp.transpose(G) * G)

    return green_lagrange


def _almansi(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    whole, magnitude = _whole(s), _magnitude(s)
    half = real(0.5)

    @wp.func
    def almansi(F: mat, thickness: real, threshold: real):
        """Of e = (I - (F Fᵀ)^-1)/2."""
        G = wp.inverse(whole(F, thickness))
        return half * magnitude(wp.transpose(G) * G)

    return almansi


def _logarithmic(s: Spec) -> wp.Function:
    return {1: _logarithmic_line, 2: _logarithmic_plane, 3: _logarithmic_space}[s.dim](s)


def _logarithmic_line(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    two_thirds = real(2.0 / 3.0)

    @wp.func
    def logarithmic(F: mat, thickness: real, threshold: real):
        """Of ln(F Fᵀ)/2: 2/3 of |ln F_xx|."""
        return two_thirds * wp.abs(wp.log(wp.abs(F[0, 0])))

    return logarithmic


def _logarithmic_plane(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    half, two_thirds, three = real(0.5), real(2.0 / 3.0), real(3.0)

    @wp.func
    def logarithmic(F: mat, thickness: real, threshold: real):
        """Of ln(F Fᵀ)/2: 2/3 sqrt(3 d² + c²), 2 d the difference of the logarithmic stretches in the plane.

        c is their mean less the one across. The product of the stretches is the determinant; the smaller one comes
        from it, not from a difference.
        """
        J = wp.abs(F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0])
        xx = F[0, 0] * F[0, 0] + F[0, 1] * F[0, 1]
        yy = F[1, 0] * F[1, 0] + F[1, 1] * F[1, 1]
        xy = F[0, 0] * F[1, 0] + F[0, 1] * F[1, 1]
        diff = half * (xx - yy)
        largest = half * (xx + yy) + wp.sqrt(diff * diff + xy * xy)  # eigenvalue of F Fᵀ
        d = half * wp.log(largest / J)
        c = half * wp.log(J) - wp.log(thickness)
        return two_thirds * wp.sqrt(three * d * d + c * c)

    return logarithmic


def _logarithmic_space(s: Spec) -> wp.Function:
    real, vec, mat = s.real, s.vec, s.mat
    half, one, third, two_thirds = real(0.5), real(1.0), real(1.0 / 3.0), real(2.0 / 3.0)
    root = real(math.sqrt(2.0 / 3.0))
    floor = real(SMALLEST_STRETCH2)

    @wp.func
    def logarithmic(F: mat, thickness: real, threshold: real):
        """Of ln(F Fᵀ)/2; an upper bound of it where that is below the threshold: no eigenvalues are needed then."""
        b = F * wp.transpose(F)
        # The strain's deviator is that of ln(b/k)/2 for any k; take k = tr(b)/3. M = b/k - I has no trace, so that
        # none of its eigenvalues is larger in size than m = sqrt(2/3) |M|. Where m < 1, |ln(1 + μ)| <= c |μ| for all
        # |μ| <= m with c = -ln(1 - m)/m, and a deviator is no larger than its tensor: the equivalent strain is at most
        # sqrt(2/3) c |M|/2 = -ln(1 - m)/2. For small strains that is its value.
        k = third * wp.trace(b)
        M = (one / k) * b - wp.identity(n=3, dtype=real)
        m = root * wp.sqrt(wp.ddot(M, M))
        if m < one:
            bound = -half * wp.log(one - m)
            if bound < threshold:
                return bound
        _Q, stretch2 = wp.eig3(b)
        top = wp.max(stretch2, vec(floor, floor, floor))
        l = vec(half * wp.log(top[0]), half * wp.log(top[1]), half * wp.log(top[2]))
        mean = third * (l[0] + l[1] + l[2])
        dev = l - vec(mean, mean, mean)
        return wp.sqrt(two_thirds * wp.dot(dev, dev))

    return logarithmic


MEASURES: dict[str, Callable[[Spec], wp.Function]] = {
    "logarithmic": _logarithmic,
    "green-lagrange": _green_lagrange,
    "almansi": _almansi,
}
"""Every measure by its name in `warpsph.config`."""
