"""What a file says about itself: each fact by its name, of the type that its reader counts on.

A rule takes a value from JSON, gives it back as its reader wants it, and raises `TypeError` with what is allowed.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

Rule = Callable[[Any], Any]


def check(facts: Mapping[str, Any], rules: Mapping[str, Rule]) -> dict[str, Any]:
    """Give the facts that there are rules for, each in its type; others are left out.

    Raises:
        ValueError: If one is missing or against its rule; names it.
    """
    missing = [name for name in rules if name not in facts]
    if missing:
        raise ValueError(f"{', '.join(missing)} is missing")
    checked = {}
    for name, rule in rules.items():
        try:
            checked[name] = rule(facts[name])
        except TypeError as error:
            raise ValueError(f"{name} is not {error}") from None
    return checked


def finite(value: Any) -> float:
    """A finite number."""
    return float(_must(type(value) in (int, float) and _is_finite(value), value, "a finite number"))


def not_negative(value: Any) -> float:
    """A finite number from 0 up."""
    fits = type(value) in (int, float) and _is_finite(value) and value >= 0.0
    return float(_must(fits, value, "a number that is not negative"))


def positive(value: Any) -> float:
    """A positive, finite number."""
    fits = type(value) in (int, float) and _is_finite(value) and value > 0.0
    return float(_must(fits, value, "a positive number"))


def natural(value: Any) -> int:
    """A whole number from 0 to 2^63 - 1."""
    return _must(type(value) is int and 0 <= value < 2**63, value, "a whole number")


def truth(value: Any) -> bool:
    """True or false."""
    return _must(type(value) is bool, value, "true or false")


def text(value: Any) -> str:
    """A text of printable characters, which may be empty."""
    return _must(isinstance(value, str) and value.isprintable(), value, "a printable text")


def texts(value: Any) -> list[str]:
    """A list of texts."""
    return [text(item) for item in _must(isinstance(value, list), value, "a list of texts")]


def numbers(value: Any) -> list[float]:
    """A list of finite numbers."""
    return [finite(item) for item in _must(isinstance(value, list), value, "a list of numbers")]


def peaks(value: Any) -> dict[str, float]:
    """Numbers by name; a measure may have given any."""
    fits = isinstance(value, dict) and all(type(number) in (int, float) for number in value.values())
    return _must(fits, value, "a record of numbers")


def record(value: Any) -> dict[str, Any]:
    """Facts by name."""
    return _must(isinstance(value, dict), value, "a record")


def one_of(*choices: int) -> Rule:
    """One of some whole numbers."""
    words = ", ".join(map(str, choices))
    return lambda value: _must(type(value) is int and value in choices, value, f"one of {words}")


def _is_finite(value: int | float) -> bool:
    """Whether a number is one that float64 can hold; the whole numbers of JSON have no end."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def _must(fits: bool, value: Any, allowed: str) -> Any:
    if not fits:
        raise TypeError(allowed)
    return value
