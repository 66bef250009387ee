"""Aluminium disc on aluminium plate."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table


def _young(pressure: float, crater: float, extension: float, travel: float) -> dict[str, float]:
    """One row of Young et al.'s Table 1: P [GPa], d_cra, L_extn, L_proj [cm]."""
    names = ("peak_pressure", "crater_diameter", "projectile_extension", "projectile_travel")
    return dict(zip(names, (pressure, crater, extension, travel), strict=True))


def hvi_2d() -> Case:
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
            Table("Godunov schemes", figures, tuple(Row(s, {"scheme": s}) for s in ("con", "ts1", "ts2"))),
            Table("Variants of sav1", figures, variants),
        ),
    )
