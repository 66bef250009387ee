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


def thin_fluid(material: str) -> InputError:
    """A fluid in plane stress: without strength, and without stress across, it can have no pressure."""
    return InputError(
        f"material {material!r} does not go with plane = 'stress': it has no strength, so that nothing but its pressure "
        "could act across, and that must be none; allowed: plane = 'strain', or a solid"
    )


def beyond_law(body: str, material: str, density: float, energy: float) -> InputError:
    """A body starts in a state [kg/m^3, J/kg] that the equation of state of its material does not reach."""
    return InputError(
        f"body {body!r} starts beyond the equation of state of material {material!r}, at a density of {density:g} kg/m^3 and "
        f"an internal energy of {energy:g} J/kg; allowed: states that have a pressure and a sound speed, "
        "and in plane stress a thickness without stress"
    )


def shown(value: object) -> str:
    """A value as it is shown: as Python writes it, cut where it is long."""
    text = repr(value.tolist() if isinstance(value, np.ndarray | np.generic) else value)
    return text if len(text) < LONGEST else text[: LONGEST - 4] + " ..."
