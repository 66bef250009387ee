"""Square under tension in its middle."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from warpsph.quality.kernel_panels import draw_pressures

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Picture, Row, Table

FIRST, LAST = 180, 500
"""Steps of the paper at which it shows pictures."""

FINITE_ELEMENTS = "linear finite elements, plane {}"
"""Rows of a computation of our own, in small strains."""

CONSERVED = ("energy_error", "momentum_error")
"""What the coupling as printed, and artificial stress on one side, do not conserve."""

PRESSURES = (
    Figure("pressure_min", "P, lowest", "Pa", style=".3f"),
    Figure("pressure_max", "P, highest", "Pa", style=".3f"),
)
PRINTED = tuple(
    replace(figure, expected=values, decimals=2)
    for figure, values in zip(PRESSURES, ((-0.11, -0.09), (0.06, 0.14)), strict=True)
)
"""The same, expected from the lowest to the highest of the three values that the paper prints or implies."""

STRAIN = (
    Figure("strain_pressure_min", "of strain, lowest", "Pa", style=".3f"),
    Figure("strain_pressure_max", "of strain, highest", "Pa", style=".3f"),
)
"""Pressure without the tension that persists."""

FAULTS = (
    Figure("clumping", "clumping"),
    Figure("interface_jump", "jump", "Pa", style=".4f"),
    Figure("drift_y", "drift", "mm", 1e3, style=".3f"),
)
CONVERSION = (
    Figure("converted_share", "converted", "%", 100.0, ".1f"),
    Figure("inverted", "F given up", style=".0f"),
)
RUN = (ENERGY, MOMENTUM, *COST)

SHOWN = ("tl", "eul-as", "conservative, stress: both", "printed, stress: both")
"""Rows of the picture."""


def tensile_patch() -> Case:
    """Young et al., AdapTLE, section 3.1 and Figures 4 to 6, which give ranges of pressure after 500 steps."""
    figures = (*PRESSURES, *FAULTS, *RUN)
    first = tuple(
        Row(f"{f}, {FIRST} steps", {"formulation": f, "steps": FIRST})
        for f in ("tl", "eul", "eul-as", "coupled")
    )
    last = (
        Row("tl", {"formulation": "tl"}, {"pressure_max": 0.14 / 2.23}),
        Row("eul-as", {"formulation": "eul-as"}, _range(-0.10, 0.14)),
        Row("eul", {"formulation": "eul"}, unexpected=("pressure_min", "pressure_max")),
    )
    return Case(
        "tensile_patch",
        (
            Table(f"After {FIRST} steps", figures, first, _linear((-0.0403, 0.0623), (-0.0210, 0.0770))),
            Table(f"After {LAST} steps", (*PRINTED, *FAULTS, *RUN), last),
            Table("Coupled halves", (*PRINTED, *FAULTS, *CONVERSION, *RUN), _couplings()),
            Table("Other readings", figures, _readings(), _linear((-0.0358, 0.0294), (-0.0856, 0.0327))),
            Table("Tension that persists", (*PRESSURES, *STRAIN, *FAULTS, *RUN), _persistent()),
        ),
        (Picture("tensile_patch.png", _draw),),
    )


def _range(low: float, high: float) -> dict[str, float]:
    """Lowest and highest pressure [Pa]."""
    return {"pressure_min": low, "pressure_max": high}


def _linear(stress: tuple[float, float], strain: tuple[float, float]) -> dict[str, dict[str, float]]:
    """Rows of the linear theory: lowest and highest pressure [Pa] of an impulse of half a step."""
    both = {"stress": stress, "strain": strain}
    return {FINITE_ELEMENTS.format(plane): _range(*values) for plane, values in both.items()}


def _couplings() -> tuple[Row, ...]:
    """Every coupling with every artificial stress between the halves."""
    return tuple(
        _coupled(coupling, stress)
        for coupling in ("conservative", "printed")
        for stress in ("both", "none", "eulerian")
    )


def _coupled(coupling: str, stress: str, **more: Any) -> Row:
    """A row of coupled halves."""
    values = {"formulation": "coupled", "coupling": coupling, "interface_stress": stress} | more
    paper = {"both": _range(-0.09, 0.12), "eulerian": {"drift_y": 1.2}}.get(stress, {})
    exact = coupling == "conservative" and stress != "eulerian"
    plane = ", plane stress" if "plane" in more else ""
    return Row(f"{coupling}, stress: {stress}{plane}", values, paper, unexpected=() if exact else CONSERVED)


def _readings() -> tuple[Row, ...]:
    """Plane stress, and the impulse of a whole step."""
    sheet, whole = {"plane": "stress"}, {"impulse_steps": 1.0}
    rows = [_single(f, "plane stress", sheet) for f in ("tl", "eul-as")]
    rows += [
        _coupled(*pair, **sheet)
        for pair in (("conservative", "both"), ("printed", "both"), ("printed", "eulerian"))
    ]
    rows += [_single(f, "a whole step", whole) for f in ("tl", "eul-as")]
    return tuple(rows)


def _single(formulation: str, name: str, values: dict[str, Any]) -> Row:
    """A row of one formulation everywhere, of a variant of the problem."""
    return Row(f"{formulation}, {name}", {"formulation": formulation} | values)


def _persistent() -> tuple[Row, ...]:
    """Tensions that fit the printed range of pressure with Total Lagrangian kernels; other formulations under their mean."""
    alone = [
        _stays({"formulation": "tl", "tension": tension, "plane": plane})
        for plane in ("stress", "strain")
        for tension in (0.2, 0.3)
    ]
    between = {"tension": 0.25}
    others = [_stays({"formulation": formulation} | between) for formulation in ("eul-as", "coupled")]
    printed = _stays({"formulation": "coupled"} | between | {"coupling": "printed"}, CONSERVED)
    return (*alone, *others, printed)


def _stays(values: dict[str, Any], unexpected: tuple[str, ...] = ()) -> Row:
    """A row of tension that persists, named after its parameters."""
    shown = [f"{value:g} Pa" if name == "tension" else value for name, value in values.items()]
    name = ", ".join(shown) + ", persists"
    return Row(name, {"reading": "persistent"} | values, unexpected=unexpected)


def _draw(runs: dict[str, Path], path: Path) -> None:
    """Draw the pressure of the formulations at the times of the paper's pictures."""
    box = np.array([[-0.55, -0.55], [0.55, 0.55]])
    draw_pressures(runs, path, rows=SHOWN, times=(0.4654, 1.2929), box=box, limit=0.12)
