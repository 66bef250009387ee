"""Reordering of particle arrays."""

import functools

import warp as wp

from .parts import part_types
from .spec import Spec


@functools.cache
def make_sort(s: Spec) -> dict[type, wp.Kernel]:
    """Build one gather kernel per element type of the state."""
    return {dtype: _gather(s, dtype) for dtype in (wp.int32, s.real, s.vec, s.mat, s.sym, part_types(s).power)}


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
