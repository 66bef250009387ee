"""Pictures of validation cases: profiles of several runs beside the exact solution."""

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpsph import units
from warpsph.storage import atomic

COLOURS = ("#999999", "#2a9d8f", "#e9a03b", "#c8376f")
"""Colours of the runs, in the order of the runs."""

MARKERS = "sv^o"
"""And their markers."""


@dataclass(frozen=True)
class Panel:
    """One quantity over position.

    Attributes:
        title: Name of the quantity.
        unit: Its SI unit.
        exact: Positions [m] and exact values, two arrays of one shape.
        runs: Positions [m] and values of each run by its name, likewise; at most as many as there are `COLOURS`.
    """

    title: str
    unit: str
    exact: tuple[np.ndarray, np.ndarray]
    runs: dict[str, tuple[np.ndarray, np.ndarray]]


def profiles(panels: Sequence[Panel], path: Path) -> None:
    """Draw panels, two a row, into a PNG file.

    Raises:
        DiskError: If the file cannot be written.
    """
    from matplotlib.figure import Figure

    down = math.ceil(len(panels) / 2)
    figure = Figure(figsize=(12.0, 4.4 * down), dpi=120, layout="constrained")
    grid = figure.subplots(down, 2, squeeze=False).ravel()
    for axes, panel in zip(grid, panels, strict=False):
        x, values = panel.exact
        length, length_unit = units.scale("m", float(np.abs(x).max()))
        factor, unit = units.scale(panel.unit, float(np.abs(values).max()))
        axes.plot(x * length, values * factor, color="black", linewidth=1.2, label="exact", zorder=1)
        for (name, (x, values)), colour, marker in zip(panel.runs.items(), COLOURS, MARKERS, strict=False):
            order = np.argsort(x)
            axes.plot(
                x[order] * length, values[order] * factor, color=colour, linewidth=0.8, label=name,
                marker=marker, markersize=3.6, zorder=2,
            )  # fmt: skip
        axes.set_xlabel(units.label("x", length_unit))
        axes.set_title(units.label(panel.title, unit), fontsize=11, loc="left")
        axes.grid(color="#dddddd", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
    grid[0].legend(frameon=False, fontsize=10, loc="lower center")
    for axes in grid[len(panels) :]:
        axes.remove()
    memory = io.BytesIO()
    figure.savefig(memory, format="png")
    atomic.write(path, memory.getbuffer())
