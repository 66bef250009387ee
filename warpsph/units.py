"""Numbers for people: units with SI prefixes and real superscripts."""

import math

PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
"""SI prefixes by power of ten."""

PREFIXABLE = ("Pa", "m", "m/s", "s", "J", "J/m", "J/m^2", "J/kg", "N", "N s", "Hz")
"""Units that read well with a prefix."""

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits as superscripts."""


def scale(unit: str, largest: float) -> tuple[float, str]:
    """Find the unit in which a quantity reads well.

    Args:
        unit: SI unit, ``"1"`` if dimensionless.
        largest: Largest magnitude to be shown [unit].

    Returns:
        What to multiply values with, and the unit to print; ``(1e-9, "GPa")`` for 2e10 Pa.
    """
    power = 3 * math.floor(math.log10(largest) / 3 + 1e-9) if 0.0 < largest < math.inf else 0
    if unit in PREFIXABLE:
        power = min(max(power, -9), 12)
        return 10.0**-power, PREFIXES[power] + pretty(unit)
    if -3 <= power <= 3:
        return 1.0, pretty(unit)
    return 10.0**-power, f"10{str(power).translate(SUPERSCRIPTS)} {pretty(unit)}".strip()


def pretty(unit: str) -> str:
    """Print form of a unit: ``kg/m³`` for ``kg/m^3``, nothing for ``1``."""
    if unit == "1":
        return ""
    head, *tails = unit.split("^")
    return head + "".join(tail[:1].translate(SUPERSCRIPTS) + tail[1:] for tail in tails)


def label(name: str, unit: str) -> str:
    """Title of an axis: ``pressure [GPa]``."""
    return f"{name} [{unit}]" if unit else name


def si(value: float, unit: str) -> str:
    """Write a quantity with an SI prefix: ``si(3.2e-6, "s")`` is ``"3.2 µs"``."""
    factor, prefixed = scale(unit, abs(value))
    return f"{value * factor:.4g} {prefixed}"
