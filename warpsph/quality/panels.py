"""Pictures of validation cases: particles of several runs side by side, all with one key of colours."""

import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from warpsph import units
from warpsph.drawing import camera
from warpsph.drawing.cloud import RADIUS
from warpsph.drawing.look import beyond
from warpsph.drawing.spheres import Spheres
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

MARGIN = {"left": 30, "top": 30, "bottom": 10, "gap": 8}
"""Room for names, and between panels [pixels]."""

FINER = 2
"""Panels in 3D are drawn so many times larger and then made smaller, for smooth edges."""


class Colours(Protocol):
    """What gives particles their colours, and explains them.

    Attributes:
        room: Width that the key needs [pixels].
    """

    room: int

    def of(self, state: State) -> np.ndarray:
        """Red, green, blue and opacity of each particle, shape [n, 4], from 0 to 1."""

    def draw_key(
        self, figure: "Figure", place: tuple[float, float, float, float], states: list[State]
    ) -> None:
        """Draw the key into a place on the figure: left, bottom, width and height as shares of it."""


@dataclass(frozen=True)
class Colouring:
    """Colours that stand for an amount.

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
    room: ClassVar[int] = 110

    def of(self, state: State) -> np.ndarray:
        """Colour of each particle, shape [n, 4]."""
        quantity = scalar(state, self.field)
        mapping, factor, _ = self._mapping(quantity.unit)
        colours = mapping.to_rgba(quantity.values * factor)
        if self.black is not None:
            colours[state.of(self.black)] = (0.1, 0.1, 0.1, 1.0)
        return colours

    def draw_key(
        self, figure: "Figure", place: tuple[float, float, float, float], states: list[State]
    ) -> None:
        """Draw a bar, pointed where values go beyond it."""
        quantity = scalar(states[0], self.field)
        mapping, _, unit = self._mapping(quantity.unit)
        left, bottom, _, height = place
        inches = figure.get_figwidth() * DPI
        bar = figure.add_axes((left + 8 / inches, bottom + 0.1 * height, 14 / inches, 0.8 * height))
        figure.colorbar(
            mapping,
            cax=bar,
            label=units.label(quantity.title, unit),
            extend=self._extend(states),
            extendfrac=0.03,
        )

    def _mapping(self, unit: str) -> "tuple[ScalarMappable, float, str]":
        """What turns values into colours, what to multiply them with before, and the unit that they have then."""
        import matplotlib
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        factor, unit = units.scale(unit, max(map(abs, self.limits)))
        table = matplotlib.colormaps[self.cmap].resampled(SHADES)
        return ScalarMappable(Normalize(*(factor * value for value in self.limits)), table), factor, unit

    def _extend(self, states: list[State]) -> str:
        """Which ends values go beyond; a body drawn black does not count."""
        shown = []
        for state in states:
            values = scalar(state, self.field).values
            shown.append(values if self.black is None else values[~state.of(self.black)])
        values = np.concatenate(shown)
        values = values[np.isfinite(values)]
        return beyond((values.min(), values.max()), self.limits) if len(values) else "neither"


@dataclass(frozen=True)
class Sight:
    """How a row of panels in 3D is seen.

    Attributes:
        view: Name of the view, see `warpsph.drawing.camera.VIEWS`; None for the usual one, or straight on the cut.
        cut: Cut plane such as ``"y=0"`` [m], or None.
    """

    view: str | None = None
    cut: str | None = None

    def aspect(self, box: np.ndarray) -> float:
        """Width over height of a box [m], shape [2, 3], in this sight."""
        view, cut = self._plane(box)
        return camera.aspect_3d(box if cut is None else cut.clip(box), view)

    def picture(
        self, state: State, colours: np.ndarray, box: np.ndarray, size: tuple[int, int]
    ) -> np.ndarray:
        """Draw a state.

        Args:
            state: The particles.
            colours: Their colours, shape [n, 4].
            box: Lower and upper corner of what is to be seen [m], shape [2, 3].
            size: Width and height [pixels].

        Returns:
            The picture, shape [height, width, 3], uint8.

        Raises:
            RunError: If this machine cannot draw off screen.
        """
        view, cut = self._plane(box)
        shown = np.isfinite(state.x).all(axis=1)
        if cut is not None:
            shown &= cut.mask(state.x)
            box = cut.clip(box)
        spheres = Spheres(size, RADIUS[3] * state.spacing, camera.place_3d(box, size[0] / size[1], view))
        try:
            return spheres.draw(state.x[shown], np.round(255.0 * colours[shown, :3]).astype(np.uint8))
        finally:
            spheres.close()

    def _plane(self, box: np.ndarray) -> tuple[str, camera.Cut | None]:
        """Name of the view, and the cut plane if there is one."""
        view = camera.named_view(self.view, 3, self.cut)
        return view, None if self.cut is None else camera.parse_cut(self.cut, view, box)


@dataclass(frozen=True)
class Panels:
    """States in rows and columns, each with a name.

    Attributes:
        states: The states by the names of row and column, None for an empty panel; every row has the same columns.
        box: Lower and upper corner of what a panel shows [m], shape [2, 2], or [2, 3] in 3D.
        width: Width of a panel [pixels].
        sights: How each row is seen, by its name; in 3D only.
    """

    states: dict[str, dict[str, State | None]]
    box: np.ndarray
    width: int = 240
    sights: dict[str, Sight] = field(default_factory=dict)

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(next(iter(self.states.values())))

    @property
    def present(self) -> list[State]:
        """The states that there are."""
        return [state for row in self.states.values() for state in row.values() if state is not None]

    def height(self, row: str) -> int:
        """Height of a row [pixels]."""
        across, up = np.ptp(self.box, axis=0)[:2]
        return round(self.width / (self.sights[row].aspect(self.box) if row in self.sights else across / up))


def draw_panels(panels: Panels, colours: Colours, path: Path) -> None:
    """Draw particles into a PNG file: as discs in 2D, as spheres in 3D.

    Raises:
        DiskError: If the file cannot be written.
        RunError: If this machine cannot draw in 3D.
    """
    from matplotlib.figure import Figure

    gap, left, bottom = MARGIN["gap"], MARGIN["left"], MARGIN["bottom"]
    heights = {row: panels.height(row) for row in panels.states}
    end = (
        left + (panels.width + gap) * len(panels.columns),
        bottom + sum(heights.values()) + gap * len(heights),
    )
    pixels = np.array((end[0] + colours.room, end[1] + MARGIN["top"]))
    figure = Figure(figsize=pixels / DPI, dpi=DPI)
    top = end[1]
    for number, (row, height) in enumerate(heights.items()):
        top -= height + gap
        for k, column in enumerate(panels.columns):
            corner = np.array((left + (panels.width + gap) * k, top))
            axes = figure.add_axes((*corner / pixels, *(panels.width, height) / pixels))
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(False)
            axes.set_title(column if number == 0 else "", fontsize=11)
            axes.set_ylabel(row if k == 0 else "", fontsize=11)
            state = panels.states[row][column]
            if state is not None:
                _draw(axes, panels, row, state, colours)
    place = (
        end[0] / pixels[0],
        bottom / pixels[1],
        colours.room / pixels[0],
        (end[1] - gap - bottom) / pixels[1],
    )
    colours.draw_key(figure, place, panels.present)
    _write(figure, path)


def _write(figure: "Figure", path: Path) -> None:
    """Write a figure with a palette.

    Raises:
        DiskError: If the file cannot be written.
    """
    from PIL import Image

    drawn, small = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png")
    Image.open(drawn).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        small, format="png", optimize=True
    )
    atomic.write(path, small.getbuffer())


def _draw(axes: "Axes", panels: Panels, row: str, state: State, colours: Colours) -> None:
    """Draw one state."""
    if row not in panels.sights:
        _draw_discs(axes, panels, state, colours.of(state))
        return
    size = FINER * panels.width, FINER * panels.height(row)
    picture = panels.sights[row].picture(state, colours.of(state), panels.box, size)
    axes.imshow(picture, interpolation="antialiased", aspect="auto")


def _draw_discs(axes: "Axes", panels: Panels, state: State, colours: np.ndarray) -> None:
    """Draw one state in 2D."""
    axes.set(xlim=panels.box[:, 0], ylim=panels.box[:, 1])
    diameter = (
        2.0 * RADIUS[2] * state.spacing / np.ptp(panels.box[:, 0]) * panels.width / DPI * 72.0
    )  # [points]
    axes.scatter(*state.x[:, :2].T, s=diameter**2, c=colours, linewidths=0.0, antialiased=False)
