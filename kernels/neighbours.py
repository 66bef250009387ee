"""Neighbour rows: those of i are the ``n_neigh[i]`` entries from ``neigh[start[i]]`` on (entries: see `mirror`)."""

import functools
from typing import NamedTuple

import warp as wp

from .kernel_type import ERODED
from .lanes import make_lanes
from .mirror import INDEX_BITS, make_mirror
from .spec import Spec
from .tensor import make_tensor


class NeighbourKernels(NamedTuple):
    """Kernels of this file."""

    fill: wp.Kernel
    reserve: wp.Kernel
    cell_order: wp.Kernel


@functools.cache
def make_neighbours(
    s: Spec, planes: bool, same_body: bool = False, selective: bool = False
) -> NeighbourKernels:
    """Build the search.

    Args:
        s: Specialisation.
        planes: There are symmetry planes, whose mirror images count.
        same_body: Particles of another body are no neighbours.
        selective: Only particles of a role have a row, and eroded ones are nobody's neighbours.
    """
    real, vec, place, point = s.real, s.vec, s.place, s.point
    mirror, dot = make_mirror(s, planes), make_tensor(s).dot
    options = ("planes" * planes, "same_body" * same_body, "selective" * selective)
    module = s.module(__name__, "_".join(filter(None, options)))

    @wp.func
    def fits(body_i: wp.int32, body_j: wp.int32, type_j: wp.int32):
        if wp.static(same_body) and body_i != body_j:
            return False
        if wp.static(selective) and type_j == ERODED:
            return False
        return True

    row_end = make_lanes(s).row_end
    masks = wp.constant(8 if planes else 1)

    @wp.kernel(module=module)
    def fill(
        offset: wp.int32,
        # in:
        grid: wp.uint64,
        x: wp.array[point],
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        role: wp.array[wp.int32],
        plane: point,
        plane_mask: wp.int32,
        radius: real,
        start: wp.array[wp.int32],
        # out:
        neigh: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        overflow: wp.array[wp.int32],
    ):
        """Write the neighbours |x_i - x_j| < radius, mirror images included, i itself left out but to fill up the row.

        Every candidate is written and only a neighbour moves the end on: no branch to mispredict, and the reason
        why a row has at least one spare place. A row without room is counted to its end and reported, never cut.
        """
        i = wp.tid() + offset
        first = start[i]
        room = start[i + 1] - first
        n = wp.int32(0)
        if wp.static(selective):
            if role[i] == 0 or kernel_type[i] == ERODED:
                n_neigh[i] = 0
                return
        for mask in range(masks):
            if (mask & plane_mask) == mask:
                xi = mirror.point(x[i], mirror.sign(mask << INDEX_BITS), plane)
                for j in wp.hash_grid_query(grid, xi, place(radius)):
                    if n < room:
                        neigh[first + n] = j | (mask << INDEX_BITS)
                    xij = vec(xi - x[j])
                    near = dot(xij, xij) < radius * radius and (j != i or mask > 0)
                    if wp.static(same_body or selective):
                        near = near and fits(body[i], body[j], kernel_type[j])
                    n += wp.where(near, 1, 0)
        n_neigh[i] = n
        last = row_end(first, n)
        if n >= room or last > first + room:
            overflow[0] = 1
        else:
            for k in range(first + n, last):
                neigh[k] = i

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
        """Give a row what it needs now, a share of that, and ``spare`` places, at least one (see `fill`)."""
        i = wp.tid() + offset
        room[i] = row_end(0, n_neigh[i] + n_neigh[i] / divisor + spare)

    @wp.kernel(module=module)
    def cell_order(
        offset: wp.int32,
        # in:
        grid: wp.uint64,
        # out:
        order: wp.array[wp.int32],
    ):
        """order_k = index of the k-th particle in the grid's cell order."""
        k = wp.tid() + offset
        order[k] = wp.hash_grid_point_id(grid, k)

    return NeighbourKernels(fill, reserve, cell_order)
