"""What device memory is spent on, array by array."""

from typing import TYPE_CHECKING

import warp as wp

from warpsph.search.block import Block

if TYPE_CHECKING:
    from warpsph.solver import Solver

SEARCH = ("neighbours.", "cells.", "search.", "tiles.", "reference.")
"""Owners of what belongs to neighbour search and rows."""


def usage(solver: "Solver") -> dict[str, int]:
    """Bytes of device memory of every array of a solver, by owner and name, the largest first.

    ``neighbours.block`` holds the rows' entries, and the work space of rebuilding them before. Work space that Warp keeps
    for itself is not counted.
    """
    found: dict[str, int] = {}
    seen: set[int] = set()
    for owner, thing in solver.owners().items():
        for name, value in vars(thing).items():
            array = value.lines if isinstance(value, Block) else value
            if isinstance(array, wp.array) and array.ptr not in seen and not _borrowed(array):
                seen.add(array.ptr)
                found[f"{owner}.{name.lstrip('_')}"] = array.capacity
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def of_search(found: dict[str, int]) -> int:
    """Bytes that neighbour search and rows take of what `usage` gives."""
    return sum(size for name, size in found.items() if name.startswith(SEARCH))


def _borrowed(array: wp.array) -> bool:
    """Whether it is a view of memory that something else owns."""
    return array.deleter is None
