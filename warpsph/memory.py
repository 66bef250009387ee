"""Device memory: how much of it a run may spend on speed, and what it is spent on."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import warp as wp

if TYPE_CHECKING:
    from .solver import Solver


@dataclass(frozen=True)
class Policy:
    """What memory buys.

    Attributes:
        kept: The force loop leaves the pairs within the support, and their slopes, to the loops that follow it: these
            read a copy of the rows instead of testing every entry again. The numbers are the same, to the last bit.
        divisor: A row has room for its neighbours and for that many more: their number over this,
        spare: and so many more. A row without room costs a second search, never a neighbour.
        growth: Rows that no longer fit get so much more than they need.
    """

    kept: bool
    divisor: int
    spare: int
    growth: float


GENEROUS = Policy(kept=True, divisor=2, spare=16, growth=1.2)
"""On a CPU, where memory is plentiful and a second search dear."""

THRIFTY = Policy(kept=False, divisor=16, spare=2, growth=1.03)
"""On a GPU, where memory bounds the number of particles."""


def policy_of(device: wp.Device) -> Policy:
    """The policy for a device."""
    return THRIFTY if device.is_cuda else GENEROUS


def usage(solver: "Solver") -> dict[str, int]:
    """Bytes of device memory of every array of a solver, by owner and name, the largest first.

    ``rows.words`` is the block that holds the neighbour rows' entries, and the work space of rebuilding them before;
    the hash grids' memory is what `warpsph.rows.Rows` asks for. Work space that Warp keeps for itself is not counted.
    """
    found: dict[str, int] = {}
    seen: set[int] = set()
    for owner, thing in solver.owners().items():
        for name, value in vars(thing).items():
            if isinstance(value, wp.array) and value.ptr not in seen:
                seen.add(value.ptr)
                found[f"{owner}.{name.lstrip('_')}"] = value.capacity
        if hasattr(thing, "grid_bytes"):
            found[f"{owner}.grid"] = thing.grid_bytes
    return dict(sorted(found.items(), key=lambda item: -item[1]))
