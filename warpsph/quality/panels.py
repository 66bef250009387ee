"""Pictures of validation cases: particles of several runs side by side, all with one camera and one colour range."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpsph import units
from warpsph.drawing.camera import place_2d
from warpsph.drawing.cloud import RADIUS
from warpsph.drawing.spheres import Spheres
from warpsph.scalars import scalar
from warpsph.state import State
from warpsph.storage import atomic

COLOURS = 192
"""Colours in the file: a picture of particles is several times smaller so, and looks the same."""


@dataclass(frozen=True)
class Colouring:
    """What the colours mean.

    Attributes:
        field: Quantity, see `warpsph.scalars.scalar`.
        limits: Values at the ends of the colour bar [SI].
        cmap: Name of a matplotlib colour map.
        black: Name of a body drawn black, as one to which the quantity means nothing.
    """

    field: str
    limits: tuple[float, float]
    cmap: str = "viridis"
    black: str | None = None


def panels(
    rows: Sequence[Sequence[State]],
    names: tuple[Sequence[str], Sequence[str]],
    colouring: Colouring,
    box: np.ndarray,
    path: Path,
    *,
    width: int = 340,
) -> None:
    """Draw states in rows and columns into a PNG file.

    Args:
        rows: The states in 2D, row by row.
        names: Names of the rows and of the columns.
        colouring: What the colours mean.
        box: Lower and upper corner of what each panel shows [m], shape [2, 3].
        path: The file.
        width: Width of a panel [pixels].

    Raises:
        RunError: If this machine cannot draw off screen, or the file cannot be written.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    factor, unit = units.scale(scalar(rows[0][0], colouring.field).unit, max(map(abs, colouring.limits)))
    mapping = ScalarMappable(Normalize(*(factor * value for value in colouring.limits)), colouring.cmap)
    aspect = float(np.divide(*np.ptp(box, axis=0)[:2]))
    size = (width, round(width / aspect))
    figure = Figure(
        figsize=((size[0] * len(rows[0]) + 130) / 100, (size[1] * len(rows) + 40) / 100), dpi=100, layout="constrained"
    )
    grid = figure.subplots(len(rows), len(rows[0]), squeeze=False)
    spheres = Spheres((2 * size[0], 2 * size[1]), RADIUS[2] * rows[0][0].spacing, place_2d(box, aspect))
    for j, row in enumerate(rows):
        for k, state in enumerate(row):
            axes = grid[j, k]
            axes.imshow(spheres.draw(np.asarray(state.x, float), _colours(state, colouring, mapping, factor)))
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(False)
    spheres.close()
    for axes, name in zip(grid[0], names[1], strict=True):
        axes.set_title(name, fontsize=11)
    for axes, name in zip(grid[:, 0], names[0], strict=True):
        axes.set_ylabel(name, fontsize=11)
    title = scalar(rows[0][0], colouring.field).title
    figure.colorbar(mapping, ax=grid, label=units.label(title, unit), fraction=0.05, aspect=40)
    _write(figure, path)


def _colours(state: State, colouring: Colouring, mapping: object, factor: float) -> np.ndarray:
    """Red, green and blue of every particle, shape [n, 3], uint8."""
    values = scalar(state, colouring.field).values
    colours = mapping.to_rgba(values * factor, bytes=True)[:, :3].copy()
    if colouring.black is not None:
        colours[state.of(colouring.black)] = 40
    return colours


def _write(figure: object, path: Path) -> None:
    """Write a figure with few colours.

    Raises:
        RunError: If it cannot be written.
    """
    from PIL import Image

    memory, small = io.BytesIO(), io.BytesIO()
    figure.savefig(memory, format="png")
    Image.open(memory).convert("RGB").quantize(COLOURS).save(small, format="png", optimize=True)
    atomic.write(path, small.getbuffer())
