"""What a file says about itself: each fact by its name, of the type that its reader counts on.

A rule takes a value from JSON, gives it back as its reader wants it, and raises `TypeError` with what is allowed.
"""

import math
from collections.abc import Callable, Collection, Mapping
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


def number(value: Any) -> float:
    """A number, which may be infinite or none: what has become of a state that is not finite."""
    fits = type(value) is float or (type(value) is int and _is_finite(value))
    return float(_must(fits, value, "a number"))


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


def record(value: Any) -> dict[str, Any]:
    """Facts by name."""
    return _must(isinstance(value, dict), value, "a record")


def record_of(rules: Mapping[str, Rule]) -> Rule:
    """Facts that there are rules for; others are left out."""
    return lambda value: check(record(value), rules)


def each(rule: Rule, names: Collection[str] | None = None) -> Rule:
    """Facts by name, all by one rule; None: by any name."""

    def apply(value: Any) -> dict[str, Any]:
        fits = names is None or set(record(value)) <= set(names)
        return {
            name: rule(inner)
            for name, inner in record(_must(fits, value, "a record of names that there are")).items()
        }

    return apply


def many(rule: Rule) -> Rule:
    """A list of facts, all by one rule."""
    return lambda value: [rule(item) for item in _must(isinstance(value, list), value, "a list")]


def optional(rule: Rule) -> Rule:
    """Null, or a fact by a rule."""
    return lambda value: None if value is None else rule(value)


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
