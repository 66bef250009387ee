"""Aluminium disc on aluminium plate."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

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

TENSION_TIME = Figure("tension_time", "at", "µs", 1e6, ".1f")
"""When the tension peaked."""

BACK = Figure("back_spalled", "off the back", style=".0f")

INTERPENETRATION = Figure("interpenetration", "interpenetration", "spacings", expected=(0.0, 0.5))

CONVERSION = (
    Figure("projectile_lagrangian", "disc still Lagrangian", "%", 100.0, ".0f"),
    Figure("converted_share", "converted", "%", 100.0, ".0f"),
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
    touching = (*PRESSURES, TENSION_TIME, *LENGTHS, BACK, INTERPENETRATION)
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
    )


def _contact() -> Row:
    """The Eulerian scheme with contact."""
    return Row("sav1-contact", {"scheme": "sav1-contact"}, _young(19.5, 2.2, 0.6, 1.9))


def _adaptive() -> tuple[Row, ...]:
    """The paper says plane stress of its run, with a pressure that belongs to plane strain."""
    paper = _young(20.9, 2.2, 0.7, 1.9) | {"peak_tension": 22.5, "tension_time": 2.3}
    printed, sheet = {"scheme": "adaptle", "coupling": "printed"}, {"scheme": "adaptle", "plane": "stress"}
    return (
        Row("adaptle", {"scheme": "adaptle"}, paper),
        Row("adaptle, coupling as printed", printed, paper, unexpected=("energy_error", "momentum_error")),
        Row("adaptle, plane stress", sheet, paper, unexpected=COMPARED),
    )
