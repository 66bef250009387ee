"""Frames: a picture of the particles with the scene's name and the time over it."""

from typing import Self

import numpy as np

from warpsph.state import State

from .cloud import Cloud
from .furniture import INK
from .look import Look, time_stamp
from .profile import Profile


class Painter:
    """Draws the frames of one sequence; a context manager, since it holds a window.

    The first frame takes longest, so one painter should draw them all.
    """

    def __init__(self, look: Look):
        """Prepare everything that does not change from frame to frame.

        Raises:
            RunError: If this machine cannot draw off screen.
        """
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._look = look
        width, height = look.size
        dpi = 100.0 * min(width / 1280.0, height / 960.0)  # text grows with the picture
        figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi, facecolor="white")
        self._canvas = FigureCanvasAgg(figure)
        self._content = (Profile if look.dim == 1 else Cloud)(figure, look)
        title = look.scene.replace("_", " ")
        figure.text(0.02, 0.957, title, fontsize=16, color=INK, weight="bold", parse_math=False)
        self._stamp = figure.text(0.98, 0.957, "", fontsize=16, color=INK, ha="right")

    def draw(self, state: State) -> np.ndarray:
        """Draw one frame.

        Returns:
            The picture, shape [height, width, 3], uint8.

        Raises:
            InputError: If the state does not offer the quantity of the look.
        """
        self._stamp.set_text(f"t = {time_stamp(state.time, self._look.last)}")
        self._content.update(state)
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()

    def close(self) -> None:
        """Give the window back."""
        self._content.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_) -> None:
        self.close()
