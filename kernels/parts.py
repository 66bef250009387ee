"""Parts of a step's forces that the ledger keeps apart, beside the stress of the material."""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

VISCOUS, ARTIFICIAL, HOURGLASS, CONTACT = range(4)
"""Rows of the arrays: artificial viscosity, artificial stress, hourglass control, contact."""

PARTS = ("viscous_work", "artificial_stress_work", "hourglass_work", "contact_work")
"""What each has turned into internal energy [J], by its name in the ledger."""


class PartTypes(NamedTuple):
    """Element types: accelerations [m/s²], a row for each part, and powers per mass [W/kg]."""

    acceleration: type
    power: type


@functools.cache
def part_types(s: Spec) -> PartTypes:
    """Give the types of one precision."""
    return PartTypes(wp.types.matrix((len(PARTS), 3), s.real), wp.types.vector(len(PARTS), s.real))
