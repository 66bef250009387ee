"""Cells of space: particles in the order of their cells, so that those near a point stand in a few runs of that order.

A cell is as wide as the rows' reach along y and z, and a quarter of that along x. Cells are numbered line by line along x;
numbers repeat every ``period`` cells along each axis, powers of two, so that space has no end.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

ALONG = 4
"""Cells along x in the reach of the rows."""

MARGIN = 0.01
"""Share by which cells are wider than they need be, for the rounding of coordinates."""

FEWEST = (16, 4, 4)
"""Cells along x, y and z at least: no search then meets one twice."""


class Cells(NamedTuple):
    """Kernels and device functions of this file."""

    keys: wp.Kernel
    counts: wp.Kernel
    coordinates: wp.Function
    beyond: wp.Function
    number: wp.Function
    runs: wp.Function


@functools.cache
def make_cells(s: Spec) -> Cells:
    """Build the kernels for one specialisation."""
    real, place, point = s.real, s.place, s.point
    module = s.module(__name__)

    @wp.func
    def within(c: place):
        return wp.clamp(c, place(-1.0e9), place(1.0e9))

    @wp.func
    def coordinates(x: point, cell_scale: point):
        """Position in units of cells; what is too far away for an integer comes to where it is not."""
        u = wp.cw_mul(x, cell_scale)
        return point(within(u[0]), within(u[1]), within(u[2]))

    @wp.func
    def beyond(f: real, c: wp.int32):
        """How far a coordinate in cell 0 is away from cell c [cells]."""
        return wp.max(wp.abs(f - real(c) - real(0.5)) - real(0.5), real(0.0))

    @wp.func
    def number(c_x: wp.int32, c_y: wp.int32, c_z: wp.int32, period: wp.vec3i):
        """Number of a cell."""
        line = (c_y & (period[1] - 1)) + period[1] * (c_z & (period[2] - 1))
        return (c_x & (period[0] - 1)) + period[0] * line

    @wp.func
    def runs(cell_start: wp.array[wp.int32], line: wp.int32, length: wp.int32, u: place, half: place):
        """First place, and one past the last, of the cells within ``half`` of u on a line; twice, for it may close on itself.

        ``line`` is the number of its first cell, ``length`` how many it has.
        """
        low = line + (wp.int32(wp.floor(u - half)) & (length - 1))
        high = line + (wp.int32(wp.floor(u + half)) & (length - 1))
        if low <= high:
            return cell_start[low], cell_start[high + 1], 0, 0
        return cell_start[low], cell_start[line + length], cell_start[line], cell_start[high + 1]

    @wp.kernel(module=module)
    def keys(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        cell_scale: point,
        period: wp.vec3i,
        # out:
        key: wp.array[wp.int32],
        order: wp.array[wp.int32],
    ):
        """Number of a particle's cell, and the order that is to be sorted by it."""
        i = wp.tid() + offset
        u = coordinates(x[i], cell_scale)
        key[i] = number(wp.int32(wp.floor(u[0])), wp.int32(wp.floor(u[1])), wp.int32(wp.floor(u[2])), period)
        order[i] = i

    @wp.kernel(module=module)
    def counts(
        offset: wp.int32,
        # in:
        key: wp.array[wp.int32],
        n: wp.int32,
        # out:
        cell_count: wp.array[wp.int32],
    ):
        """Particles of a cell, counted by the first of them in the sorted order; cells without any are left alone."""
        k = wp.tid() + offset
        own = key[k]
        if k > 0:
            if key[k - 1] == own:
                return
        last = k + 1
        while last < n:
            if key[last] != own:
                break
            last += 1
        cell_count[own] = last - k

    return Cells(keys, counts, coordinates, beyond, number, runs)
