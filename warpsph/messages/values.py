"""Values from a user that are not allowed: the field, the value, what is allowed."""

from collections.abc import Iterable

import numpy as np

from warpsph.errors import InputError

LONGEST = 80
"""Characters of a value that are shown."""


def refuse(name: str, value: object, allowed: str) -> InputError:
    """A value is not allowed: names it, shows it, says what is allowed."""
    return InputError(f"{name} = {shown(value)} is not allowed; allowed: {allowed}")


def unknown(name: str, value: object, allowed: Iterable[object]) -> InputError:
    """A name is none of those that there are."""
    return InputError(f"{name} {shown(value)} is unknown; allowed: {', '.join(map(str, allowed))}")


def shown(value: object) -> str:
    """A value as it is shown: as Python writes it, cut where it is long."""
    text = repr(value.tolist() if isinstance(value, np.ndarray | np.generic) else value)
    return text if len(text) < LONGEST else text[: LONGEST - 4] + " ..."


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
