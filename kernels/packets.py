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
from .tensor import make_tensor

PACKET = 16
"""Bytes of a packet: the widest load of a thread. It takes such loads to fill the memory of a GPU."""

FIRST, SECOND, NUMBER = (0, 1, 2), (4, 5, 3), 3
"""Places of a vector in a record, and of what may follow, a second one or a number: with single precision the first vector
is in one packet, and in the plane double precision needs one packet for each."""

COFACTOR, STRESS, SOUND = (0, 1, 8, 2, 3, 9, 10, 11, 12), (4, 5, 13, 6, 14, 15), 7
"""Places of the components of a tensor, row by row, of a symmetric one, and of a number: those in the plane come first."""


class Layout(NamedTuple):
    """How records of a kind are stored: the k-th packets of all particles, then the next.

    Attributes:
        dtype: Type of the array.
        each: Its entries for each particle.
    """

    dtype: type
    each: int


class Near(NamedTuple):
    """Device functions that read of a particle j: on a GPU a whole record r, once, of which the others take their part.

    On a CPU r is nothing, and each of them reads its own array, where it is needed: lanes are short of registers.

    Attributes:
        v: (v, motion, j): velocity [m/s].
        present: (site, j): a record r of x and ρ.
        x: (x, r, j): position [m].
        rho: (rho, r, j): density [kg/m³].
        resting: (rest, j): a record r of X and G0.
        X: (X, r, j): reference position [m].
        G0: (G0, r, j): correction in the reference configuration [1/m].
        X_alone: (X, rest, j): the same X, where nothing else is read.
        strained: (cof, j): a record r of cof, σ and cs.
        P_times: (P, r, j, b): P b.
        cof_times: (cof, r, j, b): cof b.
        cs: (cs, r, j): sound speed [m/s].
        cofactor: (cof, j): cof [-].
        piola: (P, sig, cof, j): P [Pa].
        put: (P, cof, j, cofactor, stress, cs): store cof and P = σ cof; on a GPU cof and σ, which are fewer numbers, and
            cs.
        motion: Layout of ``motion``, which is v.
        site: Layout of ``site``.
        rest: Layout of ``rest``.
        cofs: Layout of ``cof``; P is 1 long where that has σ.
    """

    v: wp.Function
    present: wp.Function
    x: wp.Function
    rho: wp.Function
    resting: wp.Function
    X: wp.Function
    G0: wp.Function
    X_alone: wp.Function
    strained: wp.Function
    P_times: wp.Function
    cof_times: wp.Function
    cs: wp.Function
    cofactor: wp.Function
    piola: wp.Function
    put: wp.Function
    motion: Layout
    site: Layout
    rest: Layout
    cofs: Layout


class PackingKernels(NamedTuple):
    """Kernels of this file, each fills the array of its name; only a GPU has use for them."""

    motion: wp.Kernel
    site: wp.Kernel
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
    return _from_arrays(s) if s.columns == 1 else _from_packets(s)


def _layouts(s: Spec) -> tuple[Layout, Layout, Layout]:
    """Those of ``motion``, ``site`` and ``rest``."""
    return _layout(s.real, 3), _layout(s.place, 4), _layout(s.place, 6)


def _from_arrays(s: Spec) -> Near:
    real, vec, mat, sym, point = s.real, s.vec, s.mat, s.sym, s.point
    tensor, read, (motion, site, rest) = make_tensor(s), make_reads(s), _layouts(s)
    product, unpack, Packet, Moving = tensor.product, tensor.unpack, rest.dtype, motion.dtype
    point_of, vec_of, real_of, mat_of = read.point, read.vec, read.real, read.mat

    @wp.func
    def nothing(packed: wp.array[Packet], j: wp.int32):
        return j

    @wp.func
    def v(v: wp.array[vec], motion: wp.array[Moving], j: wp.int32):
        return vec_of(v, j)

    @wp.func
    def place(x: wp.array[point], r: wp.int32, j: wp.int32):
        return point_of(x, j)

    @wp.func
    def vector(v: wp.array[vec], r: wp.int32, j: wp.int32):
        return vec_of(v, j)

    @wp.func
    def number(a: wp.array[real], r: wp.int32, j: wp.int32):
        return real_of(a, j)

    @wp.func
    def X_alone(X: wp.array[point], rest: wp.array[Packet], j: wp.int32):
        return point_of(X, j)

    @wp.func
    def strained(cof: wp.array[mat], j: wp.int32):
        return j

    @wp.func
    def times(T: wp.array[mat], r: wp.int32, j: wp.int32, b: vec):
        return product(mat_of(T, j), b)

    @wp.func
    def piola(P: wp.array[mat], sig: wp.array[sym], cof: wp.array[mat], j: wp.int32):
        return mat_of(P, j)

    @wp.func
    def put(P: wp.array[mat], cof: wp.array[mat], j: wp.int32, cofactor: mat, stress: sym, cs: real):
        cof[j] = cofactor
        P[j] = unpack(stress) * cofactor

    return Near(
        v, nothing, place, number, nothing, place, vector, X_alone,
        strained, times, times, number, read.mat, piola, put, motion, site, rest, Layout(mat, 1),
    )  # fmt: skip


def _from_packets(s: Spec) -> Near:
    real, vec, mat, sym, point = s.real, s.vec, s.mat, s.sym, s.point
    tensor, (motion, site, rest), cofs = make_tensor(s), _layouts(s), _layout(s.real, 16)
    product, act, unpack, Packets = tensor.product, tensor.act, tensor.unpack, cofs.dtype
    Present, Resting, Strained = (wp.types.vector(n, k) for n, k in ((4, s.place), (6, s.place), (16, real)))
    v_of, X_of, cofactor_of = _read(motion, vec, FIRST), _read(rest, point, FIRST), _read(cofs, mat, COFACTOR)
    put_cofactor, put_stress = _write(cofs, mat, COFACTOR), _write(cofs, sym, STRESS)
    put_sound = _write(cofs, real, [SOUND])

    @wp.func
    def v(v: wp.array[vec], motion: wp.array[motion.dtype], j: wp.int32):
        return v_of(motion, j)

    @wp.func
    def x(x: wp.array[point], r: Present, j: wp.int32):
        return point(r[0], r[1], r[2])

    @wp.func
    def rho(rho: wp.array[real], r: Present, j: wp.int32):
        return real(r[3])

    @wp.func
    def cs(cs: wp.array[real], r: Strained, j: wp.int32):
        return r[wp.static(SOUND)]

    @wp.func
    def X(X: wp.array[point], r: Resting, j: wp.int32):
        return point(r[0], r[1], r[2])

    @wp.func
    def G0(G0: wp.array[vec], r: Resting, j: wp.int32):
        return vec(real(r[4]), real(r[5]), real(r[3]))

    @wp.func
    def X_alone(X: wp.array[point], rest: wp.array[rest.dtype], j: wp.int32):
        return X_of(rest, j)

    @wp.func
    def cof_times(cof: wp.array[Packets], r: Strained, j: wp.int32, b: vec):
        return product(mat(r[0], r[1], r[8], r[2], r[3], r[9], r[10], r[11], r[12]), b)

    @wp.func
    def P_times(P: wp.array[mat], r: Strained, j: wp.int32, b: vec):
        turned = product(mat(r[0], r[1], r[8], r[2], r[3], r[9], r[10], r[11], r[12]), b)
        return act(sym(r[4], r[5], r[13], r[6], r[14], r[15]), turned)

    @wp.func
    def piola(P: wp.array[mat], sig: wp.array[sym], cof: wp.array[Packets], j: wp.int32):
        """σ is read from where it stands alone: that beside cof would be kept in registers."""
        return unpack(sig[j]) * cofactor_of(cof, j)

    @wp.func
    def put(P: wp.array[mat], cof: wp.array[Packets], j: wp.int32, cofactor: mat, stress: sym, cs: real):
        put_cofactor(cof, j, cofactor)
        put_stress(cof, j, stress)
        put_sound(cof, j, cs)

    present, resting, strained = (
        _read(layout, record, range(record._length_))
        for layout, record in ((site, Present), (rest, Resting), (cofs, Strained))
    )
    return Near(
        v, present, x, rho, resting, X, G0, X_alone,
        strained, P_times, cof_times, cs, cofactor_of, piola, put, motion, site, rest, cofs,
    )  # fmt: skip


@functools.cache
def make_packing(s: Spec, corrected: bool) -> PackingKernels:
    """Build the kernels for one specialisation; ``corrected``: there is a G0 for each particle."""
    real, vec, point = s.real, s.vec, s.point
    near, on = make_near(s), int(corrected)
    Packet, Moving = near.rest.dtype, near.motion.dtype
    put_v = _write(near.motion, vec, FIRST)
    put_x, put_rho = _write(near.site, point, FIRST), _write(near.site, real, [NUMBER])
    put_X, put_G0 = _write(near.rest, point, FIRST), _write(near.rest, vec, SECOND)
    module = s.module(__name__, "corrected" * corrected)

    @wp.kernel(module=module)
    def pack_motion(
        offset: wp.int32,
        # in:
        v: wp.array[vec],
        # out:
        motion: wp.array[Moving],
    ):
        """v [m/s] of a particle."""
        i = wp.tid() + offset
        put_v(motion, i, v[i])

    @wp.kernel(module=module)
    def pack_site(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        rho: wp.array[real],
        # out:
        site: wp.array[Packet],
    ):
        """Bring together x [m] and ρ [kg/m³] of a particle."""
        i = wp.tid() + offset
        put_x(site, i, x[i])
        put_rho(site, i, rho[i])

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

    return PackingKernels(pack_motion, pack_site, pack_rest)
