"""Aluminium disc on aluminium plate."""

from pathlib import Path

import numpy as np

from warpsph.quality.kernel_panels import draw_kernel_types

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Picture, Row, Table

LENGTH = {"unit": "cm", "factor": 100.0, "decimals": 1}
GPA = {"unit": "GPa", "factor": 1e-9, "decimals": 1}

PRESSURES = (
    Figure("peak_pressure", "P", expected=(18.0, 21.0), **GPA),
    Figure("peak_pressure_mean", "P, mean", **GPA),
    Figure("peak_tension", "tension", **GPA),
)
LENGTHS = (
    Figure("crater_diameter", "d_cra", expected=(1.9, 2.3), **LENGTH),
    Figure("cavity_diameter", "cavity", **LENGTH),
    Figure("projectile_extension", "L_extn", expected=(0.5, 0.8), **LENGTH),
    Figure("projectile_span", "span", **LENGTH),
    Figure("projectile_travel", "L_proj", expected=(1.8, 2.1), **LENGTH),
    Figure("projectile_spalled", "spalled", style=".0f"),
)
RUN = (ENERGY, MOMENTUM, *COST)

TENSION = (
    Figure("projectile_tension", "tension inside", expected=(18.5, 22.5), **GPA),
    Figure("tension_time", "at", "µs", 1e6, ".1f", expected=(2.2, 2.3), decimals=1),
)
"""Highest tension in the disc, and when; expected: Mehra & Chaturvedi's and the paper's."""

BACK = Figure("back_spalled", "off the back", style=".0f", expected=(0.0, 0.0))
"""The paper's Total Lagrangian disc does not spall there."""

EULERIAN = ("projectile_tension", "tension_time", "back_spalled")
"""What the paper says of its adaptive run alone."""

INTERPENETRATION = Figure("interpenetration", "interpenetration", "spacings", expected=(0.0, 0.5))

CONVERSION = (
    Figure("projectile_lagrangian", "disc still Lagrangian", "%", 100.0, ".0f"),
    Figure("converted_share", "converted", "%", 100.0, ".0f"),
    Figure("inverted", "F given up", style=".0f"),
)
"""What conversion adds."""

COMPARED = ("peak_pressure", "crater_diameter", "projectile_extension", "projectile_travel")
"""Columns of Young et al.'s Table 1: P [GPa], d_cra, L_extn, L_proj [cm]."""


def _young(*values: float) -> dict[str, float]:
    """One row of it."""
    return dict(zip(COMPARED, values, strict=True))


def hvi_2d() -> Case:
    """Young et al., AdapTLE, section 3.2 and Table 1."""
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
        Row("sav1, plane stress", {"plane": "stress"}, unexpected=COMPARED),
        Row("sav1, rings", {"lattice": "rings"}),
        Row("sav1, float32", {}, precision="float32", unexpected=("energy_error", "momentum_error")),
    )
    figures = (*PRESSURES, *LENGTHS, *RUN)
    touching = (*PRESSURES, *TENSION, *LENGTHS, BACK, INTERPENETRATION)
    return Case(
        "hvi_2d",
        (
            Table(
                "Schemes",
                figures,
                tuple(Row(s, {"scheme": s}, published.get(s, {})) for s in schemes),
                others,
            ),
            Table("Contact between disc and plate", (*touching, *RUN), (_contact(),)),
            Table("AdapTLE", (*touching, *CONVERSION, *RUN), _adaptive()),
            Table("Godunov schemes", figures, tuple(Row(s, {"scheme": s}) for s in ("con", "ts1", "ts2"))),
            Table("Variants of sav1", figures, variants),
        ),
        (Picture("hvi_2d_kernels.png", _draw),),
    )


def _contact() -> Row:
    """The Eulerian scheme with contact."""
    paper = _young(19.5, 2.2, 0.6, 1.9)
    return Row("sav1-contact", {"scheme": "sav1-contact"}, paper, unexpected=EULERIAN)


def _adaptive() -> tuple[Row, ...]:
    """Both couplings; the printed one conserves neither energy nor momentum."""
    paper = _young(20.9, 2.2, 0.7, 1.9)
    paper |= {"projectile_tension": 22.5, "tension_time": 2.3, "back_spalled": 0.0}
    printed = {"scheme": "adaptle", "coupling": "printed"}
    return (
        Row("adaptle", {"scheme": "adaptle"}, paper),
        Row("adaptle, coupling as printed", printed, paper, unexpected=("energy_error", "momentum_error")),
    )


def _draw(runs: dict[str, Path], path: Path) -> None:
    """Draw kernel types at the times of the paper's picture; above for both couplings, below all Eulerian."""
    rows = ("adaptle", "adaptle, coupling as printed", "sav1-contact")
    times, box = (2e-6, 4e-6, 6e-6, 8e-6), np.array([[-0.011, -0.016], [0.023, 0.016]])
    draw_kernel_types(runs, path, rows=rows, times=times, box=box, projectile="projectile")
