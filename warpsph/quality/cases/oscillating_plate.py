"""Oscillating plate."""

import numpy as np

from warpsph.scenes import oscillating_plate as scene

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

SPEED = 0.05
"""Speed of the end over the sound speed in the scene's default."""


def oscillating_plate() -> Case:
    """Gray, Monaghan & Swift 2001: ten periods. Expected: no more than 10 % slower than the thin plate, never faster."""
    figures = (
        Figure("frequency", "frequency", "Hz", style=".3f"),
        Figure("frequency_ratio", "over thin plate", style=".3f", expected=(0.90, 1.0)),
        Figure("amplitude", "amplitude, last period", "cm", 100.0),
        Figure("amplitude_kept", "kept", "%", 100.0, ".1f"),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    long = {"periods": 10.0}
    lagrangian = (
        Row("tl", long),
        Row("tl-plain", long | {"scheme": "tl-plain"}, unexpected=("frequency_ratio",)),
        Row("tl, 20 across, 2 periods", {"particles": 20, "periods": 2.0}),
        Row("tl, 5 across", long | {"particles": 5}, unexpected=("frequency_ratio",)),
    )
    eulerian = tuple(
        Row(s, {"scheme": s, "periods": 2.0, "viscosity": 1.0}, unexpected=("frequency_ratio",))
        for s in ("sav1-as", "sav1-mixed-as")
    )
    theory = {"thin plate": _thin_plate()}
    return Case(
        "oscillating_plate",
        (
            Table("Total Lagrangian", figures, lagrangian, theory),
            Table("Eulerian, with viscosity, 2 periods", figures, eulerian, theory),
        ),
    )


def _thin_plate() -> dict[str, float]:
    """Frequency [Hz] and amplitude [cm] of the thin plate."""
    frequency = scene.thin_plate_frequency()
    amplitude = SPEED * scene.SOLID.bulk_speed / (2.0 * np.pi * frequency)
    return {"frequency": frequency, "frequency_ratio": 1.0, "amplitude": 100.0 * amplitude}
