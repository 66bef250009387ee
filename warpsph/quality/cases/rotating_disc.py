"""Rotating disc."""

from warpsph.scenes import rotating_disc as scene

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

SPEED = 0.05
"""Speed of the rim over the sound speed in the scene's default."""

_UNEXPECTED = ("angular_momentum_change", "axes_ratio", "pressure_error", "von_mises_error")
"""Plain gradients take a rotation for a strain where neighbours lack; Eulerian schemes integrate rates."""


def rotating_disc() -> Case:
    """One revolution: angular momentum constant, the disc round and in its exact elastic state, whatever its orientation."""
    figures = (
        Figure("angular_momentum_change", "angular momentum", style=".1e", expected=(-1e-6, 1e-6)),
        Figure("radius_growth", "radius", "%", 100.0, ".4f"),
        Figure("axes_ratio", "axes", style=".5f", expected=(0.999, 1.0)),
        Figure("pressure_error", "pressure error", "%", 100.0, ".1f", (0.0, 10.0)),
        Figure("von_mises_error", "von Mises error", "%", 100.0, ".1f", (0.0, 10.0)),
        Figure("von_mises_max", "von Mises over exact"),
        Figure("von_mises_peak", "ever"),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    rows = (
        Row("tl"),
        Row("tl-plain", {"scheme": "tl-plain"}, unexpected=_UNEXPECTED),
        Row("tl, half the spacing", {"spacing": 1e-3}),
        Row("tl, four revolutions", {"turns": 4.0}),
        *(
            Row(s, {"scheme": s}, unexpected=_UNEXPECTED)
            for s in ("sav1-mixed", "sav1-mixed-as", "sav1", "sav1-as")
        ),
    )
    rate = SPEED * scene.SOLID.bulk_speed / scene.RADIUS
    exact = {"exact": {"radius_growth": 100.0 * scene.exact_growth(rate), "von_mises_max": 1.0}}
    return Case("rotating_disc", (Table("Schemes", figures, rows, exact),))
