"""The validation cases: what is run, what comes out by the papers, and what is expected; the only place of these numbers."""

from dataclasses import dataclass, field
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
class Case:
    """One scene with the tables its runs fill.

    Attributes:
        scene: Name of the bundled scene, and of the case.
        tables: The tables.
    """

    scene: str
    tables: tuple[Table, ...]


ENERGY = Figure("energy_error", "energy error", style=".1e", expected=(0.0, 1e-10))
MOMENTUM = Figure("momentum_error", "momentum error", style=".1e", expected=(0.0, 1e-12))
"""What every run in double precision is held to."""

COST = (Figure("steps", "steps", style=".0f"), Figure("wall_s", "wall", "s", style=".0f"))
"""What a run cost: not compared."""


def _young(pressure: float, crater: float, extension: float, travel: float) -> dict[str, float]:
    """One row of Young et al.'s Table 1: P [GPa], d_cra, L_extn, L_proj [cm]."""
    names = ("peak_pressure", "crater_diameter", "projectile_extension", "projectile_travel")
    return dict(zip(names, (pressure, crater, extension, travel), strict=True))


def _hvi_2d() -> Case:
    """Young et al., AdapTLE, section 3.2 and Table 1."""
    length = {"unit": "cm", "factor": 100.0, "decimals": 1}
    gpa = {"unit": "GPa", "factor": 1e-9, "decimals": 1}
    figures = (
        Figure("peak_pressure", "P", expected=(18.0, 21.0), **gpa),
        Figure("peak_pressure_mean", "P, mean", **gpa),
        Figure("peak_tension", "tension", **gpa),
        Figure("crater_diameter", "d_cra", expected=(1.9, 2.3), **length),
        Figure("cavity_diameter", "cavity", **length),
        Figure("projectile_extension", "L_extn", expected=(0.5, 0.8), **length),
        Figure("projectile_span", "span", **length),
        Figure("projectile_travel", "L_proj", expected=(1.8, 2.1), **length),
        Figure("projectile_spalled", "spalled", style=".0f"),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    published = {
        "sav1": _young(19.4, 2.1, 0.6, 1.9),
        "sav1-as": _young(19.4, 2.1, 0.6, 1.9),
        "sav1-mixed": _young(19.5, 2.1, 0.7, 2.0),
        "sav1-mixed-as": _young(19.5, 2.1, 0.8, 2.0),
    }
    others = {
        "SAV1, Mehra & Chaturvedi": _young(18.0, 2.0, 0.7, 1.8),
        "free-Lagrange, Howell & Ball": _young(18.6, 1.9, 0.7, 2.0),
    }
    schemes = ("sav1", "sav2", "bal", "mon", "sav1-as", "sav1-mixed", "sav1-mixed-as")
    variants = (
        Row(
            "sav1, plane stress",
            {"plane": "stress"},
            unexpected=(
                "peak_pressure",
                "crater_diameter",
                "projectile_extension",
                "projectile_travel",
            ),
        ),
        Row("sav1, rings", {"lattice": "rings"}),
        Row("sav1, float32", {}, precision="float32", unexpected=("energy_error", "momentum_error")),
    )
    return Case(
        "hvi_2d",
        (
            Table(
                "Schemes",
                figures,
                tuple(Row(s, {"scheme": s}, published.get(s, {})) for s in schemes),
                others,
            ),
            Table("Variants of sav1", figures, variants),
        ),
    )


def _sod() -> Case:
    """Sod's tube, in double precision; the limits on the errors guard what is reached, no paper prints them."""
    limits = {"l1_rho": ("density", 0.01), "l1_v": ("velocity", 0.02), "l1_p": ("pressure", 0.01)}
    fields = tuple(Figure(k, t, style=".4f", expected=(0.0, limit)) for k, (t, limit) in limits.items())
    figures = (*fields, ENERGY, MOMENTUM, *COST)
    coarse = tuple(limits)
    rows = tuple(
        Row(f"{scheme}, {n}", {"scheme": scheme, "particles": n}, unexpected=coarse if n < 400 else ())
        for scheme in ("sav1", "sav1-mixed")
        for n in (100, 200, 400, 800)
    )
    return Case("sod", (Table("Mean error against the exact solution", figures, rows),))


CASES: dict[str, Case] = {case.scene: case for case in (_hvi_2d(), _sod())}
"""Every validation case by its name."""
