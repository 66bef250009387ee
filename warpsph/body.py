"""A body of a scene: its particles with everything they start with."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import checks
from .checks import vector3
from .materials import Material
from .messages import bodies, values
from .overlap import mean_spacing

Velocity = tuple[float, ...] | np.ndarray | Callable[[np.ndarray], np.ndarray]
"""A vector, one vector per particle, or a function of the positions, shape [n, 3], that gives them."""

SPACING_DEVIATION = 0.3
"""Largest deviation of the particle distance in given points from the scene's spacing, relative."""


@dataclass(eq=False, repr=False)
class Body:
    """Particles of one material under one name, made by `warpsph.scene.Scene.add_body`.

    Attributes:
        name: Name.
        materials: Its materials, the first that of all particles unless some were given another.
        mat: Index into ``materials``, shape [n].
        x: Positions [m], shape [n, 3].
        v: Velocities [m/s], shape [n, 3].
        volume: Volume of each particle [m^dim], shape [n].
        density: Initial density [kg/m^3], shape [n].
        internal_energy: Initial specific internal energy [J/kg].
        fixed: Bits 1, 2, 4 where velocity component x, y, z is prescribed, shape [n].
        eulerian: Where an adaptive scheme starts with Eulerian particles, shape [n], bool.
    """

    name: str
    materials: list[Material]
    mat: np.ndarray
    x: np.ndarray
    v: np.ndarray
    volume: np.ndarray
    density: np.ndarray
    internal_energy: float
    fixed: np.ndarray
    eulerian: np.ndarray

    @property
    def mass(self) -> float:
        """Mass of the body [kg], per metre of thickness in 2D and per square metre in 1D."""
        return float(self.density @ self.volume)

    def __len__(self) -> int:
        return len(self.x)

    def __repr__(self) -> str:
        return f"Body({self.name!r}, {self.materials[0].name}, {len(self)} particles, {self.mass:.6g} kg)"


def given_points(name: str, points: object, spacing: float, dim: int) -> np.ndarray:
    """Check points that a user gives and fill them up to three coordinates.

    Args:
        name: Name of the body, for messages.
        points: Positions [m], shape [n, dim] or [n, 3].
        spacing: The scene's spacing [m].
        dim: Space dimension.

    Returns:
        Positions [m], shape [n, 3].

    Raises:
        InputError: If the shape is wrong, points are not finite, lie off the problem's line or plane, or are not a
            spacing apart.
    """
    what = f"points of body {name!r}"
    array = _numbers(what, points)
    x = _in_space(what, array.reshape(-1, 1) if dim == 1 and array.ndim == 1 else array, dim)
    distance = mean_spacing(x) if len(x) > 1 else spacing
    if abs(distance - spacing) > SPACING_DEVIATION * spacing:
        raise bodies.apart(name, distance, spacing, SPACING_DEVIATION)
    return x


def initial_velocity(name: str, velocity: Velocity, x: np.ndarray, dim: int) -> np.ndarray:
    """Give every particle of a body its velocity [m/s], shape [n, 3].

    Raises:
        InputError: If it has the wrong shape, is not finite, or has a component that the problem has not.
    """
    what = f"velocity of body {name!r}"
    array = _numbers(what, velocity(x.copy()) if callable(velocity) else velocity)
    if array.shape == (len(x),) and dim == 1 and callable(velocity):
        array = array[:, None]
    elif array.ndim < 2:
        vector = vector3(checks.vector(what, array, *sorted({dim, 3})))
        return np.broadcast_to(_in_space(what, vector[None], dim), (len(x), 3)).copy()
    if len(array) != len(x):
        raise values.refuse(f"length of {what}", len(array), f"one vector, or one for each of {len(x)}")
    return _in_space(what, array, dim)


def particle_volume(name: str, volume: float | np.ndarray, n: int) -> np.ndarray:
    """Give every particle of a body its volume [m^dim], shape [n].

    Raises:
        InputError: If it is not one positive number or one for every particle.
    """
    try:
        value = np.asarray(volume, dtype=np.float64)
        each = np.broadcast_to(value, n)
    except (TypeError, ValueError):
        value = each = np.zeros(n)
    if not (np.isfinite(value) & (value > 0.0)).all():
        raise checks.refuse(f"volume of body {name!r}", volume, f"a positive number, or {n} of them")
    return each.copy()


def _numbers(what: str, value: object) -> np.ndarray:
    """Give an array of numbers.

    Raises:
        InputError: If it holds anything else.
    """
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise checks.refuse(what, value, "numbers") from None


def _in_space(what: str, array: np.ndarray, dim: int) -> np.ndarray:
    """Fill vectors of the problem's space, shape [n, dim] or [n, 3], up to three components.

    Raises:
        InputError: If the shape is another one, or a vector is not finite or points out of the problem's space.
    """
    if array.ndim != 2 or len(array) == 0 or array.shape[1] not in (dim, 3):
        raise values.refuse(f"shape of {what}", array.shape, f"(n, {dim}) or (n, 3)")
    full = np.zeros((len(array), 3))
    full[:, : array.shape[1]] = array
    if not np.isfinite(full).all() or full[:, dim:].any():
        wrong = np.flatnonzero(~np.isfinite(full).all(axis=1) | full[:, dim:].any(axis=1))
        beyond = f" with zeros beyond the {dim}D problem" if dim < 3 else ""
        raise checks.refuse(f"{what}, number {wrong[0]},", array[wrong[0]], f"finite numbers{beyond}")
    return full
