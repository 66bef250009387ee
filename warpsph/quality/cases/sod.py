"""Shock tube."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table


def sod() -> Case:
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
