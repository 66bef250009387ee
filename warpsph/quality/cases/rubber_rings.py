"""Rubber rings."""

from pathlib import Path

import numpy as np

from warpsph.quality.panels import Colouring, Panels, draw_panels
from warpsph.storage import snapshot

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Picture, Row, Table

SNAPSHOTS = {"0.5 ms": 4, "1 ms": 8, "1.75 ms": 14, "2.5 ms": 20}
"""Numbers of the snapshots that are shown, by their times."""

BOX = np.array([[-0.14, -0.07], [0.14, 0.07]])
"""What is shown [m]."""

WHOLE = ("gap", "restitution", "pieces")
"""What is expected of rings that do not break."""


def rubber_rings() -> Case:
    """Gray, Monaghan & Swift 2001, section 7: the rings bounce whole; without artificial stress SPH breaks them."""
    figures = (
        Figure("gap", "gap", "mm", 1e3, ".1f", (1.0, 200.0)),
        Figure("restitution", "speed kept", "%", 100.0, ".1f", (10.0, 100.0)),
        Figure("pieces", "pieces", style=".0f", expected=(2.0, 2.0)),
        Figure("largest_piece", "largest piece", "%", 100.0, ".1f"),
        Figure("stretch_max", "largest stretch"),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    schemes = (
        Row("tl"),
        Row("tl-plain", {"scheme": "tl-plain"}),
        Row("tl, half the spacing", {"spacing": 5e-4}),
        Row("tl, twice as stiff a contact", {"stiffness": 0.5}),
        Row("sav1-as", {"scheme": "sav1-as"}),
        Row("sav1-mixed-as", {"scheme": "sav1-mixed-as"}, unexpected=WHOLE),
        Row("sav1", {"scheme": "sav1"}, unexpected=WHOLE),
    )
    pictures = (Picture("rubber_rings.png", _draw),)
    return Case("rubber_rings", (Table("Schemes", figures, schemes),), pictures)


def _draw(runs: dict[str, Path], path: Path) -> None:
    """Draw the pressure of three schemes as the rings meet, are squeezed, part and fly off."""
    states = {
        s: {time: snapshot.read(snapshot.find(runs[s])[k]) for time, k in SNAPSHOTS.items()}
        for s in ("tl", "sav1-as", "sav1")
    }
    draw_panels(Panels(states, BOX), Colouring("pressure", (-5e7, 5e7), cmap="coolwarm"), path)
