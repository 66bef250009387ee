"""A picture in 2D or 3D: the particles as spheres, from a fixed camera."""

from typing import TYPE_CHECKING

import numpy as np

from warpsph.scalars import scalar
from warpsph.state import State

from . import camera, furniture
from .look import Look
from .spheres import Spheres

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RADIUS = {2: 0.71, 3: 0.55}
"""Radius of a sphere over the particle spacing, by dimension: no background shows through a lattice."""

FRAME = {2: (0.08, 0.075, 0.78, 0.845), 3: (0.0, 0.0, 0.87, 0.94)}
"""Left, bottom, width and height of the picture as shares of the figure, by dimension."""

MARGIN = 0.05
"""Free space around what is shown, as a share of its largest extent."""


class Cloud:
    """The particles and the axes around them, on a figure."""

    def __init__(self, figure: "Figure", look: Look):
        """Draw what does not change from frame to frame.

        Raises:
            RunError: If this machine cannot draw off screen.
        """
        self._look = look
        left, bottom, width, height = _pixels(look)
        self.axes = axes = figure.add_axes(
            (left / look.size[0], bottom / look.size[1], width / look.size[0], height / look.size[1]),
            facecolor="none",
        )
        self._mapping, self._factor, unit = furniture.colours(look)
        furniture.draw_key(figure, look, self._mapping, unit)
        view = _camera(look, width / height)
        if look.dim == 2:
            furniture.draw_axes(axes, view, width / height)
        else:
            furniture.draw_directions(axes, view, width / height)
            furniture.draw_length(axes, view, width / height)
        self._spheres = Spheres((width, height), RADIUS[look.dim] * look.spacing, view)
        blank = np.full((height, width, 3), 255, dtype=np.uint8)
        self._image = figure.figimage(blank, left, bottom, origin="upper", zorder=-1)

    def update(self, state: State) -> None:
        """Show a state."""
        x, values = np.asarray(state.x, dtype=np.float64), scalar(state, self._look.field).values
        shown = np.isfinite(x).all(axis=1)
        if self._look.cut is not None:
            shown &= self._look.cut.mask(x)
        values = np.ma.masked_invalid(values[shown] * self._factor)
        colours = np.ascontiguousarray(self._mapping.to_rgba(values, bytes=True)[:, :3])
        self._image.set_data(self._spheres.draw(x[shown], colours))

    def close(self) -> None:
        """Give the window back."""
        self._spheres.close()


def _pixels(look: Look) -> tuple[int, int, int, int]:
    """Left, bottom, width and height of the picture in the figure, in whole pixels."""
    left, bottom, width, height = FRAME[look.dim]
    w, h = look.size
    return round(left * w), round(bottom * h), round(width * w), round(height * h)


def _camera(look: Look, aspect: float) -> camera.Camera:
    """Place the camera so that the look's box fits with a margin."""
    extent = float((look.box[1] - look.box[0]).max())
    margin = MARGIN * extent + look.spacing
    box = look.box if look.cut is None else look.cut.clip(look.box)
    box = box + np.array([[-margin], [margin]])
    return camera.place_2d(box, aspect) if look.dim == 2 else camera.place_3d(box, aspect, look.view)
