"""Values from a user that are not allowed: the field, the value, what is allowed."""

import difflib
from collections.abc import Iterable

from warpsph.errors import InputError

CLOSE = 0.7
"""How alike a name must be to be suggested, from 0 to 1."""

LONGEST = 80
"""Characters of a value that are shown."""


def refuse(name: str, value: object, allowed: str) -> InputError:
    """A value is not allowed."""
    return InputError(f"{name} = {shown(value)} is not allowed; allowed: {allowed}")


def outside(name: str, value: object, allowed: str) -> InputError:
    """A number is out of range."""
    return InputError(f"{name} = {shown(value)} is out of range; allowed: {allowed}")


def missing(name: str, allowed: str) -> InputError:
    """A value that must be given is not."""
    return InputError(f"{name} is missing; allowed: {allowed}")


def unknown(kind: str, value: object, allowed: Iterable[str], also: str = "") -> InputError:
    """A name is none of those there are; suggests the closest. ``also``: what is allowed besides the names."""
    names = list(map(str, allowed))
    listed = ", ".join([*names, also] if also else names)
    return InputError(f"{kind} {shown(value)} is unknown{meant(value, names)}; allowed: {listed}")


def clash(one: str, other: str, allowed: str, why: str = "") -> InputError:
    """Two choices, each allowed by itself, do not go together."""
    reason = f": {why}" if why else ""
    return InputError(f"{one} does not go with {other}{reason}; allowed: {allowed}")


def lacks(what: str, need: str, allowed: str) -> InputError:
    """A choice needs something that is not there."""
    return InputError(f"{what} needs {need}; allowed: {allowed}")


def shown(value: object) -> str:
    """A value as it is shown: as Python writes it, cut where it is long."""
    text = repr(value.tolist() if hasattr(value, "tolist") else value)  # numpy's as plain numbers
    return text if len(text) < LONGEST else text[: LONGEST - 4] + " ..."


def meant(value: object, names: Iterable[str]) -> str:
    """A suggestion in brackets if one of the names is close to the value, else nothing."""
    close = difflib.get_close_matches(str(value), list(names), n=1, cutoff=CLOSE)
    return f" (did you mean {close[0]!r}?)" if close else ""


def beyond_precision(
    spacing: float, precision: str, what: str, size: float, limits: tuple[float, float]
) -> InputError:
    """A number that a step works with overflows or vanishes in the run's precision."""
    return InputError(
        f"spacing = {spacing:g} m does not go with precision {precision!r}: {what} is {size:.2g}, beyond "
        f"{limits[0]:.0e} to {limits[1]:.0e}; allowed: precision 'float64', or other units of length, mass and time"
    )


def too_far(far: float, precision: str, rounding: float, coarsest: float) -> InputError:
    """Positions are so far from the origin that they are rounded too much."""
    return InputError(
        f"position = {far:g} m from the origin does not go with precision {precision!r}: it is rounded to {rounding:.2g} "
        f"spacings; allowed: up to {coarsest:g} spacings, with precision 'mixed' or 'float64' or nearer to the origin"
    )
