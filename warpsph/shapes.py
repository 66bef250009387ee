"""Shapes: where a body is. Immutable, moved and combined into new shapes.

``a | b`` is the union, ``a & b`` the intersection, ``a - b`` the difference. Every shape is closed (its surface
belongs to it), except that a difference does not hold the surface of the cut: ``a & b`` and ``a - b`` share no point.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import checks
from .checks import vector3
from .messages import values
from .surfaces import closed_surface, within

if TYPE_CHECKING:
    import pyvista


@dataclass(frozen=True, eq=False)
class Motion:
    """The similarity x -> factor * rotation x + shift.

    Attributes:
        rotation: Rotation matrix, shape [3, 3].
        factor: Scale factor.
        shift: Translation [m], shape [3].
    """

    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    factor: float = 1.0
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def point(self, point: tuple[float, ...]) -> tuple[float, ...]:
        """Move a point [m]; as many components come back as went in."""
        moved = self.factor * self.rotation @ vector3(point) + self.shift
        return tuple(moved[: len(point)].tolist())

    def direction(self, direction: tuple[float, ...]) -> tuple[float, ...]:
        """Turn a direction; as many components come back as went in."""
        return tuple((self.rotation @ vector3(direction))[: len(direction)].tolist())


class Shape(ABC):
    """A region of the line, the plane or space.

    Attributes:
        dim: Space dimension of the problems it can be used in: 1, 2 or 3.
    """

    dim: int

    @abstractmethod
    def contains(self, points: np.ndarray, tolerance: float = 0.0) -> np.ndarray:
        """Tell which points [m], shape [n, 3], lie inside, shape [n], bool.

        A point within ``tolerance`` [m] of the surface counts as on it, and so as inside.
        """

    @abstractmethod
    def bounds(self) -> np.ndarray:
        """Lowest and highest corner [m] of the bounding box, shape [2, 3]; infinite where there is no bound."""

    @abstractmethod
    def moved(self, motion: Motion) -> "Shape":
        """Give the shape moved by a similarity."""

    def translate(self, vector: tuple[float, ...]) -> "Shape":
        """Give the shape moved by ``vector`` [m], of `dim` components."""
        return self.moved(Motion(shift=vector3(checks.vector("translation", vector, self.dim))))

    def rotate(
        self, axis: str | tuple[float, ...], degrees: float, *, center: tuple[float, ...] | None = None
    ) -> "Shape":
        """Give the shape turned right-handedly about an axis through ``center`` [m] (default the origin).

        Args:
            axis: ``"x"``, ``"y"``, ``"z"``, or a vector in 3D; only ``"z"`` in 2D.
            degrees: Angle [degrees].
            center: A point on the axis, of `dim` components.

        Raises:
            InputError: If the axis, the angle or the centre is not allowed.
        """
        if (self.dim == 2 and axis != "z") or self.dim == 1:
            raise checks.refuse(
                "axis of rotation", axis, '"z" for a 2D shape' if self.dim == 2 else "none for a 1D shape"
            )
        rotation = _rotation(axis, checks.number("angle of rotation", degrees))
        about = (
            np.zeros(3) if center is None else vector3(checks.vector("center of rotation", center, self.dim))
        )
        return self.moved(Motion(rotation=rotation, shift=about - rotation @ about))

    def scale(self, factor: float) -> "Shape":
        """Give the shape with every length, from the origin, times ``factor``."""
        return self.moved(Motion(factor=checks.positive("scale factor", factor)))

    def __or__(self, other: "Shape") -> "Shape":
        return Union(self, other) if isinstance(other, Shape) else NotImplemented

    def __and__(self, other: "Shape") -> "Shape":
        return Intersection(self, other) if isinstance(other, Shape) else NotImplemented

    def __sub__(self, other: "Shape") -> "Shape":
        return Difference(self, other) if isinstance(other, Shape) else NotImplemented


@dataclass(frozen=True)
class Box(Shape):
    """A box (3D), rectangle (2D) or interval (1D) between two corners.

    Attributes:
        low: Lowest corner [m], 1, 2 or 3 components; a number in 1D.
        high: Highest corner [m].
        axes: Directions of the edges as rows of a rotation matrix, in which the corners are measured: set by `rotate`.

    Raises:
        InputError: If ``low`` is not below ``high`` in every component.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    axes: tuple[tuple[float, ...], ...] = field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), repr=False
    )

    def __post_init__(self):
        low = checks.vector("low of Box", self.low, 1, 2, 3)
        high = checks.vector("high of Box", self.high, len(low))
        if not all(a < b for a, b in zip(low, high, strict=True)):
            raise checks.refuse("high of Box", self.high, f"above low = {low} in every component")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @property
    def dim(self) -> int:
        """Number of components of the corners."""
        return len(self.low)

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        axes = np.array(self.axes)
        own = points if np.array_equal(axes, np.eye(3)) else points @ axes.T
        return _between(own, self.low, self.high, tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        middle, half = vector3(self.low) + vector3(self.high), vector3(self.high) - vector3(self.low)
        axes = np.array(self.axes)
        middle, half = 0.5 * middle @ axes, 0.5 * half @ np.abs(axes)
        return np.array((middle - half, middle + half))

    def moved(self, motion):
        """See `Shape.moved`."""
        axes = np.array(self.axes) @ motion.rotation.T
        low, high = (
            motion.factor * vector3(corner) + axes @ motion.shift for corner in (self.low, self.high)
        )
        return Box(low[: self.dim], high[: self.dim], tuple(map(tuple, axes.tolist())))


@dataclass(frozen=True)
class _Round(Shape):
    """Everything within a distance of a centre in the first `dim` coordinates."""

    radius: float
    center: tuple[float, ...]

    def __post_init__(self):
        kind = type(self).__name__
        object.__setattr__(self, "radius", checks.positive(f"radius of {kind}", self.radius))
        object.__setattr__(self, "center", checks.vector(f"center of {kind}", self.center, self.dim))

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        return _distance(points, self.center) <= self.radius + tolerance

    def bounds(self):
        """See `Shape.bounds`."""
        return _around(self.center, self.radius)

    def moved(self, motion):
        """See `Shape.moved`."""
        return type(self)(motion.factor * self.radius, motion.point(self.center))


@dataclass(frozen=True)
class Disc(_Round):
    """A disc of the plane (2D).

    Attributes:
        radius: Radius [m].
        center: Centre [m], two components.
    """

    center: tuple[float, ...] = (0.0, 0.0)
    dim = 2


@dataclass(frozen=True)
class Sphere(_Round):
    """A solid sphere (3D).

    Attributes:
        radius: Radius [m].
        center: Centre [m], three components.
    """

    center: tuple[float, ...] = (0.0, 0.0, 0.0)
    dim = 3


@dataclass(frozen=True)
class Ring(Shape):
    """The annulus between two circles (2D).

    Attributes:
        inner: Inner radius [m].
        outer: Outer radius [m].
        center: Centre [m], two components.

    Raises:
        InputError: If the radii are not positive and increasing.
    """

    inner: float
    outer: float
    center: tuple[float, ...] = (0.0, 0.0)
    dim = 2

    def __post_init__(self):
        checks.positive("inner of Ring", self.inner)
        checks.positive("outer of Ring", self.outer)
        if self.inner >= self.outer:
            raise checks.refuse("outer of Ring", self.outer, f"above inner = {self.inner}")
        object.__setattr__(self, "center", checks.vector("center of Ring", self.center, 2))

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        r = _distance(points, self.center)
        return (r >= self.inner - tolerance) & (r <= self.outer + tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        return _around(self.center, self.outer)

    def moved(self, motion):
        """See `Shape.moved`."""
        return Ring(motion.factor * self.inner, motion.factor * self.outer, motion.point(self.center))


@dataclass(frozen=True)
class Cone(Shape):
    """A straight cone (3D), cut off flat if ``end_radius`` is given.

    Attributes:
        start: Centre of the base [m], three components.
        end: The tip, or the centre of the flat end [m].
        radius: Radius at the base [m].
        end_radius: Radius at the end [m].

    Raises:
        InputError: If the two points are the same or a radius is negative.
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    radius: float
    end_radius: float = 0.0
    dim = 3

    def __post_init__(self):
        _check_axis("Cone", self)
        if checks.number("end_radius of Cone", self.end_radius) < 0.0:
            raise checks.refuse("end_radius of Cone", self.end_radius, "zero or a positive number")

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        start, span = np.array(self.start), np.subtract(self.end, self.start)
        length = np.linalg.norm(span)
        along = (points - start) @ (span / length)
        across = _distance(points - start - along[:, None] * (span / length), (0.0, 0.0, 0.0))
        radius = self.radius + (self.end_radius - self.radius) * np.clip(along / length, 0.0, 1.0)
        return (along >= -tolerance) & (along <= length + tolerance) & (across <= radius + tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        span = np.subtract(self.end, self.start)
        reach = np.sqrt(
            np.clip(1.0 - (span / np.linalg.norm(span)) ** 2, 0.0, 1.0)
        )  # of a disc of radius one
        ends = [
            c + s * r * reach
            for c, r in ((self.start, self.radius), (self.end, self.end_radius))
            for s in (-1.0, 1.0)
        ]
        return np.array((np.min(ends, axis=0), np.max(ends, axis=0)))

    def moved(self, motion):
        """See `Shape.moved`."""
        f = motion.factor
        return Cone(motion.point(self.start), motion.point(self.end), f * self.radius, f * self.end_radius)


@dataclass(frozen=True)
class Cylinder(Shape):
    """A solid cylinder along any axis (3D).

    Attributes:
        start: Centre of one end [m], three components.
        end: Centre of the other end [m].
        radius: Radius [m].

    Raises:
        InputError: If the two points are the same or the radius is not positive.
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    radius: float
    dim = 3

    def __post_init__(self):
        _check_axis("Cylinder", self)

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        return Cone(self.start, self.end, self.radius, self.radius).contains(points, tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        return Cone(self.start, self.end, self.radius, self.radius).bounds()

    def moved(self, motion):
        """See `Shape.moved`."""
        return Cylinder(motion.point(self.start), motion.point(self.end), motion.factor * self.radius)


@dataclass(frozen=True)
class HalfSpace(Shape):
    """Everything on one side of a plane (3D), a line (2D) or a point (1D): cuts other shapes.

    ``disc & HalfSpace((0, 0), (1, 0))`` keeps the half of the disc at x >= 0.

    Attributes:
        point: A point of the surface [m], 1, 2 or 3 components.
        towards: Direction from the surface into the half-space.

    Raises:
        InputError: If the direction is zero or has another number of components.
    """

    point: tuple[float, ...]
    towards: tuple[float, ...]

    def __post_init__(self):
        point = checks.vector("point of HalfSpace", self.point, 1, 2, 3)
        towards = checks.vector("towards of HalfSpace", self.towards, len(point))
        if not any(towards):
            raise checks.refuse("towards of HalfSpace", self.towards, "a direction that is not zero")
        object.__setattr__(self, "point", point)
        object.__setattr__(self, "towards", towards)

    @property
    def dim(self) -> int:
        """Number of components of the point."""
        return len(self.point)

    @property
    def rest(self) -> "HalfSpace":
        """The other side."""
        return HalfSpace(self.point, tuple(-t for t in self.towards))

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        towards = vector3(self.towards)
        return (points - vector3(self.point)) @ (towards / np.linalg.norm(towards)) >= -tolerance

    def bounds(self):
        """See `Shape.bounds`."""
        box = np.array(((-np.inf,) * 3, (np.inf,) * 3))
        axes = np.flatnonzero(self.towards)
        if len(axes) == 1:  # along an axis: one side of the bounding box is known
            side = 0 if self.towards[axes[0]] > 0 else 1
            box[side, axes[0]] = self.point[axes[0]]
        return box

    def moved(self, motion):
        """See `Shape.moved`."""
        return HalfSpace(motion.point(self.point), motion.direction(self.towards))


@dataclass(frozen=True, eq=False)
class Mesh(Shape):
    """The inside of a closed surface mesh (3D).

    Mesh files carry no unit: a part drawn in millimetres needs ``Mesh("part.stl").scale(1e-3)``.

    Attributes:
        source: A file (STL, OBJ or PLY) or a `pyvista.PolyData`. Holds the closed, outward-oriented triangles after
            construction.

    Raises:
        InputError: If the file cannot be read or the surface is not closed.
    """

    source: "str | Path | pyvista.PolyData"
    dim = 3

    def __post_init__(self):
        object.__setattr__(self, "source", closed_surface(self.source))

    def __repr__(self):
        return f"Mesh({self.source.n_cells} triangles)"

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        low, high = self.bounds()
        inside = _between(points, low, high, tolerance)
        inside[inside] = within(self.source, points[inside], tolerance)
        return inside

    def bounds(self):
        """See `Shape.bounds`."""
        return np.reshape(self.source.bounds, (3, 2)).T.astype(np.float64)

    def moved(self, motion):
        """See `Shape.moved`."""
        surface = self.source.copy()
        surface.points = motion.factor * surface.points.astype(np.float64) @ motion.rotation.T + motion.shift
        return Mesh(surface)


@dataclass(frozen=True)
class _Pair(Shape):
    """Two shapes of the same dimension combined."""

    first: Shape
    second: Shape

    def __post_init__(self):
        if self.first.dim != self.second.dim:
            raise values.clash(str(self.second), str(self.first), "shapes of the same dimension")

    @property
    def dim(self) -> int:
        """Dimension of both."""
        return self.first.dim

    def moved(self, motion):
        """See `Shape.moved`."""
        return type(self)(self.first.moved(motion), self.second.moved(motion))


class Union(_Pair):
    """What lies in either of two shapes: ``a | b``."""

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        return self.first.contains(points, tolerance) | self.second.contains(points, tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        first, second = self.first.bounds(), self.second.bounds()
        return np.array((np.minimum(first[0], second[0]), np.maximum(first[1], second[1])))


class Intersection(_Pair):
    """What lies in both of two shapes: ``a & b``."""

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        return self.first.contains(points, tolerance) & self.second.contains(points, tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        return _common(self.first.bounds(), self.second.bounds())


class Difference(_Pair):
    """What lies in the first shape and not in the second: ``a - b``."""

    def contains(self, points, tolerance=0.0):
        """See `Shape.contains`."""
        return self.first.contains(points, tolerance) & ~self.second.contains(points, tolerance)

    def bounds(self):
        """See `Shape.bounds`."""
        box = self.first.bounds()
        return _common(box, self.second.rest.bounds()) if isinstance(self.second, HalfSpace) else box


def _check_axis(kind: str, shape: "Cone | Cylinder") -> None:
    """Check and store start, end and radius of a shape along an axis."""
    object.__setattr__(shape, "start", checks.vector(f"start of {kind}", shape.start, 3))
    object.__setattr__(shape, "end", checks.vector(f"end of {kind}", shape.end, 3))
    object.__setattr__(shape, "radius", checks.positive(f"radius of {kind}", shape.radius))
    if shape.start == shape.end:
        raise checks.refuse(f"end of {kind}", shape.end, "a point other than start")


def _between(points: np.ndarray, low: Sequence[float], high: Sequence[float], tolerance: float) -> np.ndarray:
    """Whether points, shape [n, 3], lie between two corners, in as many coordinates as these have, shape [n], bool."""
    inside = np.ones(len(points), dtype=bool)
    for x, a, b in zip(points.T, low, high, strict=False):
        inside &= (x >= a - tolerance) & (x <= b + tolerance)
    return inside


def _distance(points: np.ndarray, center: tuple[float, ...]) -> np.ndarray:
    """Distance of points, shape [n, 3], from a centre in as many coordinates as it has."""
    squared = np.zeros(len(points))
    for x, c in zip(points.T, center, strict=False):
        squared += (x - c) ** 2
    return np.sqrt(squared)


def _around(center: tuple[float, ...], radius: float) -> np.ndarray:
    """Bounding box of everything within a radius in as many coordinates as the centre has, shape [2, 3]."""
    reach = vector3((radius,) * len(center))
    return np.array((vector3(center) - reach, vector3(center) + reach))


def _common(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Box that two boxes share, shape [2, 3]; its corners are the wrong way round if there is none."""
    return np.array((np.maximum(first[0], second[0]), np.minimum(first[1], second[1])))


def _rotation(axis: str | tuple[float, ...], degrees: float) -> np.ndarray:
    """Rotation matrix about an axis (Rodrigues), shape [3, 3]."""
    named = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    if isinstance(axis, str) and axis not in named:
        raise checks.refuse("axis of rotation", axis, '"x", "y", "z" or a vector')
    direction = np.array(named[axis] if isinstance(axis, str) else checks.vector("axis of rotation", axis, 3))
    if not direction.any():
        raise checks.refuse("axis of rotation", axis, "a vector that is not zero")
    a, b, c = direction / np.linalg.norm(direction)
    cross = np.array(((0.0, -c, b), (c, 0.0, -a), (-b, a, 0.0)))
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
