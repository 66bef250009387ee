"""What a pair loop needs so that a CPU's compiler can handle several pairs at once, in the lanes of its vector registers.

Such a loop counts up in a ``while`` (Warp's ``range`` may count down, and asks every time around), has no ``continue`` and
stores nothing; it adds up scalars, and keeps a maximum by `raised`, a minimum by `lowered`, and either of numbers of any
sign by their `rank`. It reads its neighbours by
`make_reads`. What lies beyond the support is not left out but counts nothing, with W = W' = 0: a branch costs more than the
work it saves, except on a GPU (`worth`).
Its module is built with ``s.module(..., lanes=True)``, which lets the compiler add in another order: the same in every run.

A row ends at a multiple of the lanes, filled up with the particle itself: an entry that is no neighbour.

On a GPU rows stand in columns, 32 of them side by side (`Spec.columns`): a row goes on with a stride of 32, and a warp
reads the k-th entries of its particles in one piece.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

NAMES = {wp.int32: "int", wp.float32: "float", wp.float64: "double"}
"""Scalar types by their names in C."""


class Lanes(NamedTuple):
    """Device functions of this file, the type that `raised` works on, and the stride from an entry of a row to the next."""

    worth: wp.Function
    raised: wp.Function
    lowered: wp.Function
    rank: wp.Function
    ranked: wp.Function
    finite: wp.Function
    value: wp.Function
    filled: wp.Function
    row_end: wp.Function
    last_end: wp.Function
    Bits: type
    stride: int


class Reads(NamedTuple):
    """Device functions ``(a, i)`` that read the element i of an array, by the type of its elements."""

    integer: wp.Function
    real: wp.Function
    vec: wp.Function
    point: wp.Function
    sym: wp.Function
    mat: wp.Function


def make_reads(s: Spec) -> Reads:
    """Build the functions for one specialisation."""
    return Reads(*map(_read, (wp.int32, s.real, s.vec, s.point, s.sym, s.mat)))


@functools.cache
def _read(element: type) -> wp.Function:
    """Build the function that reads an array without gaps, number by number.

    Warp reads an array with the stride that it has at run time. The compiler then gathers even what lies side by side,
    and multiplies to find it; a vector of three single-precision numbers it reads in two pieces.
    """
    kind, parts = in_c(element)
    copies = " ".join(f"r{part} = a.data[i]{part};" for part in parts)

    @wp.func_native(f"{kind} r; {copies} return r;")
    def get(a: wp.array[element], i: wp.int32) -> element: ...

    return get


def in_c(element: type) -> tuple[str, list[str]]:
    """The name in C of a scalar, vector or matrix type, and what to put after a variable for each of its numbers."""
    if element in NAMES:
        return NAMES[element], [""]
    name, shape = NAMES[element._wp_scalar_type_], element._shape_
    if len(shape) == 1:
        return f"wp::vec_t<{shape[0]}, {name}>", [f".c[{k}]" for k in range(shape[0])]
    parts = [f".data[{row}][{column}]" for row in range(shape[0]) for column in range(shape[1])]
    return f"wp::mat_t<{shape[0]}, {shape[1]}, {name}>", parts


@functools.cache
def make_lanes(s: Spec) -> Lanes:
    """Build the functions for one specialisation."""
    real, lanes, stride = s.real, s.lanes, s.columns
    Bits = wp.int32 if real is wp.float32 else wp.int64
    exponent = wp.constant(Bits(0xFF << 23 if real is wp.float32 else 0x7FF << 52))
    below_sign = wp.constant(Bits(2**31 - 1 if real is wp.float32 else 2**63 - 1))

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
    def rank(a: real):
        """A whole number that is smaller where the number is, negative ones too: those have their bits turned around."""
        bits = wp.cast(a, Bits)
        return wp.where(bits < Bits(0), bits ^ below_sign, bits)

    @wp.func
    def ranked(place: Bits):
        """The number of this rank."""
        return wp.cast(wp.where(place < Bits(0), place ^ below_sign, place), real)

    @wp.func
    def finite(a: real):
        """Whether a number is finite, by its exponent: neither infinite nor NaN."""
        return (wp.cast(a, Bits) & exponent) != exponent

    @wp.func
    def value(top: Bits):
        """The number of these bits."""
        return wp.cast(top, real)

    @wp.func
    def filled(n: wp.int32):
        """Entries of a row of n neighbours, filled up to a multiple of the lanes."""
        return (n + wp.static(lanes - 1)) / wp.static(lanes) * wp.static(lanes)

    @wp.func
    def row_end(first: wp.int32, n: wp.int32):
        """Where a row of n neighbours has come to its end, going on by ``stride`` from its first entry; filled up."""
        return first + filled(n) * wp.static(stride)

    @wp.func
    def last_end(first: wp.int32, n: wp.int32):
        """The same without what fills it up."""
        return first + n * wp.static(stride)

    return Lanes(worth, raised, lowered, rank, ranked, finite, value, filled, row_end, last_end, Bits, stride)
