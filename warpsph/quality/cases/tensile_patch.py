"""Square under tension in its middle."""

from typing import Any

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

FORMULATIONS = ("tl", "eul", "eul-as", "coupled")

FIRST, LAST = 180, 500
"""Steps of the paper at which it shows pictures."""

FINITE_ELEMENTS = "linear finite elements, plane {}"
"""Rows of a computation of our own, in small strains."""


PRESSURES = (
    Figure("pressure_min", "P, lowest", "Pa", style=".3f"),
    Figure("pressure_max", "P, highest", "Pa", style=".3f"),
)
STRAIN = (
    Figure("strain_pressure_min", "of strain, lowest", "Pa", style=".3f"),
    Figure("strain_pressure_max", "of strain, highest", "Pa", style=".3f"),
)
"""Pressure without the tension that persists."""

FAULTS = (
    Figure("clumping", "clumping"),
    Figure("interface_jump", "jump", "Pa", style=".4f"),
    Figure("drift_y", "drift", "mm", 1e3),
)


def tensile_patch() -> Case:
    """Young et al., AdapTLE, section 3.1 and Figures 4 to 6, which give ranges of pressure after 500 steps."""
    figures = (*PRESSURES, *FAULTS, ENERGY, MOMENTUM, *COST)
    strained = (*PRESSURES, *STRAIN, *FAULTS, ENERGY, MOMENTUM, *COST)
    published = {
        "tl": {"pressure_max": 0.14 / 2.23},
        "eul-as": _range(-0.10, 0.14),
        "coupled": _range(-0.09, 0.12),
    }
    first = tuple(Row(f"{f}, {FIRST} steps", {"formulation": f, "steps": FIRST}) for f in FORMULATIONS)
    last = tuple(Row(f, {"formulation": f}, published.get(f, {})) for f in FORMULATIONS)
    strain = tuple(Row(f"{f}, plane strain", {"formulation": f, "plane": "strain"}) for f in FORMULATIONS)
    return Case(
        "tensile_patch",
        (
            Table(f"After {FIRST} steps", figures, first, _linear((-0.0806, 0.1246), (-0.0420, 0.1540))),
            Table(
                f"After {LAST} steps",
                figures,
                (*last, *strain),
                _linear((-0.0716, 0.0587), (-0.1711, 0.0654)),
            ),
            Table("Coupling", figures, _couplings(published["coupled"])),
            Table("Tension that persists", strained, _persistent()),
        ),
    )


def _range(low: float, high: float) -> dict[str, float]:
    """Lowest and highest pressure [Pa]."""
    return {"pressure_min": low, "pressure_max": high}


def _linear(stress: tuple[float, float], strain: tuple[float, float]) -> dict[str, dict[str, float]]:
    """Rows of the linear theory: lowest and highest pressure [Pa]."""
    both = {"stress": stress, "strain": strain}
    return {FINITE_ELEMENTS.format(plane): _range(*values) for plane, values in both.items()}


def _couplings(paper: dict[str, float]) -> tuple[Row, ...]:
    """Every coupling with every artificial stress between the halves; the printed ones and the one-sided conserve nothing."""
    rows = []
    for coupling in ("conservative", "printed"):
        for stress in ("none", "both", "eulerian"):
            if (coupling, stress) == ("conservative", "both"):
                continue  # the default, above
            values = {"formulation": "coupled", "coupling": coupling, "interface_stress": stress}
            known = dict(paper) if stress == "both" else {"drift_y": 1.2} if stress == "eulerian" else {}
            exact = coupling == "conservative" and stress != "eulerian"
            free = () if exact else ("energy_error", "momentum_error")
            rows.append(Row(f"{coupling}, stress: {stress}", values, known, unexpected=free))
    return tuple(rows)


def _persistent() -> tuple[Row, ...]:
    """Tensions that fit the printed range of pressure with Total Lagrangian kernels; all formulations under their mean."""
    alone = [
        _stays({"formulation": "tl", "tension": tension, "plane": plane})
        for plane in ("stress", "strain")
        for tension in (0.2, 0.3)
    ]
    between = {"tension": 0.25, "plane": "strain"}
    others = [_stays({"formulation": formulation} | between) for formulation in FORMULATIONS]
    printed = [
        _stays(
            {"formulation": "coupled"} | between | {"coupling": "printed", "interface_stress": stress},
            unexpected=("energy_error", "momentum_error"),
        )
        for stress in ("none", "both", "eulerian")
    ]
    return (*alone, *others, *printed)


def _stays(values: dict[str, Any], unexpected: tuple[str, ...] = ()) -> Row:
    """A row of tension that persists, named after its parameters."""
    shown = [f"{value:g} Pa" if name == "tension" else value for name, value in values.items()]
    return Row(", ".join(shown) + ", persists", {"reading": "persistent"} | values, unexpected=unexpected)
