"""A picture in 1D: the quantity over x, one dot per particle."""

from typing import TYPE_CHECKING

import numpy as np

from warpsph import units
from warpsph.scalars import scalar
from warpsph.state import State

from .furniture import INK, as_written
from .look import Look

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Profile:
    """A graph with fixed axes, on a figure."""

    def __init__(self, figure: "Figure", look: Look):
        """Draw the axes."""
        self._look = look
        (low, high), (start, _, _), (end, _, _) = look.limits, *look.box
        self._length, length_unit = units.scale("m", max(abs(start), abs(end)))
        self._factor, unit = units.scale(look.unit, max(abs(low), abs(high)))
        self._axes = axes = figure.add_axes((0.10, 0.09, 0.87, 0.82))
        axes.set_xlabel(units.label("x", length_unit), fontsize=14, color=INK)
        axes.set_ylabel(units.label(look.title, unit), fontsize=14, color=INK)
        axes.tick_params(labelsize=12, colors=INK)
        axes.grid(color="#dddddd", linewidth=0.8)
        axes.set_axisbelow(True)
        axes.spines[:].set_color("#999999")
        margin, space = 0.02 * (end - start), 0.08 * (high - low)
        axes.set_xlim((start - margin) * self._length, (end + margin) * self._length)
        axes.set_ylim((low - space) * self._factor, (high + space) * self._factor)
        self._dots = []

    def update(self, state: State) -> None:
        """Show a state."""
        values = scalar(state, self._look.field).values
        if not self._dots:
            for name in state.bodies:
                self._dots += self._axes.plot([], [], "o", markersize=4.5, label=name.replace("_", " "))
            as_written(self._axes.legend(loc="upper right", fontsize=12, labelcolor=INK))
        for number, dots in enumerate(self._dots):
            mask = np.asarray(state.body) == number
            dots.set_data(state.x[mask, 0] * self._length, values[mask] * self._factor)

    def close(self) -> None:
        """Nothing to give back."""
