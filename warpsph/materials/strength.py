"""Strength laws: a shear modulus and a flow stress, and the moduli of elasticity."""

from dataclasses import dataclass

from warpsph.kernels.material import StrengthId
from warpsph.messages import values

from .law import Law, constant, number


class Strength(Law):
    """A strength law: shear modulus ``G`` and flow stress Y."""

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

    G: float = constant("Pa", "shear modulus")


@dataclass(frozen=True)
class PerfectlyPlastic(Strength):
    """Elastic up to a constant flow stress."""

    id = StrengthId.PERFECTLY_PLASTIC
    title = "elastic, perfectly plastic"
    equation = "flow stress Y"
    reference = "von Mises 1913"

    G: float = constant("Pa", "shear modulus")
    Y: float = constant("Pa", "flow stress")


@dataclass(frozen=True)
class LinearHardening(Strength):
    """Elastic up to the flow stress Y + H εp."""

    id = StrengthId.LINEAR_HARDENING
    title = "elastic, linear isotropic hardening"
    equation = "flow stress Y + H εp"
    reference = "Simo & Hughes 1998, section 1.2"

    G: float = constant("Pa", "shear modulus")
    Y: float = constant("Pa", "initial flow stress")
    H: float = constant("Pa", "hardening modulus dY/dεp", "zero or positive")

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
            number(owner, name, value, allowed)
            for name, value, allowed in (
                ("G", G, "positive"),
                ("E", E, "positive"),
                ("Ep", Ep, "zero or positive"),
            )
        )
        if Ep >= E:
            raise values.clash(f"{owner}: Ep = {Ep:g}", f"E = {E:g}", "a tangent modulus below E")
        if E >= 3.0 * G:
            raise values.clash(f"{owner}: E = {E:g}", f"G = {G:g}", "E below 3 G (Poisson's ratio below 0.5)")
        return cls(G=G, Y=Y, H=E * Ep / (E - Ep))


@dataclass(frozen=True)
class JohnsonCook(Strength):
    """Flow stress of a metal by plastic strain, its rate and the temperature, which plastic work raises.

    T* = (T - T0)/(Tm - T0), held between 0 and 1; dT = χ q dεp/(ρ Cv).
    """

    id = StrengthId.JOHNSON_COOK
    title = "Johnson-Cook"
    equation = "flow stress (A + B εpⁿ)(1 + C ln max(ε̇/ε̇0, 1))(1 - T*ᵐ)"
    reference = "Johnson & Cook 1983"

    G: float = constant("Pa", "shear modulus")
    A: float = constant("Pa", "flow stress at εp = 0")
    B: float = constant("Pa", "hardening coefficient", "zero or positive")
    n: float = constant("1", "hardening exponent")
    C: float = constant("1", "rate coefficient", "zero or positive")
    m: float = constant("1", "exponent of thermal softening")
    T0: float = constant("K", "initial and reference temperature", "zero or positive")
    Tm: float = constant("K", "melting temperature")
    Cv: float = constant("J/kg/K", "specific heat capacity")
    rate0: float = constant("1/s", "reference plastic strain rate ε̇0", default=1.0)
    chi: float = constant("1", "share χ of the plastic work that heats (Taylor-Quinney)", "0 to 1", 0.9)

    def __post_init__(self):
        """Check every constant, and T0 < Tm.

        Raises:
            InputError: Naming the constant, its value and what is allowed.
        """
        super().__post_init__()
        if self.T0 >= self.Tm:
            raise values.clash(
                f"JohnsonCook: Tm = {self.Tm:g}", f"T0 = {self.T0:g}", "a melting point above T0"
            )


@dataclass(frozen=True)
class JohnsonHolmquist1(Strength):
    """A ceramic: strength grows with pressure until it has failed, then only friction is left. Brings its damage law.

    Intact: 0 at P = T, lines to (P1, s1) and (P2, s2), constant beyond. Failed (D = 1): min(cf P, sf_max) for P > 0,
    else 0. Both times 1 + C ln max(ε̇/ε̇0, 1). Damage: D grows by dεp/ε_f, with ε_f a line from 0 at P = T to eps_f_max
    at P_max, constant beyond; P <= T gives D = 1 at once. D < 1 changes nothing; a failed particle bears no tension.
    """

    id = StrengthId.JOHNSON_HOLMQUIST_1
    title = "Johnson-Holmquist 1"
    equation = (
        "flow stress on the lines (T, 0), (P1, s1), (P2, s2), failed min(cf P, sf_max), times 1 + C ln max(ε̇/ε̇0, 1); "
        "damage dεp/ε_f, ε_f on the line (T, 0), (P_max, eps_f_max)"
    )
    reference = "Johnson & Holmquist 1991"

    G: float = constant("Pa", "shear modulus")
    T: float = constant("Pa", "pressure of failure in tension", "negative", row="P_T")
    P1: float = constant("Pa", "pressure of the first point", "any finite number")
    s1: float = constant("Pa", "intact strength at P1")
    P2: float = constant("Pa", "pressure of the second point", "any finite number")
    s2: float = constant("Pa", "intact strength at P2 and beyond")
    cf: float = constant("1", "failed strength over pressure", "zero or positive")
    sf_max: float = constant("Pa", "highest failed strength", "zero or positive")
    eps_f_max: float = constant("1", "strain to failure at P_max and beyond")
    P_max: float = constant("Pa", "pressure of eps_f_max")
    C: float = constant("1", "rate coefficient", "zero or positive", 0.0)
    rate0: float = constant("1/s", "reference plastic strain rate ε̇0", default=1.0)

    def __post_init__(self):
        """Check every constant, and that the points are in order: T < P1 < P2, s1 <= s2.

        Raises:
            InputError: Naming the constants, their values and what is allowed.
        """
        super().__post_init__()
        for low, high, ok in (
            ("T", "P1", self.T < self.P1),
            ("P1", "P2", self.P1 < self.P2),
            ("s1", "s2", self.s1 <= self.s2),
        ):
            if not ok:
                one, other = f"{high} = {getattr(self, high):g}", f"{low} = {getattr(self, low):g}"
                raise values.clash(f"JohnsonHolmquist1: {one}", other, "T < P1 < P2 and s1 <= s2")


def moduli(E: float, nu: float) -> tuple[float, float]:
    """Bulk and shear modulus (K, G) [Pa] from Young's modulus ``E`` [Pa] and Poisson's ratio ``nu``.

    Raises:
        InputError: If E is not positive or nu not between -1 and 0.5.
    """
    E = number("moduli", "E", E, "positive")
    nu = number("moduli", "nu", nu, "any finite number")
    if not -1.0 < nu < 0.5:
        raise values.outside("moduli: nu", nu, "more than -1 and less than 0.5")
    return E / (3.0 * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))
