"""Damage laws: how much plastic strain a material bears before it fails."""

from dataclasses import dataclass
from typing import Literal

from warpsph.kernels.material import DamageId
from warpsph.messages import values

from .law import Law, constant


class Damage(Law):
    """A damage law: D grows by dεp/ε_f up to 1, where the material has failed."""


@dataclass(frozen=True)
class JohnsonCookDamage(Damage):
    """Strain to failure by triaxiality σ* = -p/q (tension positive), plastic strain rate and temperature.

    ε̇0 and T* are those of the Johnson-Cook strength that the material must have. ε_f never falls below 1e-6.

    Attributes:
        carries: What a failed particle, D = 1, still carries: ``"all"``, or ``"compression"``: neither shear nor tension.
    """

    id = DamageId.JOHNSON_COOK
    title = "Johnson-Cook"
    equation = "ε_f = (D1 + D2 exp(D3 σ*))(1 + D4 ln max(ε̇/ε̇0, 1))(1 + D5 T*)"
    reference = "Johnson & Cook 1985"

    D1: float = constant("1", "strain to failure, constant part", "any finite number")
    D2: float = constant("1", "strain to failure, part that depends on σ*", "zero or positive", 0.0)
    D3: float = constant("1", "exponent of σ*, negative where tension embrittles", "any finite number", 0.0)
    D4: float = constant("1", "rate coefficient", "any finite number", 0.0)
    D5: float = constant("1", "coefficient of T*", "any finite number", 0.0)
    carries: Literal["all", "compression"] = "all"

    def __post_init__(self):
        """Check every constant, and that pure shear bears some strain.

        Raises:
            InputError: Naming the constant, its value and what is allowed.
        """
        super().__post_init__()
        if self.carries not in ("all", "compression"):
            raise values.refuse("JohnsonCookDamage: carries", self.carries, "all, compression")
        if self.D1 + self.D2 <= 0.0:
            raise values.clash(f"JohnsonCookDamage: D1 = {self.D1:g}", f"D2 = {self.D2:g}", "D1 + D2 above 0")
