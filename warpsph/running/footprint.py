"""What a run takes on the disk, before it writes anything."""

from pathlib import Path
from typing import TYPE_CHECKING

from warp.types import type_size_in_bytes

from warpsph.fields import CONSTANT, of_groups
from warpsph.messages import output
from warpsph.storage import folder

if TYPE_CHECKING:
    from warpsph.particles import Particles
    from warpsph.solver import Solver

CHECKPOINTS = 3
"""Checkpoints that are on the disk at a time: the last two, and the one being written."""

CELLS = 16
"""Bytes of a particle's vertex in a snapshot, see `storage.snapshot`."""


def check(out: Path, solver: "Solver", snapshots: int) -> str | None:
    """Compare what a run will write with what is free.

    Args:
        out: Output folder, which need not be there; what an earlier run left in it counts as free.
        solver: The run.
        snapshots: How many it will write.

    Returns:
        A warning if the disk has not enough for the whole run.

    Raises:
        InputError: If it has not enough for the first output.
    """
    free = folder.free(out)
    if free is None:
        return None
    one, checkpoint = snapshot_size(solver.particles), checkpoint_size(solver)
    if one + checkpoint > free:
        raise output.too_small(out, one + checkpoint, free)
    whole = snapshots * one + CHECKPOINTS * checkpoint
    return output.tight(out, whole, free) if whole > free else None


def checkpoint_size(solver: "Solver") -> int:
    """Bytes of a checkpoint, but for some kilobytes: what lasts from step to step, as it is on the device."""
    return sum(array.capacity for array in solver.lasting().values())


def snapshot_size(particles: "Particles") -> int:
    """Bytes of a snapshot, but for some kilobytes: every output field, symmetric tensors with nine components."""
    there = {f.name for f in particles.fields}
    size = CELLS
    for f in of_groups(frozenset(f.group for f in particles.fields) | CONSTANT):
        if f.output:
            size += _entry(particles, f.name) * (9 if f.kind == "sym" else 6) // 6 if f.name in there else 4
    return size * particles.n


def _entry(particles: "Particles", name: str) -> int:
    """Bytes of one particle's entry."""
    return type_size_in_bytes(getattr(particles, name).dtype)
