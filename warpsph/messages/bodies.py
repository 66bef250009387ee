"""Bodies that cannot be: which body, where, how far off, what is allowed."""

import numpy as np

from warpsph.errors import InputError


def place(point: np.ndarray) -> str:
    """A point [m], shape [3], as it is shown."""
    return f"({', '.join(f'{c:.4g}' for c in point)}) m"


def apart(name: str, distance: float, spacing: float, within: float) -> InputError:
    """The points that are given for a body are not a spacing apart [m]."""
    return InputError(
        f"points of body {name!r} are {distance:.4g} m apart on average; allowed: "
        f"the scene's spacing of {spacing:g} m within {within:.0%}, for all bodies share it"
    )
