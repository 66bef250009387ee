"""A material: density, equation of state, strength and damage; and the table of them on the device."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import warp as wp

from warpsph.checks import is_name
from warpsph.kernels.material import DamageId, make_material
from warpsph.kernels.spec import Spec
from warpsph.messages import values

from .damage import Damage, JohnsonCookDamage
from .eos import Eos, IdealGas
from .law import number
from .strength import Fluid, JohnsonCook, JohnsonHolmquist1, Strength

ROOM_TEMPERATURE = 293.15
"""Initial temperature [K] of a material whose laws know none: nothing heats it, and nothing depends on it."""


@dataclass(frozen=True)
class Material:
    """What a body is made of.

    Attributes:
        name: Name in snapshots and reports.
        density: Reference density ρ0 [kg/m³].
        eos: Equation of state.
        strength: Strength law.
        pressure_cutoff: Lowest pressure the material bears [Pa], zero or negative; -inf for none.
        damage: Damage law; None for none, or for that of a strength law that brings its own.
        source: Where the constants come from.
    """

    name: str
    density: float
    eos: Eos
    strength: Strength
    pressure_cutoff: float = -math.inf
    damage: Damage | None = None
    source: str = ""

    def __post_init__(self):
        """Check the parts against each other.

        Raises:
            InputError: Naming the field, its value and what is allowed.
        """
        if not is_name(self.name):
            raise values.refuse("material: name", self.name, "a printable text, not empty")
        owner = f"material {self.name!r}"
        object.__setattr__(self, "density", number(owner, "density", self.density, "positive"))
        for name, kind in (("eos", Eos), ("strength", Strength)):
            if not isinstance(getattr(self, name), kind):
                laws = ", ".join(law.__name__ for law in kind.__subclasses__())
                raise values.refuse(f"{owner}: {name}", getattr(self, name), laws)
        if isinstance(self.eos, IdealGas) and not isinstance(self.strength, Fluid):
            law = type(self.strength).__name__
            raise values.clash(f"{owner}: strength = {law}", "an ideal gas", "Fluid")
        if self.pressure_cutoff != -math.inf:
            cutoff = number(owner, "pressure_cutoff", self.pressure_cutoff, "zero or negative")
            object.__setattr__(self, "pressure_cutoff", cutoff)
        self._check_damage(owner)

    def _check_damage(self, owner: str) -> None:
        """Damage goes with the strength law whose constants it uses, and only one law decides on tension."""
        law = type(self.strength).__name__
        if isinstance(self.strength, JohnsonHolmquist1):
            if self.damage is not None:
                raise values.clash(f"{owner}: damage = {self.damage!r}", law, "None, it has its own")
            if self.pressure_cutoff != -math.inf:
                raise values.clash(
                    f"{owner}: pressure_cutoff = {self.pressure_cutoff:g}", law,
                    "-inf, it fails at its own pressure T",
                )  # fmt: skip
        if self.damage is None:
            return
        if not isinstance(self.damage, JohnsonCookDamage):
            raise values.refuse(f"{owner}: damage", self.damage, "JohnsonCookDamage, None")
        if not isinstance(self.strength, JohnsonCook):
            raise values.clash(f"{owner}: damage = JohnsonCookDamage", f"strength = {law}", "JohnsonCook")

    @property
    def bulk_speed(self) -> float:
        """Bulk sound speed at rest [m/s]; 0 for an ideal gas."""
        return self.eos.bulk_speed(self.density)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa]; 0 for a fluid."""
        return self.strength.G

    @property
    def longitudinal_speed(self) -> float:
        """Longitudinal wave speed at rest, sqrt(c² + 4 G/(3 ρ0)) [m/s]."""
        return math.sqrt(self.bulk_speed**2 + 4.0 * self.shear_modulus / (3.0 * self.density))

    @property
    def initial_temperature(self) -> float:
        """Temperature at the start [K]: T0 of the strength law, else room temperature."""
        return self.strength.T0 if isinstance(self.strength, JohnsonCook) else ROOM_TEMPERATURE

    @property
    def tension_lost(self) -> float:
        """Damage from which on it bears no tension: 0 for a gas, 1 for a ceramic, never (inf) for most metals."""
        if isinstance(self.eos, IdealGas) or self.pressure_cutoff >= 0.0:
            return 0.0
        return 1.0 if self.damage_id == DamageId.JOHNSON_HOLMQUIST_1 else self.strength_lost

    @property
    def strength_lost(self) -> float:
        """Damage from which on a metal bears no shear: 1 where failed particles carry compression only, else inf."""
        return 1.0 if self.damage is not None and self.damage.carries == "compression" else math.inf

    @property
    def young_modulus(self) -> float:
        """Young's modulus 9 K G/(3 K + G) at rest [Pa]; 0 for a fluid."""
        K, G = self.density * self.bulk_speed**2, self.shear_modulus
        return 9.0 * K * G / (3.0 * K + G) if G > 0.0 else 0.0

    @property
    def damage_id(self) -> DamageId:
        """The damage law on the device."""
        if isinstance(self.strength, JohnsonHolmquist1):
            return DamageId.JOHNSON_HOLMQUIST_1
        return DamageId.NONE if self.damage is None else self.damage.id

    def describe(self) -> str:
        """Give everything about the material, one constant a line with its unit."""
        cutoff = "none" if self.pressure_cutoff == -math.inf else f"{self.pressure_cutoff:g} Pa"
        lines = [
            self.name,
            f"density: {self.density:g} kg/m³",
            f"equation of state, {self.eos.describe()}",
            f"strength, {self.strength.describe()}",
        ]
        if self.damage is not None:
            lines.append(f"damage, {self.damage.describe()}")
        lines.append(f"pressure cut-off: {cutoff}")
        if self.bulk_speed > 0.0:
            lines.append(
                f"wave speeds at rest: {self.bulk_speed:.6g} m/s bulk, {self.longitudinal_speed:.6g} m/s longitudinal"
            )
        if self.source:
            lines.append(f"source: {self.source}")
        return "\n".join(lines)


_SPEED_FLOOR = 1e-3
"""Floor of the sound speed over the material's bulk speed at rest."""

_GAS_SPEED_FLOOR = 1e-6
"""Floor of the sound speed of a gas [m/s]: small against anything that moves, so a cold gas stays cold."""

_SHOCK_SLOPE_FLOOR = 1e-3
"""Floor of the slope of the shock velocity: without any the two-shock solver has no vertex; as good as acoustic."""


def pack(materials: Sequence[Material], spec: Spec, device: object = None) -> wp.array:
    """Upload the material table.

    Args:
        materials: Materials in the order of the particles' ``mat``.
        spec: Specialisation of the kernels that read the table.
        device: Warp device; the current one by default.

    Returns:
        Array of the specialisation's material structs, shape [len(materials)].
    """
    row = make_material(spec)
    return wp.array([_row(row, material) for material in materials], dtype=row, device=device)


def _row(row: type, material: Material) -> Any:
    out = row()
    out.eos, out.strength = int(material.eos.id), int(material.strength.id)
    out.damage = int(material.damage_id)
    out.rho0, out.p_min = material.density, material.pressure_cutoff
    if isinstance(material.eos, IdealGas):
        out.p_min = max(material.pressure_cutoff, 0.0)  # a gas bears no tension
    out.c_min = _SPEED_FLOOR * material.bulk_speed or _GAS_SPEED_FLOOR
    out.D_tension, out.D_shear = material.tension_lost, material.strength_lost
    out.A_shock = max(material.eos.shock_slope(material.density), _SHOCK_SLOPE_FLOOR)
    for law in (material.eos, material.strength, material.damage):
        for name, value in (law.row if law is not None else {}).items():
            setattr(out, name, value)
    return out
