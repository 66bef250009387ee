"""Small vector and tensor algebra that knows which components move.

Storage is always three-dimensional; sums over components stop at the problem's dimension, which keeps
pair loops in 1D and 2D from multiplying zeros. A stress is stored as the six numbers of a symmetric tensor.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec


class Tensor(NamedTuple):
    """Device functions of this file."""

    dot: wp.Function
    product: wp.Function
    act: wp.Function
    trace: wp.Function
    pack: wp.Function
    unpack: wp.Function
    quadratic: wp.Function
    stretch: wp.Function
    rotate: wp.Function
    deviator: wp.Function
    von_mises: wp.Function
    curl: wp.Function


@functools.cache
def make_tensor(s: Spec) -> Tensor:
    """Build the functions for one specialisation."""
    real, vec, mat, sym, dim = s.real, s.vec, s.mat, s.sym, s.dim
    a_third = real(1.0 / 3.0)

    if dim == 1:

        @wp.func
        def dot(a: vec, b: vec):
            return a[0] * b[0]

        @wp.func
        def product(A: mat, b: vec):
            return vec(A[0, 0] * b[0], real(0.0), real(0.0))

        @wp.func
        def act(S: sym, b: vec):
            """S b of a symmetric tensor."""
            return vec(S[0] * b[0], real(0.0), real(0.0))

        @wp.func
        def quadratic(A: mat, b: vec):
            return A[0, 0] * b[0] * b[0]

    elif dim == 2:

        @wp.func
        def dot(a: vec, b: vec):
            return a[0] * b[0] + a[1] * b[1]

        @wp.func
        def product(A: mat, b: vec):
            return vec(A[0, 0] * b[0] + A[0, 1] * b[1], A[1, 0] * b[0] + A[1, 1] * b[1], real(0.0))

        @wp.func
        def act(S: sym, b: vec):
            """S b of a symmetric tensor."""
            return vec(S[0] * b[0] + S[3] * b[1], S[3] * b[0] + S[1] * b[1], real(0.0))

        @wp.func
        def quadratic(A: mat, b: vec):
            return A[0, 0] * (b[0] * b[0]) + (A[0, 1] + A[1, 0]) * (b[0] * b[1]) + A[1, 1] * (b[1] * b[1])

    else:

        @wp.func
        def dot(a: vec, b: vec):
            return wp.dot(a, b)

        @wp.func
        def product(A: mat, b: vec):
            return A * b

        @wp.func
        def act(S: sym, b: vec):
            """S b of a symmetric tensor."""
            return vec(
                S[0] * b[0] + S[3] * b[1] + S[5] * b[2],
                S[3] * b[0] + S[1] * b[1] + S[4] * b[2],
                S[5] * b[0] + S[4] * b[1] + S[2] * b[2],
            )

        @wp.func
        def quadratic(A: mat, b: vec):
            return wp.dot(b, A * b)

    @wp.func
    def trace(S: sym):
        """tr S of a symmetric tensor."""
        return S[0] + S[1] + S[2]

    @wp.func
    def pack(T: mat):
        """The six numbers of a symmetric tensor, from its upper triangle."""
        return sym(T[0, 0], T[1, 1], T[2, 2], T[0, 1], T[1, 2], T[0, 2])

    @wp.func
    def unpack(S: sym):
        """The symmetric tensor of six numbers."""
        return mat(S[0], S[3], S[5], S[3], S[1], S[4], S[5], S[4], S[2])

    rotate = _rotation_in_plane(s) if dim < 3 else _rotation(s)

    if dim < 3:

        @wp.func
        def stretch(L: mat):
            """Rate of deformation D = sym L [1/s]; nothing shears out of the plane."""
            shear, zero = real(0.5) * (L[0, 1] + L[1, 0]), real(0.0)
            return mat(L[0, 0], shear, zero, shear, L[1, 1], zero, zero, zero, L[2, 2])

    else:

        @wp.func
        def stretch(L: mat):
            """Rate of deformation D = sym L [1/s]."""
            return real(0.5) * (L + wp.transpose(L))

    @wp.func
    def deviator(T: mat):
        """T - tr(T)/3 I."""
        third = a_third * wp.trace(T)
        return mat(
            T[0, 0] - third, T[0, 1], T[0, 2],
            T[1, 0], T[1, 1] - third, T[1, 2],
            T[2, 0], T[2, 1], T[2, 2] - third,
        )  # fmt: skip

    @wp.func
    def von_mises(T: mat):
        """sqrt(3/2 T:T) of a symmetric deviator, from its upper triangle."""
        along = T[0, 0] * T[0, 0] + T[1, 1] * T[1, 1] + T[2, 2] * T[2, 2]
        shear = T[0, 1] * T[0, 1] + T[1, 2] * T[1, 2] + T[0, 2] * T[0, 2]
        return wp.sqrt(real(1.5) * along + real(3.0) * shear)

    @wp.func
    def curl(L: mat):
        """|curl v| of the velocity gradient [1/s]."""
        return wp.length(vec(L[2, 1] - L[1, 2], L[0, 2] - L[2, 0], L[1, 0] - L[0, 1]))

    return Tensor(
        dot, product, act, trace, pack, unpack, quadratic, stretch, rotate, deviator, von_mises, curl
    )


def _rotation(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat

    @wp.func
    def rotate(T: mat, L: mat, dt: real):
        """Q T Qᵀ, Q the Cayley rotation of the spin dt skew(L): keeps every invariant of T to round-off.

        The midpoint form of Jaumann's T + dt (Ω T - T Ω) of section 7 (Hughes & Winget 1980).
        """
        quarter, one = real(0.25) * dt, real(1.0)
        a = quarter * (L[2, 1] - L[1, 2])
        b = quarter * (L[0, 2] - L[2, 0])
        c = quarter * (L[1, 0] - L[0, 1])
        k = real(2.0) / (one + a * a + b * b + c * c)
        Q = mat(
            one - k * (b * b + c * c), k * (a * b - c), k * (a * c + b),
            k * (a * b + c), one - k * (a * a + c * c), k * (b * c - a),
            k * (a * c - b), k * (b * c + a), one - k * (a * a + b * b),
        )  # fmt: skip
        return Q * T * wp.transpose(Q)

    return rotate


def _rotation_in_plane(s: Spec) -> wp.Function:
    real, mat = s.real, s.mat
    one, two = real(1.0), real(2.0)

    @wp.func
    def rotate(T: mat, L: mat, dt: real):
        """Q T Qᵀ as in three dimensions, for a symmetric T without shear out of the plane and a spin in it."""
        a = real(0.25) * dt * (L[1, 0] - L[0, 1])
        scale = one / (one + a * a)
        c, k = (one - a * a) * scale, two * a * scale
        turn = k * k * (T[1, 1] - T[0, 0]) - two * c * k * T[0, 1]
        shear = (c * c - k * k) * T[0, 1] + c * k * (T[0, 0] - T[1, 1])
        zero = real(0.0)
        return mat(T[0, 0] + turn, shear, zero, shear, T[1, 1] - turn, zero, zero, zero, T[2, 2])

    return rotate
