"""Materials: a density, an equation of state and a strength law, with a library of the ones the papers use.

Every law is a frozen dataclass whose constants carry the literature's letters, in SI units. A missing,
negative or inconsistent constant is an `InputError` when the law is made.
"""

import difflib
import functools
import math
import numbers
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import warp as wp

from .errors import InputError
from .kernels.material import EosId, StrengthId, make_material
from .kernels.spec import Spec

_ALLOWED = {
    "positive": lambda value: value > 0.0,
    "zero or positive": lambda value: value >= 0.0,
    "more than 1": lambda value: value > 1.0,
    "1 or more": lambda value: value >= 1.0,
    "zero or negative": lambda value: value <= 0.0,
    "any finite number": lambda value: True,
}


def _constant(unit: str, meaning: str, allowed: str = "positive", default: float | None = None) -> Any:
    """Declare a constant of a law; without a default it must be given."""
    return field(default=default, metadata={"unit": unit, "meaning": meaning, "allowed": allowed})


def _number(owner: str, name: str, value: object, allowed: str) -> float:
    """Check one number.

    Raises:
        InputError: Naming the constant, its value and what is allowed.
    """
    if value is None:
        raise InputError(f"{owner}: {name} is missing; allowed: {allowed}")
    ok = isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)
    if not ok or not _ALLOWED[allowed](value):
        raise InputError(f"{owner}: {name} = {value!r} is out of range; allowed: {allowed}")
    return float(value)


@dataclass(frozen=True)
class Law:
    """A law with constants: an equation of state or a strength law.

    Attributes:
        id: Number of the law on the device.
        title: Name for people.
        equation: The law in one line.
        reference: Where it comes from.
    """

    id: ClassVar[EosId | StrengthId]
    title: ClassVar[str]
    equation: ClassVar[str]
    reference: ClassVar[str]

    def __post_init__(self):
        """Check every constant and store it as a float.

        Raises:
            InputError: Naming the constant, its value and what is allowed.
        """
        for f in fields(self):
            value = _number(type(self).__name__, f.name, getattr(self, f.name), f.metadata["allowed"])
            object.__setattr__(self, f.name, value)

    @property
    def constants(self) -> dict[str, float]:
        """The constants by their letters, SI units."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def describe(self) -> str:
        """Give the law, its equation and a line for each constant."""
        lines = [f"{self.title}: {self.equation}  ({self.reference})"]
        for f in fields(self):
            lines.append(
                f"  {f.name:<7} {getattr(self, f.name):<12.6g} {f.metadata['unit']:<7} {f.metadata['meaning']}"
            )
        return "\n".join(lines)


class Eos(Law):
    """An equation of state p(ρ, e); ζ = ρ/ρ0 - 1, η = ρ/ρ0, e specific internal energy."""

    def bulk_speed(self, density: float) -> float:
        """Sound speed at rest, (ρ0, e = 0) [m/s]; ``density`` is ρ0 [kg/m³]."""
        return self.c0


@dataclass(frozen=True)
class LinearElastic(Eos):
    """p = K ζ; c² = K/ρ0."""

    id = EosId.LINEAR_ELASTIC
    title = "linear elastic"
    equation = "p = K ζ"
    reference = "Hooke's law"

    K: float = _constant("Pa", "bulk modulus")

    def bulk_speed(self, density: float) -> float:
        """sqrt(K/ρ0) [m/s]."""
        return math.sqrt(self.K / density)


@dataclass(frozen=True)
class StiffenedGas(Eos):
    """p = c0² (ρ - ρ0) + (γ0 - 1) ρ e; the effective Grüneisen parameter is γ0 - 1."""

    id = EosId.STIFFENED_GAS
    title = "stiffened gas"
    equation = "p = c0² (ρ - ρ0) + (γ0 - 1) ρ e"
    reference = "Young et al., AdapTLE, Eq. 17"

    c0: float = _constant("m/s", "bulk sound speed")
    gamma0: float = _constant("1", "γ0", "1 or more")


@dataclass(frozen=True)
class IsothermalMieGrueneisen(Eos):
    """p = ρ0 c0² ζ/(1 - (S1 - 1) ζ): the denominator is not squared, as printed in the paper."""

    id = EosId.ISOTHERMAL_MIE_GRUENEISEN
    title = "isothermal Mie-Grüneisen"
    equation = "p = ρ0 c0² ζ/(1 - (S1 - 1) ζ)"
    reference = "Connolly et al. 2013, Eq. 36"

    c0: float = _constant("m/s", "bulk sound speed")
    S1: float = _constant("1", "slope of the shock velocity", "zero or positive")


@dataclass(frozen=True)
class ShockMieGrueneisen(Eos):
    """p = ρ0 c0² ζ (η - Γ0 ζ/2)/(η - S1 ζ)² + ρ0 Γ0 e: the Hugoniot Us = c0 + S1 up as reference curve."""

    id = EosId.SHOCK_MIE_GRUENEISEN
    title = "shock Mie-Grüneisen"
    equation = "p = ρ0 c0² ζ (η - Γ0 ζ/2)/(η - S1 ζ)² + ρ0 Γ0 e"
    reference = "Connolly et al. 2013, Eq. 37"

    c0: float = _constant("m/s", "bulk sound speed")
    S1: float = _constant("1", "slope of the shock velocity", "zero or positive")
    Gamma0: float = _constant("1", "Grüneisen parameter Γ0", "zero or positive")


@dataclass(frozen=True)
class CubicGrueneisen(Eos):
    """Grüneisen form with the cubic shock velocity Us = c0 + S1 up + S2 (up/Us) up + S3 (up/Us)² up.

    Compression: p = ρ0 c0² ζ [1 + (1 - Γ0/2) ζ - a/2 ζ²]/[1 - (S1 - 1) ζ - S2 ζ²/η - S3 ζ³/η²]² + (Γ0 + a ζ) ρ0 e.
    Tension: p = ρ0 c0² ζ + (Γ0 + a ζ) ρ0 e.
    """

    id = EosId.CUBIC_GRUENEISEN
    title = "Grüneisen, cubic shock velocity"
    equation = (
        "p = ρ0 c0² ζ [1 + (1 - Γ0/2) ζ - a/2 ζ²]/[1 - (S1 - 1) ζ - S2 ζ²/η - S3 ζ³/η²]² + (Γ0 + a ζ) ρ0 e"
    )
    reference = "LS-DYNA manual, *EOS_GRUNEISEN"

    c0: float = _constant("m/s", "bulk sound speed")
    S1: float = _constant("1", "first slope of the shock velocity", "zero or positive")
    S2: float = _constant("1", "second slope", "any finite number", 0.0)
    S3: float = _constant("1", "third slope", "any finite number", 0.0)
    Gamma0: float = _constant("1", "Grüneisen parameter Γ0", "zero or positive")
    a: float = _constant("1", "first-order volume correction of Γ0", "any finite number", 0.0)


@dataclass(frozen=True)
class Polynomial(Eos):
    """p = k1 ζ + k2 ζ² + k3 ζ³ + (B0 + B1 ζ) ρ0 e, with k2 = k3 = 0 in tension; no bulking."""

    id = EosId.POLYNOMIAL
    title = "polynomial"
    equation = "p = k1 ζ + k2 ζ² + k3 ζ³ + (B0 + B1 ζ) ρ0 e, k2 = k3 = 0 in tension"
    reference = "Connolly et al. 2013, Eq. 39"

    k1: float = _constant("Pa", "bulk modulus")
    k2: float = _constant("Pa", "second coefficient", "any finite number", 0.0)
    k3: float = _constant("Pa", "third coefficient", "any finite number", 0.0)
    B0: float = _constant("1", "energy coefficient at ρ0", "zero or positive", 0.0)
    B1: float = _constant("1", "energy coefficient of ζ", "any finite number", 0.0)

    def bulk_speed(self, density: float) -> float:
        """sqrt(k1/ρ0) [m/s]."""
        return math.sqrt(self.k1 / density)


@dataclass(frozen=True)
class IdealGas(Eos):
    """p = (γ - 1) ρ e; c² = γ (γ - 1) e."""

    id = EosId.IDEAL_GAS
    title = "ideal gas"
    equation = "p = (γ - 1) ρ e"
    reference = "ideal gas law"

    gamma: float = _constant("1", "ratio of specific heats", "more than 1")

    def bulk_speed(self, density: float) -> float:
        """0 m/s: a gas without internal energy is cold."""
        return 0.0


class Strength(Law):
    """A strength law: shear modulus ``G`` and flow stress Y(εp)."""

    G: float = 0.0


@dataclass(frozen=True)
class Fluid(Strength):
    """No shear stress at all."""

    id = StrengthId.FLUID
    title = "fluid"
    equation = "Y = 0"
    reference = "no shear strength"


@dataclass(frozen=True)
class Elastic(Strength):
    """Elastic in shear without limit."""

    id = StrengthId.ELASTIC
    title = "elastic"
    equation = "Y = ∞"
    reference = "Hooke's law"

    G: float = _constant("Pa", "shear modulus")


@dataclass(frozen=True)
class PerfectlyPlastic(Strength):
    """Elastic up to a constant flow stress."""

    id = StrengthId.PERFECTLY_PLASTIC
    title = "elastic, perfectly plastic"
    equation = "flow stress Y"
    reference = "von Mises 1913"

    G: float = _constant("Pa", "shear modulus")
    Y: float = _constant("Pa", "flow stress")


@dataclass(frozen=True)
class LinearHardening(Strength):
    """Elastic up to the flow stress Y + H εp."""

    id = StrengthId.LINEAR_HARDENING
    title = "elastic, linear isotropic hardening"
    equation = "flow stress Y + H εp"
    reference = "Simo & Hughes 1998, section 1.2"

    G: float = _constant("Pa", "shear modulus")
    Y: float = _constant("Pa", "initial flow stress")
    H: float = _constant("Pa", "hardening modulus dY/dεp", "zero or positive")

    @classmethod
    def from_tangent_modulus(cls, *, G: float, Y: float, E: float, Ep: float) -> "LinearHardening":
        """Make the law from the slope ``Ep`` of the stress-strain curve beyond yield: H = E Ep/(E - Ep).

        Args:
            G: Shear modulus [Pa].
            Y: Initial flow stress [Pa].
            E: Young's modulus [Pa].
            Ep: Tangent modulus dσ/dε in uniaxial tension [Pa].

        Raises:
            InputError: If a modulus is negative, or not 0 <= Ep < E < 3 G.
        """
        owner = cls.__name__
        G, E, Ep = (
            _number(owner, name, value, allowed)
            for name, value, allowed in (
                ("G", G, "positive"),
                ("E", E, "positive"),
                ("Ep", Ep, "zero or positive"),
            )
        )
        if Ep >= E:
            raise InputError(
                f"{owner}: Ep = {Ep:g} does not fit E = {E:g}; allowed: a tangent modulus below E"
            )
        if E >= 3.0 * G:
            raise InputError(
                f"{owner}: E = {E:g} does not fit G = {G:g}; allowed: below 3 G (Poisson's ratio < 0.5)"
            )
        return cls(G=G, Y=Y, H=E * Ep / (E - Ep))


def moduli(E: float, nu: float) -> tuple[float, float]:
    """Bulk and shear modulus (K, G) [Pa] from Young's modulus ``E`` [Pa] and Poisson's ratio ``nu``.

    Raises:
        InputError: If E is not positive or nu not between -1 and 0.5.
    """
    E = _number("moduli", "E", E, "positive")
    nu = _number("moduli", "nu", nu, "any finite number")
    if not -1.0 < nu < 0.5:
        raise InputError(f"moduli: nu = {nu!r} is out of range; allowed: more than -1 and less than 0.5")
    return E / (3.0 * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))


@dataclass(frozen=True)
class Material:
    """What a body is made of.

    Attributes:
        name: Name in snapshots and reports.
        density: Reference density ρ0 [kg/m³].
        eos: Equation of state.
        strength: Strength law.
        pressure_cutoff: Lowest pressure the material bears [Pa], zero or negative; -inf for none.
        source: Where the constants come from.
    """

    name: str
    density: float
    eos: Eos
    strength: Strength
    pressure_cutoff: float = -math.inf
    source: str = ""

    def __post_init__(self):
        """Check the parts against each other.

        Raises:
            InputError: Naming the field, its value and what is allowed.
        """
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"material: name = {self.name!r} is not allowed; allowed: a non-empty text")
        owner = f"material {self.name!r}"
        object.__setattr__(self, "density", _number(owner, "density", self.density, "positive"))
        for name, kind in (("eos", Eos), ("strength", Strength)):
            if not isinstance(getattr(self, name), kind):
                laws = ", ".join(law.__name__ for law in kind.__subclasses__())
                raise InputError(f"{owner}: {name} = {getattr(self, name)!r} is not allowed; allowed: {laws}")
        if isinstance(self.eos, IdealGas) and not isinstance(self.strength, Fluid):
            law = type(self.strength).__name__
            raise InputError(f"{owner}: strength = {law} does not fit an ideal gas; allowed: Fluid")
        if self.pressure_cutoff != -math.inf:
            cutoff = _number(owner, "pressure_cutoff", self.pressure_cutoff, "zero or negative")
            object.__setattr__(self, "pressure_cutoff", cutoff)

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

    def describe(self) -> str:
        """Give everything about the material, one constant a line with its unit."""
        cutoff = "none" if self.pressure_cutoff == -math.inf else f"{self.pressure_cutoff:g} Pa"
        lines = [
            self.name,
            f"density: {self.density:g} kg/m³",
            f"equation of state, {self.eos.describe()}",
            f"strength, {self.strength.describe()}",
            f"pressure cut-off: {cutoff}",
        ]
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
    out.rho0, out.p_min = material.density, material.pressure_cutoff
    out.c_min = _SPEED_FLOOR * material.bulk_speed or _GAS_SPEED_FLOOR
    for name, value in (material.eos.constants | material.strength.constants).items():
        setattr(out, name, value)
    return out


@functools.cache
def _library() -> dict[str, Material]:
    young = "Young et al., adaptive Total Lagrangian-Eulerian SPH (AdapTLE)"
    connolly = "Connolly et al. 2013, Second order Godunov SPH for high velocity impact dynamics"
    steel_K, steel_G = moduli(E=200e9, nu=0.30)
    patch_K, patch_G = moduli(E=1.0, nu=0.3)
    flyer = PerfectlyPlastic(G=48.1e9, Y=2.5e9)
    beryllium = ShockMieGrueneisen(c0=12870.0, S1=1.124, Gamma0=2.0)
    entries = (
        Material(
            "aluminium", 2785.0, StiffenedGas(c0=5328.0, gamma0=2.0), PerfectlyPlastic(G=27.6e9, Y=0.3e9),
            source=f"{young}, section 3.2",
        ),
        Material(
            "steel", 7870.0, LinearElastic(K=steel_K), LinearHardening(G=steel_G, Y=315e6, H=16.2e9),
            source=f"{young}, section 3.3: E 200 GPa, nu 0.30, its plastic modulus read as dY/dεp",
        ),
        Material(
            "steel-tangent", 7870.0, LinearElastic(K=steel_K),
            LinearHardening.from_tangent_modulus(G=steel_G, Y=315e6, E=200e9, Ep=16.2e9),
            source=f"{young}, section 3.3: E 200 GPa, nu 0.30, its plastic modulus read as the tangent modulus",
        ),
        Material(
            "patch", 1.0, LinearElastic(K=patch_K), Elastic(G=patch_G),
            source=f"{young}, section 3.1: E 1 Pa, nu 0.3",
        ),
        Material(
            "flyer", 6100.0, IsothermalMieGrueneisen(c0=5077.0, S1=1.201), flyer,
            source=f"{connolly}, section 4.1",
        ),
        Material(
            "flyer-full", 6100.0, ShockMieGrueneisen(c0=5077.0, S1=1.201, Gamma0=0.0), flyer,
            source=f"{connolly}, section 4.1, with the shock form of Eq. 37 in place of the printed Eq. 36",
        ),
        Material(
            "beryllium", 1845.0, beryllium, PerfectlyPlastic(G=151e9, Y=330e6),
            source=f"{connolly}, section 4.2, with the shear modulus of the literature (printed: 15.1 GPa)",
        ),
        Material(
            "beryllium-printed", 1845.0, beryllium, PerfectlyPlastic(G=15.1e9, Y=330e6),
            source=f"{connolly}, section 4.2, shear modulus as printed (a tenth of the literature's)",
        ),
        Material(
            "air", 1.225, IdealGas(gamma=1.4), Fluid(),
            source="ISO 2533 standard atmosphere at sea level; diatomic ideal gas",
        ),
    )  # fmt: skip
    return {material.name: material for material in entries}


def names() -> tuple[str, ...]:
    """Names of the library's materials."""
    return tuple(_library())


def get(name: str) -> Material:
    """Look a material of the library up.

    Raises:
        InputError: If there is none of that name; suggests the closest and lists all.
    """
    library = _library()
    if name in library:
        return library[name]
    close = difflib.get_close_matches(str(name), library, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    raise InputError(f"material {name!r} is unknown; {hint}allowed: {', '.join(library)}")
