"""What every law of a material is: named constants in SI units, checked when the law is made."""

import math
import numbers
from dataclasses import Field, dataclass, field, fields
from typing import Any, ClassVar

from warpsph.kernels.material import DamageId, EosId, StrengthId
from warpsph.messages import values

_ALLOWED = {
    "positive": lambda value: value > 0.0,
    "zero or positive": lambda value: value >= 0.0,
    "more than 1": lambda value: value > 1.0,
    "1 or more": lambda value: value >= 1.0,
    "0 to 1": lambda value: 0.0 <= value <= 1.0,
    "negative": lambda value: value < 0.0,
    "zero or negative": lambda value: value <= 0.0,
    "any finite number": lambda value: True,
}


def constant(
    unit: str, meaning: str, allowed: str = "positive", default: float | None = None, row: str | None = None
) -> Any:
    """Declare a constant of a law.

    Args:
        unit: SI unit, ``"1"`` if dimensionless.
        meaning: What it is, for people.
        allowed: A key of the table above.
        default: Value if not given; without one it must be.
        row: Name in the device's table, if not the constant's own.
    """
    metadata = {"unit": unit, "meaning": meaning, "allowed": allowed, "row": row}
    return field(default=default, metadata=metadata)


def number(owner: str, name: str, value: object, allowed: str) -> float:
    """Check one number.

    Raises:
        InputError: Naming the constant, its value and what is allowed.
    """
    if value is None:
        raise values.missing(f"{owner}: {name}", allowed)
    ok = isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)
    if not ok or not _ALLOWED[allowed](value):
        raise values.outside(f"{owner}: {name}", value, allowed)
    return float(value)


@dataclass(frozen=True)
class Law:
    """A law with constants: an equation of state, a strength or a damage law.

    Attributes:
        id: Number of the law on the device.
        title: Name for people.
        equation: The law in one line.
        reference: Where it comes from.
    """

    id: ClassVar[EosId | StrengthId | DamageId]
    title: ClassVar[str]
    equation: ClassVar[str]
    reference: ClassVar[str]

    def __post_init__(self):
        """Check every constant and store it as a float.

        Raises:
            InputError: Naming the constant, its value and what is allowed.
        """
        for f in _constants(self):
            value = number(type(self).__name__, f.name, getattr(self, f.name), f.metadata["allowed"])
            object.__setattr__(self, f.name, value)

    @property
    def constants(self) -> dict[str, float]:
        """The constants by their letters, SI units."""
        return {f.name: getattr(self, f.name) for f in _constants(self)}

    @property
    def row(self) -> dict[str, float]:
        """The constants by their names in the device's table, where another quantity may have the letter."""
        return {f.metadata["row"] or f.name: getattr(self, f.name) for f in _constants(self)}

    def describe(self) -> str:
        """Give the law, its equation and a line for each constant."""
        lines = [f"{self.title}: {self.equation}  ({self.reference})"]
        for f in _constants(self):
            lines.append(
                f"  {f.name:<9} {getattr(self, f.name):<12.6g} {f.metadata['unit']:<7} {f.metadata['meaning']}"
            )
        return "\n".join(lines)


def _constants(law: Law) -> list[Field]:
    """The fields of a law that are constants."""
    return [f for f in fields(law) if "unit" in f.metadata]
