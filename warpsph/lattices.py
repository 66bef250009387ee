"""Lattices: how a shape is filled with particles.

Every particle of a lattice stands for one cell of it, so a body's mass is density times cell volume times number
of particles; it nears density times the shape's volume as the spacing shrinks. Points within a millionth of the
spacing of a shape's surface count as on it, so that round-off never decides.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np

from . import checks
from .checks import vector3
from .memory import available
from .messages import bodies, machine, values
from .shapes import Shape

ROUND_OFF = 1e-6
"""Distance from a surface, in spacings, within which a point counts as on it."""

MOST_POINTS = 2**31 - 1
"""Particle numbers are 32-bit integers."""

PER_POINT = 100
"""Bytes that finding the points of a lattice in a shape takes for each in its bounding box, about."""

PER_PARTICLE = 250
"""Bytes that a body takes for each particle until the scene is finished, about."""


class Lattice(ABC):
    """A pattern of particles.

    Attributes:
        dims: Space dimensions it exists in.
    """

    dims: tuple[int, ...]

    def fill(self, shape: Shape, spacing: float, dim: int, what: str = "a lattice") -> np.ndarray:
        """Give the lattice points inside a shape [m], shape [n, 3]; the unused coordinates are zero.

        Args:
            shape: What to fill.
            spacing: Distance between nearest points [m].
            dim: Space dimension of the problem.
            what: What is filled, for messages.

        Raises:
            InputError: If shape or lattice do not fit the dimension, the shape is unbounded, or there are more points
                than memory has room for: known, and refused, before they are made.
        """
        checks.positive("spacing", spacing)
        if shape.dim != dim:
            raise values.clash(str(shape), f"a problem in {dim}D", f"shapes in {dim}D, not in {shape.dim}D")
        if dim not in self.dims:
            allowed = ", ".join(name for name, other in LATTICES.items() if dim in other.dims)
            raise values.clash(f"lattice {self}", f"a problem in {dim}D", allowed)
        bounds = shape.bounds()
        if not np.isfinite(bounds[:, :dim]).all():
            raise bodies.unbounded(shape)
        self._check_room(bounds, spacing, dim, what)
        points = self.points(bounds, spacing, dim)
        inside = shape.contains(points, ROUND_OFF * spacing)
        kept = int(np.count_nonzero(inside))
        free = available.on_host()
        if free is not None and PER_PARTICLE * kept > free:
            fits = coarse(spacing * (PER_PARTICLE * kept / max(free, 1)) ** (1.0 / dim))
            allowed = f"a spacing of {fits:g} m or more"
            raise machine.too_fine(spacing, what, kept, PER_PARTICLE * kept, free, allowed)
        return points if kept == len(points) else points[inside]

    def count(self, bounds: np.ndarray, spacing: float, dim: int) -> float:
        """About how many points cover a bounding box [m], shape [2, 3]; infinite where there is no number for them."""
        lengths = np.ptp(self.covered(bounds), axis=0)[:dim].tolist()
        return math.prod(max(length / spacing, 1.0) for length in lengths) / self.cell_volume(1.0, dim)

    def covered(self, bounds: np.ndarray) -> np.ndarray:
        """The box [m], shape [2, 3], that the points for a bounding box fill: itself unless a lattice says otherwise."""
        return bounds

    def _check_room(self, bounds: np.ndarray, spacing: float, dim: int, what: str) -> None:
        """Refuse more points than there is memory for, or than can be numbered."""
        free, points = available.on_host(), self.count(bounds, spacing, dim)
        most = MOST_POINTS if free is None else min(max(free // PER_POINT, 1), MOST_POINTS)
        if points <= most:
            return
        fits = float(np.ptp(self.covered(bounds), axis=0).max())
        while self.count(bounds, 0.98 * fits, dim) <= most:
            fits *= 0.98
        allowed = f"a spacing of {coarse(fits):g} m or more"
        raise machine.too_fine(spacing, what, points, PER_POINT * points, free, allowed)

    @abstractmethod
    def points(self, bounds: np.ndarray, spacing: float, dim: int) -> np.ndarray:
        """Give the lattice points that cover a bounding box [m], shape [2, 3], as shape [n, 3]."""

    def cell_volume(self, spacing: float, dim: int) -> float:
        """Volume of the cell of one particle [m^dim]: ``spacing**dim`` unless a lattice says otherwise."""
        return spacing**dim


@dataclass(frozen=True)
class Cartesian(Lattice):
    """A square or cubic lattice along the axes of coordinates; the cell is spacing^dim.

    Attributes:
        at: Where the points are. ``"cells"``: centres of the cells that tile the bounding box, round(L / spacing)
            along a length L (the faces of a box are half a spacing outside its particles). ``"edges"``: the first and
            last points lie on the bounding box, floor(L / spacing) + 1 along L. A length that is not a whole number of
            spacings leaves the same margin at both ends. ``"integers"`` and ``"halves"``: origin + k spacing and
            origin + (k + 1/2) spacing, wherever the shape is.
        origin: Origin of ``"integers"`` and ``"halves"`` [m], up to three components.
    """

    at: Literal["cells", "edges", "integers", "halves"] = "cells"
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    dims = (1, 2, 3)

    def __post_init__(self):
        _check_choice("Cartesian", self.at, ("cells", "edges", "integers", "halves"))
        object.__setattr__(self, "origin", checks.vector("origin of Cartesian", self.origin, 1, 2, 3))

    def points(self, bounds, spacing, dim):
        """See `Lattice.points`."""
        origin = vector3(self.origin) + (0.5 * spacing if self.at == "halves" else 0.0)
        axes = []
        for low, high, start in zip(bounds[0, :dim], bounds[1, :dim], origin, strict=False):
            if self.at in ("cells", "edges"):
                axes.append(_centred(low, high, spacing, self.at))
            else:
                first = np.ceil((low - start) / spacing - ROUND_OFF)
                axes.append(
                    (start, first, np.floor((high - start) / spacing + ROUND_OFF) - first + 1, spacing)
                )
        return _grid(axes).reshape(-1, 3)


@dataclass(frozen=True)
class Hexagonal(Lattice):
    """Rows of the plane (2D), each shifted by half a spacing: six nearest points at the spacing.

    Rows run along x and are spacing sqrt(3)/2 apart; the pattern is centred in the bounding box. The cell is
    spacing^2 sqrt(3)/2.
    """

    dims = (2,)

    def points(self, bounds, spacing, dim):
        """See `Lattice.points`."""
        return _checkerboard(bounds, (0.5 * spacing, np.sqrt(0.75) * spacing))

    def cell_volume(self, spacing, dim):
        """Volume of the cell of one particle [m^dim]."""
        return np.sqrt(0.75) * spacing**2


@dataclass(frozen=True)
class FaceCentredCubic(Lattice):
    """Cubic close packing (3D): twelve nearest points at the spacing, the cube's edge is spacing sqrt(2).

    The pattern is centred in the bounding box. The cell is spacing^3 / sqrt(2).
    """

    dims = (3,)

    def points(self, bounds, spacing, dim):
        """See `Lattice.points`."""
        return _checkerboard(bounds, (np.sqrt(0.5) * spacing,) * 3)

    def cell_volume(self, spacing, dim):
        """Volume of the cell of one particle [m^dim]."""
        return np.sqrt(0.5) * spacing**3


@dataclass(frozen=True)
class Rings(Lattice):
    """Concentric rings, a spacing apart, of round(2 pi r / spacing) particles each (2D).

    Rings are counted from the outside inwards, down to one particle at the centre where a ring gets that small.
    Each ring starts on the ray from the centre along +x, so that the set is symmetric about that axis. The cell is
    spacing^2 for every particle.

    Attributes:
        at: ``"cells"``: the outermost ring lies half a spacing inside the outer radius. ``"edges"``: on it.
        center: Centre [m], two components; default the centre of the shape's bounding box (give it where the shape
            is only a part of a disc). The outer radius is the largest distance from it to a side of the box.
    """

    at: Literal["cells", "edges"] = "cells"
    center: tuple[float, ...] | None = None
    dims = (2,)

    def __post_init__(self):
        _check_choice("Rings", self.at, ("cells", "edges"))
        _check_center("Rings", self)

    def covered(self, bounds):
        """See `Lattice.covered`."""
        return _square(bounds, self.center)

    def points(self, bounds, spacing, dim):
        """See `Lattice.points`."""
        center, radius = _center_and_radius(bounds, self.center)
        outermost = radius / spacing - (0.5 if self.at == "cells" else 0.0)
        in_spacings = outermost - np.arange(np.floor(outermost + ROUND_OFF) + 1)
        rings = [_ring(r * spacing, round(2.0 * np.pi * r)) for r in in_spacings]
        return center + np.concatenate(rings or [np.empty((0, 3))])


@dataclass(frozen=True)
class CoreAndRings(Lattice):
    """Two rings along a disc's edge around a Cartesian core (2D): a smooth surface without a pole.

    For a disc of radius R: a ring at r = R of round(2 pi r / spacing) particles, one at r = R - spacing of
    floor(2 pi r / spacing), and the points of the square lattice center + k spacing with r < R - 2 spacing.
    The cell is spacing^2 for every particle.

    Attributes:
        center: Centre [m], two components; default the centre of the shape's bounding box (give it where the shape
            is only a part of a disc). The radius is the largest distance from it to a side of the box.
    """

    center: tuple[float, ...] | None = None
    dims = (2,)

    def __post_init__(self):
        _check_center("CoreAndRings", self)

    def covered(self, bounds):
        """See `Lattice.covered`."""
        return _square(bounds, self.center)

    def points(self, bounds, spacing, dim):
        """See `Lattice.points`."""
        center, radius = _center_and_radius(bounds, self.center)
        outer = radius / spacing
        square = _square(bounds, self.center)
        core = Cartesian("integers", tuple(center)).points(square, spacing, dim)
        core = core[np.linalg.norm(core - center, axis=1) < (outer - 2.0 - ROUND_OFF) * spacing]
        rings = [_ring(radius, round(2.0 * np.pi * outer))]
        if outer > 1.0:
            rings.append(_ring(radius - spacing, int(2.0 * np.pi * (outer - 1.0) + ROUND_OFF)))
        return np.concatenate([center + ring for ring in rings] + [core])


def coarse(spacing: float) -> float:
    """A spacing [m] rounded up to two digits."""
    return float(f"{1.05 * spacing:.1e}")


def _check_choice(kind: str, at: str, allowed: tuple[str, ...]) -> None:
    if at not in allowed:
        raise checks.refuse(f"at of {kind}", at, ", ".join(allowed))


def _check_center(kind: str, lattice: Rings | CoreAndRings) -> None:
    if lattice.center is not None:
        object.__setattr__(lattice, "center", checks.vector(f"center of {kind}", lattice.center, 2))


def _centred(low: float, high: float, pitch: float, at: str) -> tuple[float, float, float, float]:
    """Points centred between two ends, as origin, first index, number of points and pitch."""
    lengths = (high - low) / pitch + ROUND_OFF
    count = np.floor(lengths + 0.5) if at == "cells" else np.floor(lengths) + 1
    return 0.5 * (low + high), -0.5 * (count - 1), count, pitch


def _grid(axes: list[tuple[float, float, float, float]]) -> np.ndarray:
    """Points of a rectangular grid [m]: an axis of the array for each of the grid's, and one for the coordinates.

    Args:
        axes: Origin, first index, number of points and pitch along every axis; no points if a number is not positive.
    """
    counts = [max(count, 0) for _, _, count, _ in axes]
    index = np.ogrid[tuple(slice(int(count)) for count in counts)]
    points = np.zeros((*map(int, counts), 3))
    for axis, (origin, first, _, pitch) in enumerate(axes):
        points[..., axis] = origin + (first + index[axis]) * pitch
    return points


def _checkerboard(bounds: np.ndarray, pitches: tuple[float, ...]) -> np.ndarray:
    """Every second point, like the black squares, of the grid of cell centres of a box, shape [n, 3]."""
    axes = [_centred(bounds[0, k], bounds[1, k], pitch, "cells") for k, pitch in enumerate(pitches)]
    points = _grid(axes)
    return points[sum(np.ogrid[tuple(map(slice, points.shape[:-1]))]) % 2 == 0]


def _center_and_radius(bounds: np.ndarray, center: tuple[float, ...] | None) -> tuple[np.ndarray, float]:
    """Centre of rings [m], shape [3], and the outer radius [m]."""
    middle = vector3(tuple(bounds.mean(axis=0)[:2]) if center is None else center)
    return middle, float(np.abs(bounds - middle)[:, :2].max())


def _square(bounds: np.ndarray, center: tuple[float, ...] | None) -> np.ndarray:
    """Box around rings [m], shape [2, 3]."""
    middle, radius = _center_and_radius(bounds, center)
    return np.array((middle - radius, middle + radius))


def _ring(radius: float, count: int) -> np.ndarray:
    """Points on a circle about the origin, the first on +x, shape [n, 3]; one or none give the centre."""
    if count <= 1:
        return np.zeros((1, 3))
    angle = 2.0 * np.pi / count * np.arange(count)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)), axis=1)


LATTICES: dict[str, Lattice] = {
    "cartesian": Cartesian(),
    "hexagonal": Hexagonal(),
    "face-centred-cubic": FaceCentredCubic(),
    "rings": Rings(),
    "core-and-rings": CoreAndRings(),
}
"""Lattices by name, each with its defaults."""


def get(lattice: str | Lattice) -> Lattice:
    """Give a lattice by name; a lattice is handed through.

    Raises:
        InputError: If there is none of that name; names the ones there are.
    """
    if isinstance(lattice, Lattice):
        return lattice
    if isinstance(lattice, str) and lattice in LATTICES:
        return LATTICES[lattice]
    raise values.unknown("lattice", lattice, LATTICES, "or a Lattice")
