"""Neighbour rows: those of i are the ``n_neigh[i]`` entries from ``neigh[start[i]]`` on (entries: see `mirror`).

On a GPU they are 32 places apart (`Spec.columns`): the rows of 32 particles stand side by side, each with the room of the
longest.
"""

import functools
from typing import NamedTuple

import warp as wp

from .cells import ALONG, make_cells
from .index import natural
from .lanes import make_lanes
from .mirror import INDEX_BITS, make_mirror
from .spec import Spec
from .tensor import make_tensor


class NeighbourKernels(NamedTuple):
    """Kernels of this file."""

    fill: wp.Kernel
    reserve: wp.Kernel
    expect: wp.Kernel


@functools.cache
def make_neighbours(
    s: Spec, planes: bool, same_body: bool = False, selective: bool = False, erosion: bool = False
) -> NeighbourKernels:
    """Build the search.

    Args:
        s: Specialisation.
        planes: There are symmetry planes, whose mirror images count.
        same_body: Particles of another body are no neighbours.
        selective: Only particles of a role have a row.
        erosion: Particles of a negative role are nobody's neighbours.
    """
    real, vec, place, point = s.real, s.vec, s.place, s.point
    mirror, dot = make_mirror(s, planes), make_tensor(s).dot
    coordinates, beyond, number, runs = make_cells(s)[2:]
    options = ("planes" * planes, "same_body" * same_body, "selective" * selective, "erosion" * erosion)
    module = s.module(__name__, "_".join(filter(None, options)))

    @wp.func
    def fits(body_i: wp.int32, body_j: wp.int32, role_j: wp.int32):
        if wp.static(same_body) and body_i != body_j:
            return False
        if wp.static(erosion) and role_j < 0:
            return False
        return True

    lanes, columns = make_lanes(s), s.columns
    filled, row_end = lanes.filled, lanes.row_end
    masks = wp.constant(8 if planes else 1)
    lines, layers = (3 if s.dim > axis else 1 for axis in (1, 2))
    Runs = wp.types.vector(2 * lines, wp.int32)

    @wp.kernel(module=module)
    def fill(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        body: wp.array[wp.int32],
        role: wp.array[wp.int32],
        plane: point,
        plane_mask: wp.int32,
        radius: real,
        period: wp.vec3i,
        cell_scale: point,
        cell_start: wp.array[wp.int32],
        order: wp.array[wp.int32],
        x_sorted: wp.array[point],
        start: wp.array[wp.int32],
        # out:
        neigh: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        overflow: wp.array[wp.int32],
    ):
        """Write the neighbours |x_i - x_j| < radius, mirror images included, i itself left out but to fill up the row.

        They are in three lines of cells in each of three layers (in 2D there is one layer, in 1D one line), no further
        along than the distance of the line leaves room for (see `cells`). Where the runs of a layer begin and end is
        found side by side, before the first is gone through: a CPU waits at the end of each.
        Every candidate is written and only a neighbour moves the end on: no branch to mispredict, and the reason
        why a row has at least one spare place. A row without room is counted to its end and reported, never cut.
        """
        i = wp.tid() + offset
        first = natural(start[i])
        end = start[wp.min((i / columns + 1) * columns, start.shape[0] - 1)]  # of the rows side by side
        at = wp.int32(first)
        if wp.static(selective):
            if role[i] <= 0:
                n_neigh[i] = 0
                return
        mask = wp.int32(0)
        while mask < masks:
            if (mask & plane_mask) == mask:
                xi = mirror.point(x[i], mirror.sign(mask << INDEX_BITS), plane)
                u = coordinates(xi, cell_scale)
                c_y, c_z = wp.floor(u[1]), wp.floor(u[2])
                z = -wp.int32(wp.static(layers // 2))
                while z <= wp.static(layers // 2):
                    above = beyond(real(u[2] - c_z), z)
                    firsts, lasts = Runs(), Runs()
                    for p in range(wp.static(lines)):
                        y = p - wp.static(lines // 2)
                        aside = beyond(real(u[1] - c_y), y)
                        rest = real(1.0) - above * above - aside * aside
                        if rest > real(0.0):
                            line = number(0, wp.int32(c_y) + y, wp.int32(c_z) + z, period)
                            half = place(real(ALONG) * wp.sqrt(rest))
                            first_1, last_1, first_2, last_2 = runs(cell_start, line, period[0], u[0], half)
                            firsts[2 * p] = first_1
                            firsts[2 * p + 1] = first_2
                            lasts[2 * p] = last_1
                            lasts[2 * p + 1] = last_2
                    r = wp.int32(0)
                    while r < wp.static(2 * lines):
                        k = natural(firsts[r])
                        last_k = lasts[r]
                        while k < last_k:
                            j = order[k]
                            if at < end:
                                neigh[at] = j | (mask << INDEX_BITS)
                            xij = vec(xi - x_sorted[k])
                            near = dot(xij, xij) < radius * radius and (j != i or mask > 0)
                            if wp.static(same_body or erosion):
                                near = near and fits(body[i], body[j], role[j])
                            at += wp.where(near, columns, 0)
                            k += 1
                        r += 1
                    z += 1
            mask += 1
        n = (at - first) / columns
        n_neigh[i] = n
        last = row_end(first, n)
        if at >= end or last > end:
            overflow[0] = 1
        else:
            while at < last:
                neigh[at] = i
                at += columns

    @wp.kernel(module=module)
    def reserve(
        offset: wp.int32,
        # in:
        n_neigh: wp.array[wp.int32],
        divisor: wp.int32,
        spare: wp.int32,
        # out:
        room: wp.array[wp.int32],
    ):
        """Give a row what it needs now, a share of that, and ``spare`` places, at least one (see `fill`).

        Rows side by side all get what the longest needs. Their particles' ``room`` is 1, and what is left of them all is
        the last one's: the sum up to a particle is then where its row starts.
        """
        i = wp.tid() + offset
        beside = i % columns
        if beside < columns - 1 and i + 1 < n_neigh.shape[0]:
            room[i] = 1
            return
        longest = wp.int32(0)
        for k in range(i - beside, i + 1):
            longest = wp.max(longest, n_neigh[k])
        room[i] = columns * filled(longest + longest / divisor + spare) - beside

    @wp.kernel(module=module)
    def expect(
        offset: wp.int32,
        # in:
        role: wp.array[wp.int32],
        start: wp.array[wp.int32],
        typical: wp.int32,
        # out:
        n_neigh: wp.array[wp.int32],
        overflow: wp.array[wp.int32],
    ):
        """Count ``typical`` neighbours for particles that had no row and need one now, and report if one has no room.

        That is before the search, on a CPU: a row's room ends where the next one's begins.
        """
        i = wp.tid() + offset
        if role[i] > 0 and n_neigh[i] == 0:
            n_neigh[i] = typical
            if start[i + 1] - start[i] <= typical:
                overflow[0] = 1

    return NeighbourKernels(fill, reserve, expect)
