"""The look of a sequence of pictures: everything that stays the same from frame to frame."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from warpsph import units
from warpsph.messages import files, values
from warpsph.scalars import KERNEL_TYPES, Scalar, scalar
from warpsph.state import State

from . import camera
from .camera import Cut

PERCENTILES = (0.5, 99.5)
"""Share of the particles [%] that the colour range of a frame covers: single particles must not spoil it."""

BEYOND = 1e300
"""Magnitudes from here on count as infinite: a range must not overflow."""

MOST_LAYERS = 2000
"""Most spheres behind each other that are drawn, on average: of ten million particles in 3D there are some 200."""

FAR_FLUNG = 1.0
"""Share of a body's particles [%] on each side that may leave the picture, so that spall does not shrink it."""

SMALL = 0.02
"""A colour range that crosses zero by less than this share of its width does not count as signed."""

NEAR_ZERO = 0.2
"""A positive colour range that begins below this share of its highest value begins at zero."""

KERNEL_COLOURS = ("#1d3f6e", "#a9c6e2", "#e0a32e")
"""Colours of the kernel types: dark Eulerian, light Total Lagrangian, and one that stands out for eroded."""


@dataclass(frozen=True)
class Look:
    """What all frames of a sequence share.

    Attributes:
        field: Name of the quantity that gives the colour.
        title: The quantity's name for people.
        unit: SI unit of ``limits``.
        limits: Lowest and highest value of the colour range [unit].
        extend: Which ends values go beyond: ``"neither"``, ``"min"``, ``"max"`` or ``"both"``.
        categories: Names of the values if they are no amounts, else None.
        occurring: Numbers of the categories that any frame holds.
        cmap: Name of the colour map, or the colour of each category.
        centred: Whether the middle of the colour map stands for zero.
        dim: Space dimension.
        view: Name of the camera's view.
        cut: What is cut away, or None.
        box: Lower and upper corner of what is shown [m], shape [2, 3].
        spacing: Particle spacing [m].
        scene: Name of the scene.
        last: Time of the last frame [s]; sets the unit of the time stamp.
        size: Width and height [pixels].
    """

    field: str
    title: str
    unit: str
    limits: tuple[float, float]
    extend: str
    categories: tuple[str, ...] | None
    occurring: tuple[int, ...]
    cmap: str | tuple[str, ...]
    centred: bool
    dim: int
    view: str
    cut: Cut | None
    box: np.ndarray
    spacing: float
    scene: str
    last: float
    size: tuple[int, int]


def choose(
    states: Iterable[State],
    *,
    field: str = "pressure",
    view: str | None = None,
    range: tuple[float, float] | None = None,
    cut: str | None = None,
    size: tuple[int, int] = (1280, 960),
    cmap: str | None = None,
) -> Look:
    """Choose a look that suits a whole sequence.

    Args:
        states: The sequence, at least one; read once, so that it may be a generator.
        field: Name of the quantity, see `warpsph.scalars.scalar`.
        view: Name of the view, see `warpsph.drawing.camera.VIEWS`; None for the usual one, or straight on a cut.
        range: Lowest and highest value of the colour range [SI]; None to fit it to the sequence.
        cut: Cut plane in 3D, ``"y"`` or ``"y=0.01"`` [m].
        size: Width and height [pixels].
        cmap: A matplotlib colour map; None for one that suits the values.

    Raises:
        InputError: If field, view, range, cut, size or colour map make no sense.
    """
    _check(range, size, cmap)
    spans, boxes, occurring, last = [], [], set(), 0.0
    for number, state in enumerate(states):
        quantity = scalar(state, field)
        spans.append(_span(quantity.values))
        if quantity.categories is not None:
            occurring.update(np.unique(quantity.values).astype(int).tolist())
        boxes.append(_box(state, everything=number == 0))
        if number == 0:
            first, first_quantity, view = state, quantity, camera.named_view(view, state.dim, cut)
        last = max(last, state.time)
    box = np.array([np.min(boxes, axis=0)[0], np.max(boxes, axis=0)[1]])
    extent = max(float((box[1] - box[0]).max()), first.spacing)
    if len(first.x) * (first.spacing / extent) ** 2 > MOST_LAYERS:
        raise files.crowd(len(first.x), extent, first.spacing)
    limits, extend = _limits(np.array(spans), first_quantity, range)
    signed = limits[0] < -SMALL * (limits[1] - limits[0]) and limits[1] > SMALL * (limits[1] - limits[0])
    if cut is not None and first.dim != 3:
        raise values.clash(f"cut = {cut!r}", f"a scene in {first.dim}D", "none, or a scene in 3D")
    return Look(
        field=field,
        title=first_quantity.title,
        unit=first_quantity.unit,
        limits=limits,
        extend=extend,
        categories=first_quantity.categories,
        occurring=tuple(sorted(occurring)),
        cmap=cmap or _usual_cmap(first_quantity, signed),
        centred=signed and cmap is None,
        dim=first.dim,
        view=view,
        cut=None if cut is None else camera.parse_cut(cut, view, boxes[0]),
        box=box,
        spacing=first.spacing,
        scene=first.scene,
        last=last,
        size=tuple(size),
    )


def _check(range: tuple[float, float] | None, size: tuple[int, int], cmap: str | None) -> None:
    """Refuse what makes no sense whatever the states are."""
    import matplotlib

    if range is not None and not (len(range) == 2 and np.isfinite(range).all() and range[0] < range[1]):
        raise values.refuse("range", range, "two numbers, the lower one first")
    if len(size) != 2 or not all(200 <= pixels <= 8192 for pixels in size):
        raise values.outside("size", size, "width and height of 200 to 8192 pixels")
    if cmap is not None and cmap not in matplotlib.colormaps:
        raise values.unknown("cmap", cmap, ("viridis", "coolwarm"), "any colour map of matplotlib")


def _span(values: np.ndarray) -> tuple[float, float, float, float]:
    """Lowest value, low and high percentile, highest value."""
    finite = values[np.abs(values) < BEYOND]
    if not finite.size:
        return np.nan, np.nan, np.nan, np.nan
    low, high = np.percentile(finite, PERCENTILES)
    return finite.min(), low, high, finite.max()


def _limits(
    spans: np.ndarray, quantity: Scalar, range: tuple[float, float] | None
) -> tuple[tuple[float, float], str]:
    """Colour range of the sequence, and which ends values go beyond."""
    if quantity.categories is not None:
        return (-0.5, len(quantity.categories) - 0.5), "neither"
    spans = spans[np.isfinite(spans).all(axis=1)]
    lowest, low, high, highest = (
        (*spans[:, :2].min(axis=0), *spans[:, 2:].max(axis=0)) if len(spans) else (0.0,) * 4
    )
    if range is not None:
        low, high = range
    elif low == high:
        low, high = lowest, highest
    if range is None and 0.0 < low < NEAR_ZERO * high:
        low = 0.0
    if low == high:
        margin = 0.05 * abs(low) or 1.0
        low, high = low - margin, high + margin
    return (float(low), float(high)), beyond((lowest, highest), (low, high))


def beyond(values: tuple[float, float], limits: tuple[float, float]) -> str:
    """Which ends of a colour range the lowest and the highest value are clearly beyond, as matplotlib names them."""
    slack = 0.01 * (limits[1] - limits[0])
    ends = values[0] < limits[0] - slack, values[1] > limits[1] + slack
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[ends]


def _usual_cmap(quantity: Scalar, signed: bool) -> str | tuple[str, ...]:
    """Colours that suit the values."""
    if quantity.categories is not None:
        return KERNEL_COLOURS if quantity.categories == KERNEL_TYPES else "tab10"
    return "coolwarm" if signed else "viridis"


def _box(state: State, everything: bool) -> np.ndarray:
    """Lower and upper corner of the particles [m], shape [2, 3]; without far-flung ones unless everything is wanted."""
    x = np.asarray(state.x, dtype=np.float64)
    sound = np.isfinite(x).all(axis=1)
    share = 0.0 if everything else FAR_FLUNG
    bodies = [x[sound & (state.body == number)] for number in np.unique(state.body)]
    corners = np.array([np.percentile(body, (share, 100.0 - share), axis=0) for body in bodies if len(body)])
    if not len(corners):
        raise files.nowhere()
    return np.array([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])


def time_stamp(time: float, last: float) -> str:
    """Time of a frame in a unit that suits the whole sequence: ``8.00 µs``."""
    factor, unit = units.scale("s", last)
    digits = 2 if last * factor < 10.0 else 1
    return f"{time * factor:.{digits}f} {unit}"
