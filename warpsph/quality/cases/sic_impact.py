"""Steel bar on silicon carbide tile."""

from pathlib import Path

import numpy as np

from warpsph.quality.panels import Colouring, Panels, draw_panels
from warpsph.storage import snapshot

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Picture, Row, Table

TIMES = (5, 10, 15)
"""Times of the paper's Figures 8 and 9 [µs]: one snapshot each microsecond."""

BOX = np.array([[-0.023, -0.052], [0.037, 0.052]])
"""What is shown [m]."""


def sic_impact() -> Case:
    """Connolly et al. 2013, section 5: the paper prints pictures only, and that ts2 spalls fastest."""
    figures = (
        Figure("spall_velocity", "v_spall", "m/s", style=".0f"),
        Figure("spall_velocity_peak", "highest ever", "m/s", style=".0f"),
        Figure("rear_velocity", "v, rear centre", "m/s", style=".0f"),
        Figure("damaged_mass", "failed", "kg/m", style=".2f"),
        Figure("damaged_share", "failed", "%", 100.0, ".1f"),
        Figure("penetration", "penetration", "mm", 1e3, ".2f"),
        Figure("gauge_pressure", "P, 2 mm deep", "GPa", 1e-9, ".2f", (7.17, 9.31)),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    schemes = ("av", "ts1", "ts2", "pm")
    rows = tuple(Row(s, {"scheme": s}) for s in schemes)
    pictures = (
        Picture("sic_impact_damage.png", _damage),
        Picture("sic_impact_velocity.png", _velocity),
    )
    return Case("sic_impact", (Table("Schemes", figures, rows),), pictures)


def _damage(runs: dict[str, Path], path: Path) -> None:
    draw_panels(_panels(runs), Colouring("damage", (0.0, 1.0), black="projectile"), path)


def _velocity(runs: dict[str, Path], path: Path) -> None:
    draw_panels(_panels(runs), Colouring("velocity_x", (0.0, 400.0), black="projectile"), path)


def _panels(runs: dict[str, Path]) -> Panels:
    """The paper's three schemes at its three times."""
    states = {
        s: {f"{t} µs": snapshot.read(snapshot.find(runs[s])[t]) for t in TIMES} for s in ("av", "ts1", "ts2")
    }
    return Panels(states, BOX, width=200)
