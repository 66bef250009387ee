"""What a validation case is made of: figures, rows and tables."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal


@dataclass(frozen=True)
class Figure:
    """One figure of a run's summary, as a column of a table.

    Attributes:
        name: Its name in the summary, or among the summary's measures.
        title: Head of the column.
        unit: Unit to show.
        factor: Unit to show over the SI unit.
        style: Format.
        expected: Lowest and highest value expected, in the unit to show; None if nothing is.
        decimals: A value is rounded so for the comparison: to the precision that the source prints.
    """

    name: str
    title: str
    unit: str = "1"
    factor: float = 1.0
    style: str = ".2f"
    expected: tuple[float, float] | None = None
    decimals: int | None = None


@dataclass(frozen=True)
class Row:
    """One run.

    Attributes:
        name: Name of the row, and of its folder.
        parameters: Parameters of the scene.
        paper: Published values by the name of the figure, in the unit to show.
        precision: ``float64`` or ``float32``.
        unexpected: Figures that nothing is expected of in this row.
    """

    name: str
    parameters: dict[str, Any] = field(default_factory=dict)
    paper: dict[str, float] = field(default_factory=dict)
    precision: Literal["float64", "float32"] = "float64"
    unexpected: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """Runs that belong into one table.

    Attributes:
        title: Heading.
        figures: Columns.
        rows: Runs.
        others: Published rows that are not run, by name: values by the name of the figure, in the unit to show.
    """

    title: str
    figures: tuple[Figure, ...]
    rows: tuple[Row, ...]
    others: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Convergence:
    """How fast errors fall with resolution, as a table of its own: its runs are those of the other tables.

    Attributes:
        title: Heading.
        figures: The errors, a column each.
        series: Names of rows by what they have in common, from coarse to fine, each twice as fine as the one before.
    """

    title: str
    figures: tuple[Figure, ...]
    series: dict[str, tuple[str, ...]]


@dataclass(frozen=True)
class Picture:
    """A picture made from the runs of a case.

    Attributes:
        file: Name of the file, in docs/images of a checkout or in the output folder.
        draw: Draws it, from the folder of each row's run by the row's name, into the file given.
    """

    file: str
    draw: Callable[[dict[str, Path], Path], None]


@dataclass(frozen=True)
class Case:
    """One scene with the tables its runs fill.

    Attributes:
        scene: Name of the bundled scene, and of the case.
        tables: The tables.
        pictures: Pictures of the runs; not made if a run stopped.
        convergence: Orders of convergence, if there are series of resolutions.
    """

    scene: str
    tables: tuple[Table, ...]
    pictures: tuple[Picture, ...] = ()
    convergence: Convergence | None = None


ENERGY = Figure("energy_error", "energy error", style=".1e", expected=(0.0, 1e-10))
MOMENTUM = Figure("momentum_error", "momentum error", style=".1e", expected=(0.0, 1e-12))
"""What every run in double precision is held to."""

COST = (Figure("steps", "steps", style=".0f"), Figure("wall_s", "wall", "s", style=".0f"))
"""What a run cost: not compared."""
