"""Steel sphere through an aluminium plate."""

from pathlib import Path

import numpy as np

from warpsph.quality.kernel_panels import draw_debris
from warpsph.scenes.debris_3d import FINITE_ELEMENTS

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Picture, Row, Table

SPEED, LENGTH = {"unit": "m/s", "style": ".0f"}, {"unit": "mm", "factor": 1e3}
"""How a speed and a length are shown."""

MEASURED = (
    Figure("debris_velocity", "v_d", **SPEED),
    Figure("plug_velocity", "v_p", **SPEED),
    Figure("impact_diameter", "d_i", **LENGTH),
    Figure("plug_width", "w_p", **LENGTH),
    Figure("lip_height", "h_pl", **LENGTH),
)
"""Columns of Young et al.'s Table 2."""

ERRORS = (
    Figure("velocity_error", "error of velocities", "%", 100.0, ".1f", (0.0, 11.0)),
    Figure("mean_error", "error of all five", "%", 100.0, ".1f", (0.0, 9.0)),
)
"""Distance to the finite elements; the paper's own are 11 % and 9 %."""

FIGURES = (
    *MEASURED, *ERRORS,
    Figure("hole_diameter", "hole", **LENGTH),
    Figure("converted_share", "converted", "%", 100.0),
    Figure("failed", "failed", style=".0f"),
    Figure("spalled", "spalled", style=".0f"),
    Figure("interpenetration", "interpenetration", "spacings", expected=(0.0, 0.5)),
    ENERGY, MOMENTUM, *COST,
)  # fmt: skip

FREE = tuple(figure.name for figure in ERRORS)
"""What is expected of adaptle as it is, and of nothing else."""

CONSERVED = ("energy_error", "momentum_error")
"""What the coupling as printed does not conserve."""

PAPER = {"carries": "all", "coupling": "printed", "correction": False, "viscosity": 1.0}
"""Parameters of the paper's simulations."""

QUARTER = {"quarter": True}

SHOWN = np.array([[0.0, 0.0, -2e-3], [30e-3, 30e-3, 62e-3]])
"""Box of the picture [m]."""


def _young(*values: float) -> dict[str, float]:
    """One row of Table 2: v_d, v_p [m/s], d_i, w_p, h_pl [mm]."""
    return {figure.name: value for figure, value in zip(MEASURED, values, strict=True)}


PUBLISHED = {
    "adaptle": _young(257, 373, 14.08, 8.38, 10.16),
    "tlag": _young(270, 443, 13.92, 5.88, 5.69),
    "patch": _young(319, 449, 13.44, 0.88, 9.79),
    "eul": _young(324, 463, 13.32, 0.88, 9.76),
}


def debris_3d() -> Case:
    """Young et al., AdapTLE, section 3.3 and Table 2: the finite elements are the reference."""
    fem = {"finite elements, Young et al.": {f.name: FINITE_ELEMENTS[f.name] * f.factor for f in MEASURED}}
    whole = Row("adaptle, whole plate", {}, PUBLISHED["adaptle"])
    return Case(
        "debris_3d",
        (
            Table("Schemes", FIGURES, (whole, *_schemes()), fem),
            Table("As in the paper", FIGURES, _printed(), fem),
            Table("Variants of adaptle", FIGURES, _variants(), fem),
        ),
        (Picture("debris_3d.png", _draw),),
    )


def _schemes() -> tuple[Row, ...]:
    """The four simulations with one set of parameters, the scene's."""
    return tuple(
        Row(scheme, QUARTER | {"scheme": scheme}, values, unexpected=() if scheme == "adaptle" else FREE)
        for scheme, values in PUBLISHED.items()
    )


def _printed() -> tuple[Row, ...]:
    """The four simulations with the paper's parameters."""
    return tuple(
        Row(
            f"{scheme}, as printed",
            QUARTER | PAPER | {"scheme": scheme},
            values,
            unexpected=FREE + (CONSERVED if scheme in ("adaptle", "patch") else ()),
        )
        for scheme, values in PUBLISHED.items()
    )


def _variants() -> tuple[Row, ...]:
    """What each choice that the paper leaves open, or that departs from it, comes to."""
    variants = {
        "2 layers": {"layers": 2},
        "strength kept": {"carries": "all"},
        "plain gradients": {"correction": False},
        "α 1": {"viscosity": 1.0},
        "C 0.0101": {"rate_constant": 0.0101},
    }
    return tuple(Row(name, QUARTER | values, unexpected=FREE) for name, values in variants.items())


def _draw(runs: dict[str, Path], path: Path) -> None:
    """Draw the end of the four simulations, from between the planes of symmetry."""
    draw_debris(runs, path, columns=PUBLISHED, box=SHOWN, projectile="debris", width=300)
