"""Materials: a density, an equation of state, a strength and a damage law, with a library of the ones the papers use.

Every law is a frozen dataclass whose constants carry the literature's letters, in SI units. A missing,
negative or inconsistent constant is an `InputError` when the law is made.
"""

from .damage import Damage, JohnsonCookDamage
from .eos import (
    CubicGrueneisen,
    Eos,
    IdealGas,
    IsothermalMieGrueneisen,
    LinearElastic,
    Polynomial,
    ShockMieGrueneisen,
    StiffenedGas,
)
from .law import Law
from .library import get, names
from .material import ROOM_TEMPERATURE, Material, pack
from .strength import (
    Elastic,
    Fluid,
    JohnsonCook,
    JohnsonHolmquist1,
    LinearHardening,
    PerfectlyPlastic,
    Strength,
    moduli,
)

__all__ = [
    "ROOM_TEMPERATURE", "CubicGrueneisen", "Damage", "Elastic", "Eos", "Fluid", "IdealGas", "IsothermalMieGrueneisen",
    "JohnsonCook", "JohnsonCookDamage", "JohnsonHolmquist1", "Law", "LinearElastic", "LinearHardening", "Material",
    "PerfectlyPlastic", "Polynomial", "ShockMieGrueneisen", "StiffenedGas", "Strength", "get", "moduli", "names", "pack",
]  # fmt: skip
