"""Pictures of validation cases: particles of several runs side by side, all with one colour range."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpsph import units
from warpsph.drawing.cloud import RADIUS
from warpsph.scalars import scalar
from warpsph.state import State
from warpsph.storage import atomic

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

DPI = 100
"""Pixels per inch of the file."""

SHADES = 96
"""Colours of the bar: with those of the text they fit into a palette, and the file is a fraction as large."""

MARGIN = {"left": 30, "right": 110, "top": 30, "bottom": 10, "gap": 8}
"""Room for names and colour bar, and between panels [pixels]."""


@dataclass(frozen=True)
class Colouring:
    """What the colours mean.

    Attributes:
        field: Quantity, see `warpsph.scalars.scalar`.
        limits: Values at the ends of the colour bar [SI].
        cmap: Name of a matplotlib colour map.
        black: Name of a body drawn black, because the quantity is that of another.
    """

    field: str
    limits: tuple[float, float]
    cmap: str = "viridis"
    black: str | None = None


@dataclass(frozen=True)
class Panels:
    """States in 2D in rows and columns, each with a name.

    Attributes:
        states: The states by the names of row and column; every row has the same columns.
        box: Lower and upper corner of what a panel shows [m], shape [2, 2].
        width: Width of a panel [pixels].
    """

    states: dict[str, dict[str, State]]
    box: np.ndarray
    width: int = 240


def draw_panels(panels: Panels, colouring: Colouring, path: Path) -> None:
    """Draw particles as discs into a PNG file.

    Raises:
        RunError: If the file cannot be written.
    """
    import matplotlib
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    rows, columns = list(panels.states), list(next(iter(panels.states.values())))
    quantity = scalar(panels.states[rows[0]][columns[0]], colouring.field)
    factor, unit = units.scale(quantity.unit, max(map(abs, colouring.limits)))
    table = matplotlib.colormaps[colouring.cmap].resampled(SHADES)
    mapping = ScalarMappable(Normalize(*(factor * value for value in colouring.limits)), table)
    across, up = np.ptp(panels.box, axis=0)
    size = np.array((panels.width, round(panels.width * up / across)))
    corner, step = np.array((MARGIN["left"], MARGIN["bottom"])), size + MARGIN["gap"]
    end = corner + step * (len(columns), len(rows))
    pixels = end + np.array((MARGIN["right"], MARGIN["top"]))
    figure = Figure(figsize=pixels / DPI, dpi=DPI)
    for j, row in enumerate(reversed(rows)):
        for k, column in enumerate(columns):
            place = (corner + step * (k, j)) / pixels
            axes = figure.add_axes((*place, *size / pixels), xlim=panels.box[:, 0], ylim=panels.box[:, 1])
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(False)
            _draw(axes, panels.states[row][column], colouring, mapping, factor)
            if j == len(rows) - 1:
                axes.set_title(column, fontsize=11)
            if k == 0:
                axes.set_ylabel(row, fontsize=11)
    place = (end[0] + 8, corner[1] + 0.1 * (end[1] - corner[1])) / pixels
    bar = figure.add_axes((*place, 14 / pixels[0], 0.8 * (end[1] - corner[1]) / pixels[1]))
    figure.colorbar(mapping, cax=bar, label=units.label(quantity.title, unit))
    _write(figure, path)


def _write(figure: "Figure", path: Path) -> None:
    """Write a figure with a palette.

    Raises:
        RunError: If the file cannot be written.
    """
    from PIL import Image

    drawn, small = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png")
    Image.open(drawn).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        small, format="png", optimize=True
    )
    atomic.write(path, small.getbuffer())


def _draw(axes: "Axes", state: State, colouring: Colouring, mapping: "ScalarMappable", factor: float) -> None:
    """Draw one state."""
    colours = mapping.to_rgba(scalar(state, colouring.field).values * factor)
    if colouring.black is not None:
        colours[state.of(colouring.black)] = (0.1, 0.1, 0.1, 1.0)
    low, high = axes.get_xlim()
    inches = axes.get_position().width * axes.figure.get_figwidth()
    diameter = 2.0 * RADIUS[2] * state.spacing / (high - low) * inches * 72.0  # [points]
    axes.scatter(*state.x[:, :2].T, s=diameter**2, c=colours, linewidths=0.0, antialiased=False)
