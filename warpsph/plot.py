"""Graphs of a run's history: energies, momenta, extremes and measures over time."""

import io
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import units
from .drawing.furniture import as_written
from .messages import files, values
from .storage import atomic, history

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FORMATS = (".png", ".svg", ".pdf")
"""Formats of a graph, by suffix."""

SUFFIXES = ("energy", "x", "y", "z", "min", "max")
"""Last words of column names that share a panel: ``momentum_x`` and ``momentum_y``, ``pressure_min`` and ``pressure_max``."""

MOST_PANELS = 120
"""Most panels of a plot."""

BEYOND = 1e300
"""Magnitudes from here on are not drawn, as infinite ones are not: axes have no room around them."""

CLOCK = ("time", "step")
"""Columns that say when a row was written, and have no panel."""


def plot(folder: Path, output: Path | None = None) -> Path:
    """Plot a run's history.csv, also while the run goes on.

    Columns with one name but for the last word (``_x``, ``_min``, ...) and all energies share a panel; every scene
    measure has its own. Errors have a logarithmic axis.

    Args:
        folder: Output folder of the run.
        output: A .png, .svg or .pdf file; ``folder/plot.png`` if None.

    Returns:
        The file written.

    Raises:
        InputError: If there is no history, or the file has another format.
        DiskError: If the file cannot be written.
    """
    from matplotlib.figure import Figure

    path = Path(folder) / "plot.png" if output is None else Path(output)
    if path.suffix.lower() not in FORMATS:
        raise values.refuse("output", str(path), f"a name that ends in {', '.join(FORMATS)}")
    names, column_units, columns = history.read(Path(folder) / "history.csv")
    if not len(columns["time"]):
        raise files.no_rows(Path(folder) / "history.csv")
    panels = group([name for name in names if name not in CLOCK], dict(zip(names, column_units, strict=True)))
    if len(panels) > MOST_PANELS:
        raise files.no_plot(Path(folder) / "history.csv", len(panels), MOST_PANELS)
    across = max(1, min(3, len(panels)))
    down = math.ceil(len(panels) / across)
    figure = Figure(figsize=(5.0 * across, 3.1 * down), dpi=120, layout="constrained")
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for axes, (title, unit, members) in zip(grid, panels, strict=False):
        _draw(axes, columns, title, unit, members)
    for axes in grid[len(panels) :]:
        axes.remove()
    memory = io.BytesIO()
    figure.savefig(memory, format=path.suffix.lower()[1:])
    atomic.write(path, memory.getbuffer())
    return path


def group(names: list[str], unit_of: dict[str, str]) -> list[tuple[str, str, list[str]]]:
    """Sort columns into panels, energies first.

    Args:
        names: Column names without `CLOCK`.
        unit_of: Unit of each.

    Returns:
        Title, unit and columns of each panel.
    """
    panels: dict[tuple[str, str], list[str]] = {}
    for name in names:
        stem, _, word = name.rpartition("_")
        title = "energy" if word == "energy" else stem if stem and word in SUFFIXES else name
        panels.setdefault((title, unit_of[name]), []).append(name)
    named = [
        (title if len(members) > 1 else members[0], unit, members)
        for (title, unit), members in panels.items()
    ]
    return sorted(named, key=lambda panel: not panel[0].startswith("energy"))


def _draw(axes: "Axes", columns: dict[str, np.ndarray], title: str, unit: str, members: list[str]) -> None:
    """Draw one panel."""
    time = np.where(np.abs(columns["time"]) < BEYOND, columns["time"], np.nan)
    time_factor, time_unit = units.scale("s", _largest([time]))
    values = {name: np.where(np.abs(columns[name]) < BEYOND, columns[name], np.nan) for name in members}
    error = title.endswith("error")
    if error:
        values = {name: np.where(column == 0.0, np.nan, np.abs(column)) for name, column in values.items()}
    factor, unit = (1.0, units.pretty(unit)) if error else units.scale(unit, _largest(values.values()))
    for name, column in values.items():
        word = name.rpartition("_")[0] if title == "energy" else name.removeprefix(f"{title}_")
        axes.plot(
            time * time_factor,
            column * factor,
            label=word.replace("_", " "),
            linewidth=1.6,
            marker=_marker(time),
        )
    if error and np.isfinite(_largest(values.values())) and _largest(values.values()) > 0.0:
        axes.set_yscale("log")
    words = title.replace("_", " ")
    axes.set_title(
        units.label(f"|{words}|" if error else words, unit), fontsize=11, loc="left", parse_math=False
    )
    axes.set_xlabel(units.label("time", time_unit))
    axes.grid(color="#dddddd", linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    if len(members) > 1:
        as_written(axes.legend(frameon=False, fontsize=9))


def _marker(time: np.ndarray) -> str | None:
    """A single row is a dot, which a line would not show."""
    return "o" if len(time) == 1 else None


def _largest(columns) -> float:
    """Largest finite magnitude of some columns, 0 if there is none."""
    values = np.abs(np.concatenate([np.asarray(column) for column in columns]))
    return float(values[np.isfinite(values)].max(initial=0.0))
