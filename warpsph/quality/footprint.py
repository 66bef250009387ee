"""Device memory of a solver, array by array."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import warp as wp

from warpsph.rows import CELLS
from warpsph.solver import Solver

LISTS = ("neighbours.", "reference.")
"""Beginnings of the names of what belongs to neighbour search and rows."""

HOLDERS = tuple(
    f"warpsph.{name}" for name in ("clock", "neighbours", "particles", "reference", "rows", "tiles")
)
"""Modules of what holds arrays."""

GRID_BYTES_PER_PARTICLE, GRID_BYTES_PER_CELL = 24, 8
"""A hash grid keeps cell and index of half as many particles again, twice to sort them, and two ends of each cell."""


def usage(solver: Solver) -> dict[str, int]:
    """Bytes of every array on the device by its name, each counted once; hash grids are reckoned, for they tell nothing."""
    found: dict[str, int] = {}
    seen: set[int] = set()
    cells = int(np.prod(CELLS[solver.data.dim]))
    grid = GRID_BYTES_PER_PARTICLE * solver.particles.n + GRID_BYTES_PER_CELL * cells
    for name in ("particles", "_work", "neighbours", "reference", "_clock"):
        _walk(name.lstrip("_"), getattr(solver, name), found, seen, grid)
    return found


def lists(found: dict[str, int]) -> int:
    """Bytes that neighbour search and rows take of what `usage` gives."""
    return sum(size for name, size in found.items() if name.startswith(LISTS))


def _walk(name: str, value: Any, found: dict[str, int], seen: set[int], grid: int) -> None:
    """Add the arrays that an object holds, at any depth; a hash grid takes ``grid`` bytes."""
    if id(value) in seen:
        return
    seen.add(id(value))
    if isinstance(value, wp.array):
        if value.ptr not in seen:  # another view of the same memory
            found[name] = value.capacity
        seen.add(value.ptr)
    elif isinstance(value, wp.HashGrid):
        found[name] = grid
    elif isinstance(value, dict):
        for key, inner in value.items():
            _walk(f"{name}.{key}", inner, found, seen, grid)
    elif isinstance(value, SimpleNamespace) or type(value).__module__ in HOLDERS:
        for key, inner in vars(value).items():
            if key != "_particles":
                _walk(f"{name}.{key.lstrip('_')}", inner, found, seen, grid)
