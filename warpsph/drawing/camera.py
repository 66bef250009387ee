"""Where a picture is taken from, and what it cuts away."""

import math
import re
from dataclasses import dataclass

import numpy as np

from warpsph.messages import values

_UP_Z, _UP_Y = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)

VIEWS: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "iso": ((-0.45, -1.0, 0.5), _UP_Z),
    "x": ((1.0, 0.0, 0.0), _UP_Z),
    "-x": ((-1.0, 0.0, 0.0), _UP_Z),
    "y": ((0.0, 1.0, 0.0), _UP_Z),
    "-y": ((0.0, -1.0, 0.0), _UP_Z),
    "z": ((0.0, 0.0, 1.0), _UP_Y),
    "-z": ((0.0, 0.0, -1.0), _UP_Y),
    "xy": ((0.0, 0.0, 1.0), _UP_Y),
    "xz": ((0.0, -1.0, 0.0), _UP_Z),
    "yz": ((1.0, 0.0, 0.0), _UP_Z),
}
"""Named views: the direction from the scene to the camera, and the direction up in the picture. ``x`` looks
from the positive end of the x axis; ``xz`` has x to the right and z upwards."""

FACING = {"x": "yz", "y": "xz", "z": "xy"}
"""View straight on a cut plane, by the axis of its normal."""

ANGLE = 25.0
"""Vertical angle of view of the perspective camera [degrees]."""


@dataclass(frozen=True)
class Cut:
    """A plane; only the particles behind it are drawn.

    Attributes:
        axis: Axis of its normal, 0, 1 or 2.
        position: Where it lies on that axis [m].
        keep: +1.0 if the particles beyond it are kept, -1.0 if those before it are.
    """

    axis: int
    position: float
    keep: float

    def mask(self, x: np.ndarray) -> np.ndarray:
        """Which particles are kept, shape [n], bool; ``x`` are the positions [m], shape [n, 3]."""
        return self.keep * (x[:, self.axis] - self.position) >= 0.0

    def clip(self, box: np.ndarray) -> np.ndarray:
        """The part of a box that is kept; both by lower and upper corner [m], shape [2, 3]."""
        kept = box.copy()
        kept[0 if self.keep > 0.0 else 1, self.axis] = np.clip(self.position, *box[:, self.axis])
        return kept


@dataclass(frozen=True)
class Camera:
    """A placed camera.

    Attributes:
        position: Where it stands [m].
        focus: What it looks at [m].
        right: Direction to the right in the picture.
        up: Direction up in the picture.
        height: Height that the picture shows at the focus [m].
        parallel: Whether the projection is parallel (2D) or perspective (3D).
    """

    position: np.ndarray
    focus: np.ndarray
    right: np.ndarray
    up: np.ndarray
    height: float
    parallel: bool


def named_view(view: str | None, dim: int, cut: str | None = None) -> str:
    """Check the name of a view; None gives the one straight on the cut, or else the usual one of the dimension.

    Raises:
        InputError: If there is no such view in this dimension.
    """
    allowed = list(VIEWS) if dim == 3 else ["xy"]
    if view is None:
        facing = FACING.get((cut or "").strip()[:1])
        return facing if facing in allowed else allowed[0]
    if view not in allowed:
        raise values.unknown(f"{dim}D view", view, allowed)
    return view


def parse_cut(text: str, view: str, box: np.ndarray) -> Cut:
    """Read a cut plane such as ``"y"`` (through the middle of the box) or ``"y=0.01"``.

    Args:
        text: The axis of the normal, and where on it [m].
        view: Name of the view; the half towards the camera is taken away.
        box: Lower and upper corner of the scene at its start [m], shape [2, 3].

    Raises:
        InputError: If it is not of this form.
    """
    match = re.fullmatch(r"\s*([xyz])\s*(?:=\s*(\S+)\s*)?", text)
    try:
        axis = "xyz".index(match[1])
        position = float(match[2]) if match[2] else float(box[:, axis].mean())
    except (TypeError, ValueError):
        raise values.refuse("cut", text, "x, y or z, with or without a position, as y=0.01") from None
    return Cut(axis, position, -1.0 if VIEWS[view][0][axis] >= 0.0 else 1.0)


def place_2d(box: np.ndarray, aspect: float) -> Camera:
    """Place a parallel camera in front of the xy plane so that it shows a box.

    Args:
        box: Lower and upper corner [m], shape [2, 3].
        aspect: Width over height of the picture.
    """
    size, focus = box[1] - box[0], box.mean(axis=0)
    height = max(size[1], size[0] / aspect)
    return Camera(focus + 2.0 * height * np.eye(3)[2], focus, np.eye(3)[0], np.eye(3)[1], height, True)


def place_3d(box: np.ndarray, aspect: float, view: str) -> Camera:
    """Place a perspective camera so that it shows a box from a named view.

    Args:
        box: Lower and upper corner [m], shape [2, 3].
        aspect: Width over height of the picture.
        view: Name of the view.
    """
    right, up, direction = _directions(view)
    focus, corners = box.mean(axis=0), _corners(box)
    slope = math.tan(math.radians(ANGLE / 2.0))
    needed = np.maximum(abs(corners @ right) / aspect, abs(corners @ up)) / slope + corners @ direction
    distance = float(needed.max())
    return Camera(focus + distance * direction, focus, right, up, 2.0 * distance * slope, False)


def aspect_3d(box: np.ndarray, view: str) -> float:
    """Width over height of a box as seen from far away in a named view; lower and upper corner [m], shape [2, 3]."""
    right, up, _ = _directions(view)
    corners = _corners(box)
    return float(np.ptp(corners @ right) / np.ptp(corners @ up))


def _directions(view: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit vectors to the right, upwards and towards the camera of a named view."""
    direction = np.array(VIEWS[view][0]) / np.linalg.norm(VIEWS[view][0])
    right = np.cross(VIEWS[view][1], direction)
    right /= np.linalg.norm(right)
    return right, np.cross(direction, right), direction


def _corners(box: np.ndarray) -> np.ndarray:
    """The corners of a box seen from its middle [m], shape [8, 3]."""
    return np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1).reshape(8, 3) - box.mean(axis=0)
