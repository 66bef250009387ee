"""What a Lagrangian pair loop reads of a neighbour: on a GPU in packets of 16 bytes, each of which is one load.

A warp reads a number of 32 neighbours in one go, and what that costs are the cache lines that these lie in. Numbers that
are read together stand in packets, four of single or two of double precision, and the packets of all particles that
are alike next to each other: neighbours then lie in as few lines as can be. A CPU reads the arrays that there are.
"""

import functools
from collections.abc import Sequence
from typing import NamedTuple

import warp as wp

from .lanes import NAMES, in_c, make_reads
from .spec import Spec

PACKET = 16
"""Bytes of a packet: the widest load of a thread."""

FIRST, SECOND, MORE = (0, 1, 2), (4, 5, 3), (6, 7)
"""Places of two vectors in a record, and of two numbers that may follow: with single precision the first vector is in one
packet, and in the plane double precision needs one packet for each."""

TENSOR = (0, 1, 4, 2, 3, 5, 6, 7, 8)
"""Places of the components of a tensor, row by row: those in the plane come first."""


class Layout(NamedTuple):
    """How records of a kind are stored: the k-th packets of all particles, then the next.

    Attributes:
        dtype: Type of the array.
        each: Its entries for each particle.
    """

    dtype: type
    each: int


class Near(NamedTuple):
    """Device functions that read of a particle j, from its own arrays on a CPU and from ``motion`` or ``rest`` on a GPU.

    Attributes:
        moving: (x, v, rho, cs, motion, j): x [m], v [m/s], ρ [kg/m³] and cs [m/s].
        resting: (X, G0, rest, j): X [m] and G0 [1/m].
        X: (X, rest, j): X alone.
        tensor: (T, j): a tensor that `put` has stored.
        put: (T, j, value): store it.
        motion: Layout of ``motion``.
        rest: Layout of ``rest``.
        tensors: Layout of an array of such tensors.
    """

    moving: wp.Function
    resting: wp.Function
    X: wp.Function
    tensor: wp.Function
    put: wp.Function
    motion: Layout
    rest: Layout
    tensors: Layout


class PackingKernels(NamedTuple):
    """Kernels of this file: they fill ``motion`` and ``rest``; only a GPU has use for them."""

    motion: wp.Kernel
    rest: wp.Kernel


def _layout(scalar: type, numbers: int) -> Layout:
    """Records of so many numbers in packets."""
    width = PACKET // wp.types.type_size_in_bytes(scalar)
    return Layout(wp.types.vector(width, scalar), -(-numbers // width))


def _read(layout: Layout, element: type, places: Sequence[int]) -> wp.Function:
    """Build the function (a, i) that reads the numbers at some places of record i, packet by packet."""
    width, (kind, parts) = layout.dtype._length_, in_c(element)
    scalar = NAMES[layout.dtype._wp_scalar_type_]
    packets = " ".join(
        f"const packet p{k} = *reinterpret_cast<const packet*>(a.data + {k} * n + i);"
        for k in sorted({place // width for place in places})
    )
    copies = " ".join(
        f"r{part} = p{place // width}.c[{place % width}];" for part, place in zip(parts, places, strict=True)
    )

    @wp.func_native(
        f"struct alignas({PACKET}) packet {{ {scalar} c[{width}]; }}; const int n = a.shape[0] / {layout.each}; "
        f"{packets} {kind} r; {copies} return r;"
    )
    def get(a: wp.array[layout.dtype], i: wp.int32) -> element: ...

    return get


def _write(layout: Layout, element: type, places: Sequence[int]) -> wp.Function:
    """Build the function (a, i, value) that writes the numbers at some places of record i."""
    width = layout.dtype._length_
    copies = " ".join(
        f"a.data[{place // width} * n + i].c[{place % width}] = value{part};"
        for part, place in zip(in_c(element)[1], places, strict=True)
    )

    @wp.func_native(f"const int n = a.shape[0] / {layout.each}; {copies}")
    def put(a: wp.array[layout.dtype], i: wp.int32, value: element): ...

    return put


@functools.cache
def make_near(s: Spec) -> Near:
    """Build the functions for one specialisation."""
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    motion, rest = _layout(s.place, 8), _layout(s.place, 6)
    Packet = motion.dtype

    if s.columns == 1:
        read = make_reads(s)
        point_of, vec_of, real_of = read.point, read.vec, read.real

        @wp.func
        def moving(
            x: wp.array[point],
            v: wp.array[vec],
            rho: wp.array[real],
            cs: wp.array[real],
            motion: wp.array[Packet],
            j: wp.int32,
        ):
            return point_of(x, j), vec_of(v, j), real_of(rho, j), real_of(cs, j)

        @wp.func
        def resting(X: wp.array[point], G0: wp.array[vec], rest: wp.array[Packet], j: wp.int32):
            return point_of(X, j), vec_of(G0, j)

        @wp.func
        def alone(X: wp.array[point], rest: wp.array[Packet], j: wp.int32):
            return point_of(X, j)

        @wp.func
        def put(T: wp.array[mat], j: wp.int32, value: mat):
            T[j] = value

        return Near(moving, resting, alone, read.mat, put, motion, rest, Layout(mat, 1))

    # all of a record at once: the compiler does not join loads of two functions
    tensors = _layout(real, 9)
    whole, both = (
        _read(layout, wp.types.vector(n, s.place), range(n)) for layout, n in ((motion, 8), (rest, 6))
    )
    X_of, tensor, put = _read(rest, point, FIRST), _read(tensors, mat, TENSOR), _write(tensors, mat, TENSOR)

    @wp.func
    def moving(
        x: wp.array[point],
        v: wp.array[vec],
        rho: wp.array[real],
        cs: wp.array[real],
        motion: wp.array[Packet],
        j: wp.int32,
    ):
        r = whole(motion, j)
        return point(r[0], r[1], r[2]), vec(real(r[4]), real(r[5]), real(r[3])), real(r[6]), real(r[7])

    @wp.func
    def resting(X: wp.array[point], G0: wp.array[vec], rest: wp.array[Packet], j: wp.int32):
        r = both(rest, j)
        return point(r[0], r[1], r[2]), vec(real(r[4]), real(r[5]), real(r[3]))

    @wp.func
    def alone(X: wp.array[point], rest: wp.array[Packet], j: wp.int32):
        return X_of(rest, j)

    return Near(moving, resting, alone, tensor, put, motion, rest, tensors)


@functools.cache
def make_packing(s: Spec, corrected: bool) -> PackingKernels:
    """Build the kernels for one specialisation; ``corrected``: there is a G0 for each particle."""
    real, vec, point = s.real, s.vec, s.point
    near, on = make_near(s), int(corrected)
    Packet = near.motion.dtype
    put_x, put_v = _write(near.motion, point, FIRST), _write(near.motion, vec, SECOND)
    put_rho, put_cs = (_write(near.motion, real, [place]) for place in MORE)
    put_X, put_G0 = _write(near.rest, point, FIRST), _write(near.rest, vec, SECOND)
    module = s.module(__name__, "corrected" * corrected)

    @wp.kernel(module=module)
    def pack_motion(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        rho: wp.array[real],
        cs: wp.array[real],
        # out:
        motion: wp.array[Packet],
    ):
        """Bring together x [m], v [m/s], ρ [kg/m³] and cs [m/s] of a particle."""
        i = wp.tid() + offset
        put_x(motion, i, x[i])
        put_v(motion, i, v[i])
        put_rho(motion, i, rho[i])
        put_cs(motion, i, cs[i])

    @wp.kernel(module=module)
    def pack_rest(
        offset: wp.int32,
        # in:
        X: wp.array[point],
        G0: wp.array[vec],
        # out:
        rest: wp.array[Packet],
    ):
        """Bring together X [m] and G0 [1/m] of a particle."""
        i = wp.tid() + offset
        put_X(rest, i, X[i])
        put_G0(rest, i, G0[i * on])

    return PackingKernels(pack_motion, pack_rest)
