"""Pictures of validation cases that show where particles are Total Lagrangian, Eulerian or eroded."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from warpsph import units
from warpsph.drawing.furniture import INK
from warpsph.drawing.look import KERNEL_COLOURS
from warpsph.messages import measuring
from warpsph.scalars import KERNEL_TYPES
from warpsph.state import State
from warpsph.storage import snapshot

from .panels import Colouring, Panels, Sight, draw_panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PROJECTILE_COLOURS = ("#8e1f2b", "#efb3a4", KERNEL_COLOURS[2])
"""Colours of the kernel types in the projectile."""

CLOSE = 0.02
"""A snapshot shows a time that is so close, as a share of it."""


@dataclass(frozen=True)
class KernelColours:
    """Dark colours for Eulerian particles, light ones for Total Lagrangian ones, red in the projectile.

    Attributes:
        projectile: Name of the body that is told from the others, or None.
    """

    projectile: str | None = None
    room: ClassVar[int] = 245

    def of(self, state: State) -> np.ndarray:
        """Colour of each particle, shape [n, 4]."""
        from matplotlib.colors import to_rgba_array

        colours = to_rgba_array(KERNEL_COLOURS)[state.kernel_type]
        if self.projectile is not None:
            inside = state.of(self.projectile)
            colours[inside] = to_rgba_array(PROJECTILE_COLOURS)[state.kernel_type[inside]]
        return colours

    def draw_key(
        self, figure: "Figure", place: tuple[float, float, float, float], states: list[State]
    ) -> None:
        """Draw a legend of what occurs."""
        from matplotlib.lines import Line2D

        kinds = self._kinds(states)
        dots = [
            Line2D([], [], linestyle="", marker="o", markersize=8, color=colour) for colour in kinds.values()
        ]
        corner = (place[0], place[1] + place[3])
        look = {"loc": "upper left", "borderaxespad": 0.0, "handletextpad": 0.2, "frameon": False}
        figure.legend(dots, list(kinds), bbox_to_anchor=corner, fontsize=10, labelcolor=INK, **look)

    def _kinds(self, states: list[State]) -> dict[str, str]:
        """Colours by the names of what occurs, in the order of the legend."""
        groups = [("", KERNEL_COLOURS, lambda state: np.ones(len(state.x), dtype=bool))]
        if self.projectile is not None:
            groups = [
                (f"{self.projectile}, ", PROJECTILE_COLOURS, lambda state: state.of(self.projectile)),
                ("", KERNEL_COLOURS, lambda state: ~state.of(self.projectile)),
            ]
        kinds = {}
        for prefix, colours, mask in groups:
            for number, (name, colour) in enumerate(zip(KERNEL_TYPES, colours, strict=True)):
                if any((state.kernel_type[mask(state)] == number).any() for state in states):
                    kinds[name if number == 2 else prefix + name] = colour
        return kinds


def draw_kernel_types(
    runs: dict[str, Path],
    path: Path,
    *,
    rows: Iterable[str],
    times: Iterable[float],
    box: np.ndarray,
    projectile: str | None = None,
    width: int = 360,
) -> None:
    """Draw kernel types in 2D, a row for each run and a column for each time (Young et al., Figure 11).

    Args:
        runs: Folders of the runs by the name of the row in the case.
        path: The .png file.
        rows: Names of the runs to draw.
        times: Times [s]; a run without a snapshot there leaves its panel empty.
        box: Lower and upper corner of what a panel shows [m], shape [2, 2].
        projectile: Name of the body that is told from the others, or None.
        width: Width of a panel [pixels].

    Raises:
        InputError: If no run has a snapshot at any of the times.
        RunError: If the file cannot be written.
    """
    draw_panels(Panels(_by_time(runs, rows, times), box, width), KernelColours(projectile), path)


def draw_pressures(
    runs: dict[str, Path],
    path: Path,
    *,
    rows: Iterable[str],
    times: Iterable[float],
    box: np.ndarray,
    limit: float,
    width: int = 300,
) -> None:
    """Draw pressures in 2D, a row for each run and a column for each time (Young et al., Figures 4 to 6).

    Args:
        runs: Folders of the runs by the name of the row in the case.
        path: The .png file.
        rows: Names of the runs to draw.
        times: Times [s]; a run without a snapshot there leaves its panel empty.
        box: Lower and upper corner of what a panel shows [m], shape [2, 2].
        limit: Pressure at the ends of the colour bar, of either sign [Pa].
        width: Width of a panel [pixels].

    Raises:
        InputError: If no run has a snapshot at any of the times.
        RunError: If the file cannot be written.
    """
    panels = Panels(_by_time(runs, rows, times), box, width)
    draw_panels(panels, Colouring("pressure", (-limit, limit), cmap="coolwarm"), path)


def draw_debris(
    runs: dict[str, Path],
    path: Path,
    *,
    columns: Iterable[str],
    box: np.ndarray,
    cut: str = "y=0",
    projectile: str | None = None,
    width: int = 360,
) -> None:
    """Draw kernel types at the end in 3D: above cut open, below as a whole (Young et al., Figures 14 and 13).

    Args:
        runs: Folders of the runs by the name of the row in the case.
        path: The .png file.
        columns: Names of the runs to draw.
        box: Lower and upper corner of what is shown [m], shape [2, 3].
        cut: Cut plane, see `warpsph.drawing.camera.parse_cut`; the upper row looks straight at it.
        projectile: Name of the body that is told from the others, or None.
        width: Width of a panel [pixels].

    Raises:
        RunError: If the file cannot be written, or this machine cannot draw in 3D.
    """
    last = {name: snapshot.read(snapshot.find(runs[name])[-1]) for name in columns}
    sights = {"cross-section": Sight(cut=cut), "oblique view": Sight()}
    draw_panels(Panels(dict.fromkeys(sights, last), box, width, sights), KernelColours(projectile), path)


def _by_time(
    runs: dict[str, Path], names: Iterable[str], times: Iterable[float]
) -> dict[str, dict[str, State | None]]:
    """States by the run's name and the time in µs, ms or s; None where there is no snapshot.

    Raises:
        InputError: If there are none.
    """
    times = list(times)
    factor, unit = units.scale("s", max(times))
    states = {
        name: {f"{time * factor:.3g} {unit}": nearest(runs[name], time) for time in times} for name in names
    }
    if all(state is None for row in states.values() for state in row.values()):
        raise measuring.no_snapshot_then(states)
    return states


def nearest(folder: Path, time: float) -> State | None:
    """The state of a run at a time [s], or None if it has no snapshot close to it."""
    paths = snapshot.find(folder)
    gaps = [abs(snapshot.time(path) - time) for path in paths]
    if not gaps or min(gaps) > CLOSE * time:
        return None
    return snapshot.read(paths[int(np.argmin(gaps))])
