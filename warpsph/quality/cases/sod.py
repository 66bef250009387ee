"""Shock tube."""

from .tables import COST, ENERGY, MOMENTUM, Case, Convergence, Figure, Row, Table

LIMITS = {"l1_rho": ("density", 0.01), "l1_v": ("velocity", 0.02), "l1_p": ("pressure", 0.01)}
"""Title of each error, and what it is held to with artificial viscosity from 400 particles on."""

RESOLUTIONS = (100, 200, 400, 800)
VISCOUS, GODUNOV = ("sav1", "av", "sav1-mixed"), ("pm", "ts1", "ts2", "ts2-mixed")


def sod() -> Case:
    """Sod's tube, in double precision; the limits on the errors guard what is reached, no paper prints them."""
    limited = tuple(Figure(k, t, style=".4f", expected=(0.0, limit)) for k, (t, limit) in LIMITS.items())
    errors = tuple(Figure(k, t, style=".4f") for k, (t, _) in LIMITS.items())
    rest = (ENERGY, MOMENTUM, *COST)
    plane = tuple(Row(f"{s}, 2D", {"scheme": s, "particles": 100, "dim": 2}) for s in VISCOUS + GODUNOV)
    return Case(
        "sod",
        (
            Table("Artificial viscosity", (*limited, *rest), _rows(VISCOUS)),
            Table("Godunov schemes", (*errors, *rest), _rows(GODUNOV)),
            Table("In two dimensions, 100 particles along the tube", (*errors, *rest), plane),
        ),
        convergence=Convergence(
            "Order of convergence from 100 to 200, to 400, to 800 particles",
            errors,
            {s: tuple(f"{s}, {n}" for n in RESOLUTIONS) for s in VISCOUS + GODUNOV},
        ),
    )


def _rows(schemes: tuple[str, ...]) -> tuple[Row, ...]:
    """Every scheme at every resolution; nothing is expected of errors below 400 particles."""
    return tuple(
        Row(f"{s}, {n}", {"scheme": s, "particles": n}, unexpected=tuple(LIMITS) if n < 400 else ())
        for s in schemes
        for n in RESOLUTIONS
    )
