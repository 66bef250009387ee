"""Equations of state p(ρ, e); ζ = ρ/ρ0 - 1 and η = ρ/ρ0 throughout."""

import math
from dataclasses import dataclass

from warpsph.kernels.material import EosId

from .law import Law, constant


class Eos(Law):
    """An equation of state p(ρ, e), e the specific internal energy.

    Its shock slope is A of Us = c + A u, the speed of a shock into the reference state (ρ0, e = 0) that jumps the
    velocity by u. For a weak shock it follows from the sound speed: to second order in strength a shock changes the
    entropy by nothing and runs at the mean of the wave speeds before and behind it, Us = (c + u + c')/2. On the
    isentrope du = c dρ/ρ, so c' = c + u d(ln c)/d(ln ρ) and

        A = (1 + d ln c/d ln ρ)/2    along the isentrope, at the reference state.

    There p = 0, so e does not change to first order either and d ln c/d ln ρ is read off c² of `warpsph.kernels.eos`.
    """

    def bulk_speed(self, density: float) -> float:
        """Sound speed at rest, (ρ0, e = 0) [m/s]; ``density`` is ρ0 [kg/m³]."""
        return self.c0

    def shock_slope(self, density: float) -> float:
        """A of Us = c + A u; ``density`` is ρ0 [kg/m³]. The Hugoniot of most solids is given by it."""
        return self.S1


@dataclass(frozen=True)
class LinearElastic(Eos):
    """p = K ζ; c² = K/ρ0."""

    id = EosId.LINEAR_ELASTIC
    title = "linear elastic"
    equation = "p = K ζ"
    reference = "Hooke's law"

    K: float = constant("Pa", "bulk modulus")

    def bulk_speed(self, density: float) -> float:
        """sqrt(K/ρ0) [m/s]."""
        return math.sqrt(self.K / density)

    def shock_slope(self, density: float) -> float:
        """1/2, the weak limit: c does not change."""
        return 0.5


@dataclass(frozen=True)
class StiffenedGas(Eos):
    """p = c0² (ρ - ρ0) + (γ0 - 1) ρ e; the effective Grüneisen parameter is γ0 - 1."""

    id = EosId.STIFFENED_GAS
    title = "stiffened gas"
    equation = "p = c0² (ρ - ρ0) + (γ0 - 1) ρ e"
    reference = "Young et al., AdapTLE, Eq. 17"

    c0: float = constant("m/s", "bulk sound speed")
    gamma0: float = constant("1", "γ0", "1 or more")

    def shock_slope(self, density: float) -> float:
        """(γ0 + 1)/4, the weak limit: dc²/d ln ρ = (γ0 - 1) c²."""
        return 0.25 * (self.gamma0 + 1.0)


@dataclass(frozen=True)
class IsothermalMieGrueneisen(Eos):
    """p = ρ0 c0² ζ/(1 - (S1 - 1) ζ): the denominator is not squared, as printed in the paper."""

    id = EosId.ISOTHERMAL_MIE_GRUENEISEN
    title = "isothermal Mie-Grüneisen"
    equation = "p = ρ0 c0² ζ/(1 - (S1 - 1) ζ)"
    reference = "Connolly et al. 2013, Eq. 36"

    c0: float = constant("m/s", "bulk sound speed")
    S1: float = constant("1", "slope of the shock velocity", "zero or positive")

    def shock_slope(self, density: float) -> float:
        """S1/2, the weak limit: c = c0/(1 - (S1 - 1) ζ), so d ln c/d ln ρ = S1 - 1. S1 itself needs the full Hugoniot."""
        return 0.5 * self.S1


@dataclass(frozen=True)
class ShockMieGrueneisen(Eos):
    """p = ρ0 c0² ζ (η - Γ0 ζ/2)/(η - S1 ζ)² + ρ0 Γ0 e: the Hugoniot Us = c0 + S1 up as reference curve."""

    id = EosId.SHOCK_MIE_GRUENEISEN
    title = "shock Mie-Grüneisen"
    equation = "p = ρ0 c0² ζ (η - Γ0 ζ/2)/(η - S1 ζ)² + ρ0 Γ0 e"
    reference = "Connolly et al. 2013, Eq. 37"

    c0: float = constant("m/s", "bulk sound speed")
    S1: float = constant("1", "slope of the shock velocity", "zero or positive")
    Gamma0: float = constant("1", "Grüneisen parameter Γ0", "zero or positive")


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

    c0: float = constant("m/s", "bulk sound speed")
    S1: float = constant("1", "first slope of the shock velocity", "zero or positive")
    S2: float = constant("1", "second slope", "any finite number", 0.0)
    S3: float = constant("1", "third slope", "any finite number", 0.0)
    Gamma0: float = constant("1", "Grüneisen parameter Γ0", "zero or positive")
    a: float = constant("1", "first-order volume correction of Γ0", "any finite number", 0.0)


@dataclass(frozen=True)
class Polynomial(Eos):
    """p = k1 ζ + k2 ζ² + k3 ζ³ + (B0 + B1 ζ) ρ0 e, with k2 = k3 = 0 in tension; no bulking."""

    id = EosId.POLYNOMIAL
    title = "polynomial"
    equation = "p = k1 ζ + k2 ζ² + k3 ζ³ + (B0 + B1 ζ) ρ0 e, k2 = k3 = 0 in tension"
    reference = "Connolly et al. 2013, Eq. 39"

    k1: float = constant("Pa", "bulk modulus")
    k2: float = constant("Pa", "second coefficient", "any finite number", 0.0)
    k3: float = constant("Pa", "third coefficient", "any finite number", 0.0)
    B0: float = constant("1", "energy coefficient at ρ0", "zero or positive", 0.0)
    B1: float = constant("1", "energy coefficient of ζ", "any finite number", 0.0)

    def bulk_speed(self, density: float) -> float:
        """sqrt(k1/ρ0) [m/s]."""
        return math.sqrt(self.k1 / density)

    def shock_slope(self, density: float) -> float:
        """(1 + k2/k1 + B0/2)/2, the weak limit: dc²/d ln ρ = (2 k2 + B0 k1)/ρ0, with c² = k1/ρ0."""
        return 0.5 * (1.0 + self.k2 / self.k1 + 0.5 * self.B0)


@dataclass(frozen=True)
class IdealGas(Eos):
    """p = (γ - 1) ρ e; c² = γ (γ - 1) e."""

    id = EosId.IDEAL_GAS
    title = "ideal gas"
    equation = "p = (γ - 1) ρ e"
    reference = "ideal gas law"

    gamma: float = constant("1", "ratio of specific heats", "more than 1")

    def bulk_speed(self, density: float) -> float:
        """0 m/s: a gas without internal energy is cold."""
        return 0.0

    def shock_slope(self, density: float) -> float:
        """(γ + 1)/2, exact for a shock into cold gas, c = 0: the density behind is (γ + 1)/(γ - 1) times that before."""
        return 0.5 * (self.gamma + 1.0)
