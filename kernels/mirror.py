"""Symmetry planes: a neighbour entry may name a mirror image of a particle.

An entry packs the particle's index with three bits, one per coordinate axis, that say in which planes
the image is reflected. A build without planes compiles to plain indices.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

INDEX_BITS = 28
"""Bits of an entry that hold the particle index; the three above hold the reflections."""


class Mirror(NamedTuple):
    """Device functions of this file; `sign` is +1 or -1 per component."""

    index: wp.Function
    sign: wp.Function
    point: wp.Function
    apart: wp.Function
    vector: wp.Function
    tensor: wp.Function
    symmetric: wp.Function


@functools.cache
def make_mirror(s: Spec, planes: bool) -> Mirror:
    """Build the functions; without ``planes`` they hand their argument through."""
    real, vec, mat, sym, position = s.real, s.vec, s.mat, s.sym, s.point
    low = wp.constant((1 << INDEX_BITS) - 1)

    @wp.func
    def index(entry: wp.int32):
        """Index of the particle. It is masked without planes too: the compiler then knows that it is not negative."""
        return entry & low

    if not planes:

        @wp.func
        def sign(entry: wp.int32):
            return vec(real(1.0), real(1.0), real(1.0))

        @wp.func
        def point(x: position, s: vec, plane: position):
            return x

        @wp.func
        def vector(v: vec, s: vec):
            return v

        @wp.func
        def tensor(T: mat, s: vec):
            return T

        @wp.func
        def symmetric(S: sym, s: vec):
            return S

    else:

        @wp.func
        def bit(entry: wp.int32, axis: wp.int32):
            if (entry >> (INDEX_BITS + axis)) & 1 == 1:
                return real(-1.0)
            return real(1.0)

        @wp.func
        def sign(entry: wp.int32):
            return vec(bit(entry, 0), bit(entry, 1), bit(entry, 2))

        @wp.func
        def point(x: position, s: vec, plane: position):
            return wp.cw_mul(position(s), x - plane) + plane

        @wp.func
        def vector(v: vec, s: vec):
            return wp.cw_mul(s, v)

        @wp.func
        def tensor(T: mat, s: vec):
            return wp.cw_mul(T, wp.outer(s, s))

        @wp.func
        def symmetric(S: sym, s: vec):
            return sym(S[0], S[1], S[2], s[0] * s[1] * S[3], s[1] * s[2] * S[4], s[0] * s[2] * S[5])

    @wp.func
    def apart(x_i: position, x_j: position, s: vec, plane: position):
        """x_i less the image of x_j [m], rounded from the precision of positions once."""
        return vec(x_i - point(x_j, s, plane))

    return Mirror(index, sign, point, apart, vector, tensor, symmetric)
