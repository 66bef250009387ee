"""Schemes: what is solved, one file per family; `SCHEMES` names every one a user can ask for."""

from dataclasses import dataclass


@dataclass(frozen=True)
class EulerianSettings:
    """Compile-time and run-time choices of the Eulerian family (method section 3).

    Attributes:
        viscosity: ``"monaghan"``, ``"balsara"`` or ``"morris"``.
        alpha: Linear coefficient of the artificial viscosity; the switch scales it (``"morris"``: from 0.1 upwards).
        beta: Quadratic coefficient.
        correction: Mixed kernel-and-gradient correction (section 2).
        gradient_ratio: ``Cf`` of the correction's limiter.
        artificial_stress: Gray et al.'s artificial stress.
    """

    viscosity: str
    alpha: float
    beta: float
    correction: bool = False
    gradient_ratio: float = 7.5
    artificial_stress: bool = False


def _variants() -> dict[str, EulerianSettings]:
    """Every viscosity, each plain, with artificial stress, with mixed correction, and with both."""
    viscosities = {
        "sav1": ("monaghan", 1.0, 2.0),
        "sav2": ("monaghan", 2.5, 2.5),
        "bal": ("balsara", 1.0, 2.0),
        "mon": ("morris", 1.0, 2.0),
    }
    table = {}
    for name, viscosity in viscosities.items():
        table[name] = EulerianSettings(*viscosity)
        table[f"{name}-as"] = EulerianSettings(*viscosity, artificial_stress=True)
        table[f"{name}-mixed"] = EulerianSettings(*viscosity, correction=True)
        table[f"{name}-mixed-as"] = EulerianSettings(
            *viscosity, correction=True, gradient_ratio=90.0, artificial_stress=True
        )
    return table


SCHEMES: dict[str, EulerianSettings] = _variants()
"""Settings of every scheme by its name on the command line."""
