"""What stands around a picture to make it readable: axes, directions, length scale, and key of the colours."""

from typing import TYPE_CHECKING

import numpy as np

from warpsph import units

from .camera import Camera
from .look import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

INK = "#222222"
"""Colour of text and lines."""

SHADES = 256
"""Number of colours in a bar."""


def colours(look: Look) -> "tuple[ScalarMappable, float, str]":
    """Colour map of a look.

    Returns:
        What turns values into colours, what to multiply values with before, and the unit that they have then.
    """
    import matplotlib
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    factor, unit = units.scale(look.unit, max(map(abs, look.limits)))
    low, high = look.limits
    table = matplotlib.colormaps[look.cmap] if isinstance(look.cmap, str) else ListedColormap(look.cmap)
    if look.categories is not None:
        chosen = table(np.arange(len(look.categories)) % table.N)
    elif look.centred:  # the middle of the table stands for zero, and both signs change colour equally fast
        largest = max(-low, high)
        chosen = table(0.5 + 0.5 * np.linspace(low / largest, high / largest, SHADES))
    else:
        chosen = table(np.linspace(0.0, 1.0, SHADES))
    mapping = ListedColormap(chosen).with_extremes(bad="magenta")
    return ScalarMappable(Normalize(low * factor, high * factor), mapping), factor, unit


def draw_key(figure: "Figure", look: Look, mapping: "ScalarMappable", unit: str) -> None:
    """Say what the colours mean: a bar for amounts, a name for each category."""
    if look.categories is not None:
        draw_names(figure, look, mapping)
        return
    bar = figure.colorbar(
        mapping, cax=figure.add_axes((0.885, 0.17, 0.018, 0.66)), extend=look.extend, extendfrac=0.025
    )
    bar.set_label(units.label(look.title, unit), fontsize=14, color=INK, labelpad=4)
    bar.ax.tick_params(labelsize=12, colors=INK)
    bar.outline.set_edgecolor(INK)


def draw_names(figure: "Figure", look: Look, mapping: "ScalarMappable") -> None:
    """Draw a legend with the names of the categories that occur."""
    from matplotlib.lines import Line2D

    def dot(number: int) -> Line2D:
        return Line2D([], [], linestyle="", marker="o", markersize=10, color=mapping.to_rgba(number))

    dots = [dot(number) for number in look.occurring]
    words = [look.categories[number].replace("_", " ") for number in look.occurring]
    legend = figure.legend(
        dots,
        words,
        loc="upper right",
        bbox_to_anchor=(0.998, 0.92),
        fontsize=12,
        labelcolor=INK,
        handlelength=1.0,
        handletextpad=0.2,
        borderaxespad=0.0,
    )
    as_written(legend)


def as_written(legend: "Legend") -> None:
    """Show the names of a legend as they are, dollar signs too, which matplotlib takes for formulas."""
    for text in legend.get_texts():
        text.set_parse_math(False)


def draw_axes(axes: "Axes", view: Camera, aspect: float) -> None:
    """Draw the axes of the plane, with equal scales, around a picture that lies behind them."""
    low = view.focus[:2] - 0.5 * view.height * np.array([aspect, 1.0])
    high = view.focus[:2] + 0.5 * view.height * np.array([aspect, 1.0])
    factor, unit = units.scale("m", float(np.abs([low, high]).max()))
    axes.set(xlim=(low[0] * factor, high[0] * factor), ylim=(low[1] * factor, high[1] * factor))
    axes.set_xlabel(units.label("x", unit), fontsize=14, color=INK)
    axes.set_ylabel(units.label("y", unit), fontsize=14, color=INK)
    axes.tick_params(labelsize=12, colors=INK, direction="out")
    for spine in axes.spines.values():
        spine.set_color("#999999")


def draw_directions(axes: "Axes", view: Camera, aspect: float) -> None:
    """Draw the three coordinate directions as arrows in the lower left corner of a picture in 3D."""
    axes.set(xlim=(0.0, aspect), ylim=(0.0, 1.0))
    axes.axis("off")
    corner, length = np.array([0.09, 0.10]), 0.06
    for name, colour, axis in zip("xyz", ("#c0392b", "#27864a", "#2660a4"), np.eye(3), strict=True):
        tip = np.array([axis @ view.right, axis @ view.up])
        if np.linalg.norm(tip) < 0.05:  # points at the reader
            continue
        arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 2.0, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", xy=corner + length * tip, xytext=corner, arrowprops=arrow)
        place = corner + (length + 0.022 / np.linalg.norm(tip)) * tip
        axes.text(*place, name, color=colour, fontsize=13, weight="bold", ha="center", va="center")


def draw_length(axes: "Axes", view: Camera, aspect: float) -> None:
    """Draw a bar of a round length; in perspective it holds at the distance of the scene's middle."""
    wanted = 0.2 * view.height * aspect
    power = 10.0 ** np.floor(np.log10(wanted))
    length = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)
    factor, unit = units.scale("m", length)
    right, left = aspect - 0.05, aspect - 0.05 - length / view.height
    axes.plot([left, right], [0.06, 0.06], color=INK, linewidth=4.0, solid_capstyle="butt")
    axes.text((left + right) / 2.0, 0.075, f"{length * factor:g} {unit}", fontsize=13, color=INK, ha="center")
