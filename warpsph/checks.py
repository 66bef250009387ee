"""Checks of single values from a user: each gives the clean value or one clear line."""

import numbers

import numpy as np

from .messages.values import refuse


def number(name: str, value: object) -> float:
    """Give a finite number as a float.

    Raises:
        InputError: If it is something else.
    """
    if isinstance(value, numbers.Real) and not isinstance(value, bool) and np.isfinite(value):
        return float(value)
    raise refuse(name, value, "a finite number")


def positive(name: str, value: object) -> float:
    """Give a finite number above zero as a float.

    Raises:
        InputError: If it is something else.
    """
    if isinstance(value, numbers.Real) and not isinstance(value, bool) and 0.0 < value < np.inf:
        return float(value)
    raise refuse(name, value, "a positive number")


def is_name(value: object) -> bool:
    """Whether a value can name something in files and messages: a text of printable characters, and not an empty one."""
    return isinstance(value, str) and value != "" and value.isprintable()


def vector(name: str, value: object, *sizes: int) -> tuple[float, ...]:
    """Give a vector as a tuple of floats; ``sizes`` are the allowed numbers of components.

    Raises:
        InputError: If it is something else.
    """
    allowed = f"{' or '.join(map(str, sizes))} finite numbers"
    try:
        array = np.atleast_1d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError):
        raise refuse(name, value, allowed) from None
    if array.ndim != 1 or len(array) not in sizes or not np.isfinite(array).all():
        raise refuse(name, value, allowed)
    return tuple(array.tolist())


def vector3(value: tuple[float, ...]) -> np.ndarray:
    """Give a vector of up to three components as three, zeros added, shape [3]."""
    padded = np.zeros(3)
    padded[: len(value)] = value
    return padded
