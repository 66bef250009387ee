"""Parts of a step's forces that the ledger keeps apart, beside the stress of the material."""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

VISCOUS, ARTIFICIAL, HOURGLASS, CONTACT = range(4)
"""The parts: artificial viscosity, artificial stress, hourglass control, contact."""

PARTS = ("viscous_work", "artificial_stress_work", "hourglass_work", "contact_work")
"""What each has turned into internal energy [J], by its name in the ledger."""

Parts = tuple[int, ...]
"""The parts that a run has, in order: its arrays have a row for each of them and for no other."""


class PartTypes(NamedTuple):
    """Element types: accelerations [m/s²], a row for each part, and powers per mass [W/kg]."""

    acceleration: type
    power: type


@functools.cache
def part_types(s: Spec, count: int) -> PartTypes:
    """Give the types of one precision for a number of parts; without any they still have one row."""
    rows = max(count, 1)
    return PartTypes(wp.types.matrix((rows, 3), s.real), wp.types.vector(rows, s.real))


def tag(parts: Parts) -> str:
    """Short name of the parts for the variant of a module."""
    return "parts" + "".join(map(str, parts)) if parts else ""
