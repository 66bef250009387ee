"""What memory a run may spend on speed, by the kind of device."""

from dataclasses import dataclass

import warp as wp

from warpsph.kernels.spec import LANES


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

THRIFTY = Policy(lanes=1, divisor=32, spare=1, growth=1.03)
"""On a GPU, where memory bounds the number of particles."""


def policy_of(device: wp.Device) -> Policy:
    """The policy for a device."""
    return THRIFTY if device.is_cuda else GENEROUS
