"""Bodies that cannot be: which body, where, how far off, what is allowed."""

import numpy as np

from warpsph.errors import InputError


def place(point: np.ndarray) -> str:
    """A point [m], shape [dim], as it is shown."""
    return f"({', '.join(f'{c:.6g}' for c in point)}) m"


def apart(name: str, distance: float, spacing: float, within: float) -> InputError:
    """The points that are given for a body are not a spacing apart [m]."""
    return InputError(
        f"points of body {name!r} are {distance:.4g} m apart on average; allowed: "
        f"the scene's spacing of {spacing:g} m within {within:.0%}, for all bodies share it"
    )


def none(scene: str) -> InputError:
    """A scene without bodies."""
    return InputError(f"scene {scene!r} has no bodies; allowed: at least one, by add_body")


def empty(name: str, shape: object, spacing: float) -> InputError:
    """A shape so small that no lattice point lies in it."""
    return InputError(
        f"body {name!r} has no particles: no lattice point lies in {shape}; allowed: a shape that "
        f"holds at least one at a spacing of {spacing:g} m"
    )


def unbounded(shape: object) -> InputError:
    """A shape that has no end."""
    return InputError(f"{shape} is unbounded; allowed: a half-space only to cut a finite shape")


def nobody_meant(act: str, name: str, count: int) -> InputError:
    """A selection of particles that selects none."""
    return InputError(f"{act} of body {name!r} selects none of its {count} particles; allowed: at least one")


def no_mask(act: str, name: str, mask: np.ndarray, count: int) -> InputError:
    """A selection of particles that is no mask of them."""
    return InputError(
        f"{act} of body {name!r}: where gives {mask.dtype} of shape {mask.shape}; allowed: bool, ({count},)"
    )


def overlap(one: str, other: str, pairs: int, point: np.ndarray, distance: float) -> InputError:
    """Two bodies are closer than ``distance`` [m], for example at ``point`` [m]."""
    return InputError(
        f"bodies {one!r} and {other!r} overlap near {place(point)}: {pairs} particle pairs are too close; "
        f"allowed: half a spacing, {distance:g} m, or more"
    )


def coincide(name: str, pairs: int, point: np.ndarray, spacings: float) -> InputError:
    """Particles of a body are at the same place, for example at ``point`` [m]."""
    return InputError(
        f"body {name!r} has {pairs} particle pairs at the same place, one at {place(point)}; "
        f"allowed: {spacings:g} spacings apart or more"
    )


def beyond_plane(name: str, point: np.ndarray, axis: str, position: float) -> InputError:
    """A particle at ``point`` [m] lies beyond a symmetry plane, or on it."""
    return InputError(
        f"body {name!r} has a particle at {place(point)}, beyond or on the symmetry plane "
        f"{axis} = {position:g} m; allowed: all on one side, a quarter of a spacing or more away"
    )
