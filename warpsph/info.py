"""What ``warpsph info`` prints about a finished run, a snapshot or a checkpoint, and the tables of the other commands."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .messages import files
from .messages.values import printable
from .progress import clock, si
from .storage import folder, summary

if TYPE_CHECKING:
    from .state import State

GAP = "  "
"""Between the columns of a table."""

FOREVER = 1e12
"""A wall time beyond this is none [s]."""

SECONDS = ("time", "until", "dt_min", "dt_max", "step_wall_s")
"""Entries of a summary that read well with an SI prefix."""


def describe(path: Path) -> str:
    """Describe a run folder (its summary, else its last snapshot, and its checkpoints), a snapshot or a checkpoint.

    Raises:
        InputError: If it is neither, or damaged.
    """
    from .storage import checkpoint, snapshot

    path = Path(path)
    if not path.exists():
        raise files.no_run(path)
    if path.is_file() and path.suffix == ".json":
        return describe_summary(summary.read(path))
    if path.is_file() and path.suffix == ".h5":
        return describe_checkpoint(checkpoint.facts(path))
    if path.is_file():
        return describe_state(snapshot.read(path))
    return "\n".join([_describe_folder(path), *map(_checkpoint_line, folder.checkpoints(path))])


def _describe_folder(path: Path) -> str:
    """Describe a run by its summary, else by its last snapshot."""
    from .storage import snapshot

    if (path / summary.NAME).is_file():
        return describe_summary(summary.read(path / summary.NAME))
    found = snapshot.find(path)
    if not found:
        raise files.empty_run(path)
    return describe_state(snapshot.read(found[-1]))


def describe_summary(facts: dict[str, Any]) -> str:
    """Write a summary out, one entry a line; nested entries are indented, warnings come last."""
    rows: list[tuple[str, str]] = []
    for key, value in facts.items():
        if key == "warnings":
            continue
        if isinstance(value, dict):
            rows.append((key, "" if value else "none"))
            rows += [(GAP + str(name), _value(name, inner)) for name, inner in value.items()]
        else:
            rows.append((key, _value(key, value)))
    warnings = [f"warning: {printable(str(line))}" for line in facts.get("warnings", [])]
    return "\n".join([table(rows), *warnings])


def describe_checkpoint(facts: dict[str, Any]) -> str:
    """Write out what a checkpoint says of its run, one entry a line."""
    from .storage.checkpoint import HEADER

    return describe_summary({name: facts[name] for name in ("format_version", *HEADER) if name in facts})


def _checkpoint_line(path: Path) -> str:
    """One line on a checkpoint: its time and step, or why it cannot be read."""
    from .storage import checkpoint

    try:
        facts = checkpoint.facts(path)
    except InputError as error:
        return f"warning: {error}"
    return f"{path.name}: {si(facts['time'], 's')}, step {facts['step']}"


def describe_state(state: "State") -> str:
    """Write a snapshot out: time, particles of each body, and the range of every quantity."""
    from . import scalars

    bodies = np.bincount(state.body, minlength=len(state.bodies))
    head = [("scene", f"{state.scene}, {state.dim}D"), ("time", f"{si(state.time, 's')}, step {state.step}")]
    head.append(("spacing", f"{si(state.spacing, 'm')}, smoothing length {si(state.h, 'm')}"))
    head.append(("particles", str(len(state.body))))
    made_of = _materials(state)
    head += [(GAP + name, f"{bodies[k]}  {', '.join(made_of[k])}") for k, name in enumerate(state.bodies)]
    ranges = []
    for name in scalars.names(state):
        quantity = scalars.scalar(state, name)
        if quantity.categories is None and name != "id":
            ranges.append((name, quantity.unit, *_extremes(quantity.values)))
    return table(head) + "\n\n" + table(ranges, ("quantity", "unit", "minimum", "maximum", ""))


def table(rows: Iterable[Sequence[str]], header: Sequence[str] = ()) -> str:
    """Lay rows of text out in columns, at any width: for terminals as for ``grep``."""
    rows = [list(map(printable, row)) for row in ([header, *rows] if header else rows)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (GAP.join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(line.rstrip() for line in lines)


def _value(key: str, value: Any) -> str:
    """One entry of a summary."""
    if isinstance(value, float) and key in SECONDS:
        return si(value, "s")
    if isinstance(value, (int, float)) and key == "wall_s" and 0.0 <= value < FOREVER:
        return clock(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_value(name, inner)}" for name, inner in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _materials(state: "State") -> list[list[str]]:
    """Names of what each body is made of."""
    kinds, made_of = len(state.materials), [[] for _ in state.bodies]
    for pair in np.unique(state.body.astype(np.int64) * kinds + state.mat):
        made_of[pair // kinds].append(state.materials[pair % kinds])
    return made_of


def _extremes(values: np.ndarray) -> tuple[str, str, str]:
    """Smallest and largest finite value, and a remark if there are others."""
    finite = values[np.isfinite(values)]
    bad = len(values) - len(finite)
    low, high = (f"{finite.min():.5g}", f"{finite.max():.5g}") if len(finite) else ("-", "-")
    return low, high, f"{bad} not finite" if bad else ""
