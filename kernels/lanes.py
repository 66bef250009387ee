"""What a pair loop needs so that a CPU's compiler can handle several pairs at once, in the lanes of its vector registers.

Such a loop counts up in a ``while`` (Warp's ``range`` may count down, and asks every time around), has no ``continue`` and
stores nothing; it adds up scalars, and keeps a maximum by `raised`, a minimum by `lowered`. It reads vectors by `at`: a compiler loads a vector of
three single-precision numbers as two pieces, which it does not spread over lanes. What lies beyond the support is not
left out but counts nothing, with W = W' = 0: a branch costs more than the work it saves, except on a GPU (`worth`).
Its module is built with ``s.module(..., lanes=True)``, which lets the compiler add in another order: the same in every run.

A row ends at a multiple of the lanes, filled up with the particle itself: an entry that is no neighbour.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec


class Lanes(NamedTuple):
    """Device functions of this file, and the type that `raised` works on."""

    at: wp.Function
    spot: wp.Function
    worth: wp.Function
    raised: wp.Function
    lowered: wp.Function
    finite: wp.Function
    value: wp.Function
    row_end: wp.Function
    Bits: type


@functools.cache
def make_lanes(s: Spec) -> Lanes:
    """Build the functions for one specialisation."""
    real, vec, place, point, lanes = s.real, s.vec, s.place, s.point, s.lanes
    Bits = wp.int32 if real is wp.float32 else wp.int64
    exponent = wp.constant(Bits(0xFF << 23 if real is wp.float32 else 0x7FF << 52))

    @wp.func
    def at(a: wp.array2d[real], i: wp.int32):
        """a_i of an array of vectors, given as one of their components."""
        return vec(a[i, 0], a[i, 1], a[i, 2])

    @wp.func
    def spot(x: wp.array2d[place], i: wp.int32):
        """x_i of an array of positions, likewise."""
        return point(x[i, 0], x[i, 1], x[i, 2])

    if lanes == 1:

        @wp.func
        def worth(near: wp.bool):
            """Whether to handle a pair: a thread of a GPU need not fetch what counts nothing."""
            return near

    else:

        @wp.func
        def worth(near: wp.bool):
            """Whether to handle a pair: the lanes of a CPU always do."""
            return True

    @wp.func
    def raised(top: Bits, a: real):
        """The larger of two numbers that are not negative, the first given by its bits."""
        other = wp.cast(a, Bits)
        return wp.where(other > top, other, top)

    @wp.func
    def lowered(bottom: Bits, a: real):
        """The smaller of two numbers, one of which at most is negative, the first given by its bits."""
        other = wp.cast(a, Bits)
        return wp.where(other < bottom, other, bottom)

    @wp.func
    def finite(a: real):
        """Whether a number is finite, by its exponent: neither infinite nor NaN."""
        return (wp.cast(a, Bits) & exponent) != exponent

    @wp.func
    def value(top: Bits):
        """The number of these bits."""
        return wp.cast(top, real)

    @wp.func
    def row_end(first: wp.int32, n: wp.int32):
        """One past the last entry of a row of n neighbours, filled up to a multiple of the lanes."""
        return first + (n + wp.static(lanes - 1)) / wp.static(lanes) * wp.static(lanes)

    return Lanes(at, spot, worth, raised, lowered, finite, value, row_end, Bits)
