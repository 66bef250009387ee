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
        exact_energy: The stepping of section 11; else e' = e + dt de/dt with the velocity at the start of the step.
    """

    viscosity: str
    alpha: float
    beta: float
    correction: bool = False
    gradient_ratio: float = 7.5
    artificial_stress: bool = False
    exact_energy: bool = True


@dataclass(frozen=True)
class GodunovSettings:
    """Compile-time choices of the Godunov family (method section 10).

    Attributes:
        split: Time split into a deviatoric and a hydrodynamic stage; else Parshikov & Medin's scheme.
        order: Order in space, 1 or 2 (time split only).
        correction: Mixed kernel-and-gradient correction (section 2).
        gradient_ratio: ``Cf`` of the correction's limiter.
        exact_energy: The stepping of section 11; else e' = e + dt de/dt with the velocity at the start of the step.
    """

    split: bool
    order: int = 1
    correction: bool = False
    gradient_ratio: float = 7.5
    exact_energy: bool = True


@dataclass(frozen=True)
class LagrangianSettings:
    """Compile-time and run-time choices of the Total Lagrangian and of the coupled schemes (method sections 4 and 5).

    Attributes:
        eulerian: The scheme of Eulerian particles; None if there are none.
        correction: Mixed correction in the reference configuration (section 2).
        alpha: Linear coefficient of the artificial viscosity.
        beta: Quadratic coefficient.
        gradient_ratio: ``Cf`` of the correction's limiter.
    """

    eulerian: EulerianSettings | None = None
    correction: bool = True
    alpha: float = 1.0
    beta: float = 2.0
    gradient_ratio: float = 7.5


Settings = EulerianSettings | GodunovSettings | LagrangianSettings
"""Settings of a scheme of any family."""


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


def _connolly() -> dict[str, Settings]:
    """Schemes of Connolly et al. 2013; ``con`` is what Young et al. call Parshikov & Medin's."""
    table: dict[str, Settings] = {
        "av": EulerianSettings("monaghan", 1.0, 1.0),
        "av-explicit": EulerianSettings("monaghan", 1.0, 1.0, exact_energy=False),
        "pm-explicit": GodunovSettings(split=False, exact_energy=False),
        "con": GodunovSettings(split=False),
    }
    plain = {"pm": (False, 1), "ts1": (True, 1), "ts2": (True, 2)}
    for name, (split, order) in plain.items():
        table[name] = GodunovSettings(split, order)
        table[f"{name}-mixed"] = GodunovSettings(split, order, correction=True)
    return table


def _young() -> dict[str, Settings]:
    """Total Lagrangian schemes, and those coupled with Eulerian particles (Young et al.)."""
    table: dict[str, Settings] = {
        "tl": LagrangianSettings(),
        "tl-plain": LagrangianSettings(correction=False),
    }
    sav1 = {name: settings for name, settings in _variants().items() if name.split("-")[0] == "sav1"}
    for name, eulerian in sav1.items():
        variant = name.removeprefix("sav1")
        ratio = eulerian.gradient_ratio
        table[f"adaptle{variant}"] = LagrangianSettings(eulerian, gradient_ratio=ratio)
        if not eulerian.correction:
            table[f"adaptle-plain{variant}"] = LagrangianSettings(eulerian, correction=False)
    return table


SCHEMES: dict[str, Settings] = _variants() | _connolly() | _young()
"""Settings of every scheme by its name on the command line."""
