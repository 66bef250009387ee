"""Trials of data layouts: one force loop over neighbours that are found, and particles that are stored, in several ways.

No run uses these kernels; `warpsph.quality.layouts` times them. All layouts sum the same terms, those of a plain
Eulerian step: stress and artificial viscosity.
"""

import functools
from dataclasses import dataclass
from typing import NamedTuple

import warp as wp

from .smoothing import make_smoothing
from .spec import Spec
from .viscosity import make_viscosity

GROUP = 32
"""Rows that are stored side by side in ``columns``: the threads of a warp then read neighbouring entries."""

LISTS = ("rows", "columns", "cells", "grid")
"""Where a particle's neighbours come from: a row of entries; rows of 32 particles stored entry by entry; the cells
around it, of sorted particles; Warp's hash grid."""


@dataclass(frozen=True)
class Layout:
    """One way to store and to compute.

    Attributes:
        lists: One of `LISTS`.
        stress: Numbers that a stress is stored as, 9 or 6.
        wide: Positions and their differences are float64, whatever the rest is.
        short: An entry is a difference of indices in 16 bits, instead of an index in 32.
        registers: Registers of a thread at most on CUDA; 0: as the compiler likes.
    """

    lists: str = "rows"
    stress: int = 9
    wide: bool = False
    short: bool = False
    registers: int = 0

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        flags = ("wide" * self.wide, "short" * self.short, f"r{self.registers}" if self.registers else "")
        return "_".join([self.lists, f"s{self.stress}", *filter(None, flags)])


class LayoutKernels(NamedTuple):
    """Kernels of this file, and the types of the arrays that depend on the layout."""

    search: wp.Kernel
    force: wp.Kernel
    place: type
    point: type
    stress: type
    entry: type


@functools.cache
def make_layouts(s: Spec, layout: Layout) -> LayoutKernels:
    """Build search and force for one layout; three dimensions, cubic spline."""
    real, vec = s.real, s.vec
    place = wp.float64 if layout.wide else real
    point = wp.types.vector(3, place)
    stress = s.mat if layout.stress == 9 else wp.types.vector(6, real)
    entry = wp.int16 if layout.short else wp.int32
    Sums = wp.types.vector(4, real)
    smoothing, viscosity = make_smoothing(s, "cubic_spline"), make_viscosity(s)
    dw_r, support, half, zero = smoothing.dw_r, smoothing.support, real(0.5), real(0.0)
    lists, step = layout.lists, wp.constant(GROUP if layout.lists == "columns" else 1)
    module = s.module(__name__, layout.tag)
    options = {"cuda_max_registers": layout.registers} if layout.registers else {}

    @wp.func
    def apart(a: point, b: point):
        """Difference of positions, rounded once."""
        d = a - b
        return vec(real(d[0]), real(d[1]), real(d[2]))

    @wp.func
    def cell_of(x: point, low: point, side: place, n_x: wp.int32, n_xy: wp.int32):
        c = (x - low) / side
        return wp.int32(wp.floor(c[0])) + n_x * wp.int32(wp.floor(c[1])) + n_xy * wp.int32(wp.floor(c[2]))

    @wp.func
    def row_of(box: wp.int32, n_x: wp.int32, n_xy: wp.int32):
        """Offset of the first of three cells side by side along x, out of nine such triples around a cell."""
        return (box % 3 - 1) * n_x + (box / 3 - 1) * n_xy - 1

    if layout.stress == 9:

        @wp.func
        def times(A: stress, b: vec):
            return A * b

    else:

        @wp.func
        def times(A: stress, b: vec):
            """Components xx, yy, zz, xy, yz, xz."""
            return vec(
                A[0] * b[0] + A[3] * b[1] + A[5] * b[2],
                A[3] * b[0] + A[1] * b[1] + A[4] * b[2],
                A[5] * b[0] + A[4] * b[1] + A[2] * b[2],
            )

    @wp.func
    def term(
        j: wp.int32,
        xij: vec,
        v_i: vec,
        rho_i: real,
        cs_i: real,
        sig_i: stress,
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        cs: wp.array[real],
        sig: wp.array[stress],
        h: real,
        viscosity_alpha: real,
        viscosity_beta: real,
    ):
        """What a neighbour adds to force [N/m³] and power [W/m³]; zero for i itself."""
        r2 = wp.dot(xij, xij)
        g = dw_r(wp.sqrt(r2), h) * xij
        vji = v[j] - v_i
        inner = times(sig_i, g)
        f = vol[j] * (inner + times(sig[j], g))
        power = vol[j] * wp.dot(vji, inner)
        closing = -wp.dot(vji, xij)
        if closing < zero:
            mu = viscosity.approach(closing, r2, h)
            pi = viscosity.pressure(
                mu, half * (cs_i + cs[j]), half * (rho_i + rho[j]), viscosity_alpha, viscosity_beta
            )
            drag = (-m[j] * rho_i * pi) * g
            f += drag
            power += half * wp.dot(vji, drag)
        return Sums(f[0], f[1], f[2], power)

    @wp.kernel(module=module)
    def search(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        low: point,
        side: place,
        n_x: wp.int32,
        n_xy: wp.int32,
        cell_start: wp.array[wp.int32],
        radius: place,
        start: wp.array[wp.int32],
        room: wp.int32,
        # out:
        neigh: wp.array[entry],
        n_neigh: wp.array[wp.int32],
        furthest: wp.array[wp.int32],
    ):
        """Count the neighbours |x_i - x_j| < radius and write those for which there is ``room``; i itself is left out."""
        i = wp.tid() + offset
        home = cell_of(x[i], low, side, n_x, n_xy)
        n, reach, boxes = wp.int32(0), wp.int32(0), wp.int32(9)
        for box in range(boxes):
            row = home + row_of(box, n_x, n_xy)
            for j in range(cell_start[row], cell_start[row + 3]):
                d = x[i] - x[j]
                if wp.dot(d, d) < radius * radius and j != i:
                    if n < room:
                        neigh[start[i] + n * step] = entry(j - wp.where(wp.static(layout.short), i, 0))
                    n += 1
                    reach = wp.max(reach, wp.abs(j - i))
        n_neigh[i] = n
        furthest[i] = reach

    @wp.kernel(module=module, **options)
    def force(
        offset: wp.int32,
        # in:
        grid: wp.uint64,
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        cs: wp.array[real],
        sig: wp.array[stress],
        h: real,
        viscosity_alpha: real,
        viscosity_beta: real,
        low: point,
        side: place,
        n_x: wp.int32,
        n_xy: wp.int32,
        cell_start: wp.array[wp.int32],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[entry],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
    ):
        """dvdt = Σ f_ab / m_a [m/s²] and dedt [W/kg] of stress and artificial viscosity (section 3; paper A eq 1)."""
        i = wp.tid() + offset
        x_i, v_i, rho_i, cs_i, sig_i = x[i], v[i], rho[i], cs[i], sig[i]
        reach = real(support) * h
        reach2 = reach * reach
        total = Sums()
        if wp.static(lists == "rows" or lists == "columns"):
            for k in range(n_neigh[i]):
                j = wp.int32(neigh[start[i] + k * step])
                if wp.static(layout.short):
                    j += i
                xij = apart(x_i, x[j])
                if wp.dot(xij, xij) < reach2:
                    total += term(
                        j,
                        xij,
                        v_i,
                        rho_i,
                        cs_i,
                        sig_i,
                        v,
                        m,
                        rho,
                        vol,
                        cs,
                        sig,
                        h,
                        viscosity_alpha,
                        viscosity_beta,
                    )
        if wp.static(lists == "cells"):
            home = cell_of(x_i, low, side, n_x, n_xy)
            boxes = wp.int32(9)
            for box in range(boxes):
                row = home + row_of(box, n_x, n_xy)
                for j in range(cell_start[row], cell_start[row + 3]):
                    xij = apart(x_i, x[j])
                    if wp.dot(xij, xij) < reach2:
                        total += term(
                            j,
                            xij,
                            v_i,
                            rho_i,
                            cs_i,
                            sig_i,
                            v,
                            m,
                            rho,
                            vol,
                            cs,
                            sig,
                            h,
                            viscosity_alpha,
                            viscosity_beta,
                        )
        if wp.static(lists == "grid"):
            for j in wp.hash_grid_query(grid, x_i, place(reach)):
                xij = apart(x_i, x[j])
                if wp.dot(xij, xij) < reach2:
                    total += term(
                        j,
                        xij,
                        v_i,
                        rho_i,
                        cs_i,
                        sig_i,
                        v,
                        m,
                        rho,
                        vol,
                        cs,
                        sig,
                        h,
                        viscosity_alpha,
                        viscosity_beta,
                    )
        per_mass = real(1.0) / rho_i
        dvdt[i] = per_mass * vec(total[0], total[1], total[2])
        dedt[i] = per_mass * total[3]

    return LayoutKernels(search, force, place, point, stress, entry)
