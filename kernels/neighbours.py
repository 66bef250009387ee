"""Neighbour rows: the neighbours of i are ``neigh[start[i]:start[i + 1]]`` (entries, see `mirror`)."""

import functools
from typing import NamedTuple

import warp as wp

from .mirror import INDEX_BITS, make_mirror
from .spec import Spec


class NeighbourKernels(NamedTuple):
    """Kernels of this file."""

    count: wp.Kernel
    fill: wp.Kernel
    cell_order: wp.Kernel


@functools.cache
def make_neighbours(s: Spec, planes: bool) -> NeighbourKernels:
    """Build the search, with the mirror images of the active planes if there are ``planes``."""
    real, vec = s.real, s.vec
    mirror = make_mirror(s, planes)
    module = s.module(__name__, "planes" if planes else "")
    masks = wp.constant(8 if planes else 1)

    @wp.kernel(module=module)
    def count(
        offset: wp.int32,
        # in:
        grid: wp.uint64,
        x: wp.array[vec],
        plane: vec,
        plane_mask: wp.int32,
        radius: real,
        # out:
        n_neigh: wp.array[wp.int32],
    ):
        """Count the neighbours |x_i - x_j| < radius, mirror images included, i itself left out."""
        i = wp.tid() + offset
        n = wp.int32(0)
        for mask in range(masks):
            if (mask & plane_mask) == mask:
                xi = mirror.point(x[i], mirror.sign(mask << INDEX_BITS), plane)
                for j in wp.hash_grid_query(grid, xi, radius):
                    if wp.length_sq(xi - x[j]) < radius * radius and (j != i or mask > 0):
                        n += 1
        n_neigh[i] = n

    @wp.kernel(module=module)
    def fill(
        offset: wp.int32,
        # in:
        grid: wp.uint64,
        x: wp.array[vec],
        plane: vec,
        plane_mask: wp.int32,
        radius: real,
        start: wp.array[wp.int32],
        # out:
        neigh: wp.array[wp.int32],
    ):
        """Write the entries in the grid's order, which depends on positions and memory order alone."""
        i = wp.tid() + offset
        k = start[i]
        for mask in range(masks):
            if (mask & plane_mask) == mask:
                xi = mirror.point(x[i], mirror.sign(mask << INDEX_BITS), plane)
                for j in wp.hash_grid_query(grid, xi, radius):
                    if wp.length_sq(xi - x[j]) < radius * radius and (j != i or mask > 0):
                        neigh[k] = j | (mask << INDEX_BITS)
                        k += 1

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

    return NeighbourKernels(count, fill, cell_order)
