"""Reordering of particle arrays."""

import functools

import warp as wp

from .parts import PARTS, part_types
from .spec import Spec


@functools.cache
def make_sort(s: Spec) -> dict[type, wp.Kernel]:
    """Build one gather kernel per element type of the state."""
    parts = (part_types(s, count + 1).power for count in range(len(PARTS)))
    kinds = dict.fromkeys((wp.int32, s.real, s.vec, s.point, s.mat, s.sym, *parts))  # in this order
    return {dtype: _gather(s, dtype) for dtype in kinds}


def _gather(s: Spec, element: type) -> wp.Kernel:
    @wp.kernel(module=s.module(__name__))
    def gather(
        offset: wp.int32,
        # in:
        order: wp.array[wp.int32],
        source: wp.array[element],
        # out:
        target: wp.array[element],
    ):
        """new_k = old_order(k)."""
        k = wp.tid() + offset
        target[k] = source[order[k]]

    return gather
