"""Device memory: how much of it a run may spend on speed, and what it is spent on."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import warp as wp

from .block import Block
from .kernels.spec import LANES

if TYPE_CHECKING:
    from .solver import Solver


@dataclass(frozen=True)
class Policy:
    """What memory buys, and what goes with the kind of device.

    Attributes:
        lanes: Pairs that a loop handles at once, see `kernels.lanes`: rows are filled up to a multiple of it.
        divisor: A row has room for its neighbours and for that many more: their number over this,
        spare: and so many more. A row without room costs a second search, never a neighbour.
        growth: Rows that no longer fit get so much more than they need.
    """

    lanes: int
    divisor: int
    spare: int
    growth: float


GENEROUS = Policy(lanes=LANES, divisor=2, spare=16, growth=1.2)
"""On a CPU, where memory is plentiful and a second search dear."""

THRIFTY = Policy(lanes=1, divisor=16, spare=2, growth=1.03)
"""On a GPU, where memory bounds the number of particles."""


SEARCH = ("neighbours.", "cells.", "search.", "tiles.", "reference.")
"""Owners of what belongs to neighbour search and rows."""


def policy_of(device: wp.Device) -> Policy:
    """The policy for a device."""
    return THRIFTY if device.is_cuda else GENEROUS


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
