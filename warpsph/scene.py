"""The scene builder: bodies, constraints and measures of a problem, checked and turned into particles."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from . import checks, lattices, materials
from .body import Body, Velocity, given_points, initial_velocity, particle_volume
from .config import Numerics
from .guards import Guards
from .lattices import Lattice
from .materials import Material
from .messages import bodies, values
from .overlap import close_pairs
from .shapes import Shape
from .state import State

OVERLAP = 0.5
"""Particles of different bodies closer than this, in spacings, overlap."""

DUPLICATE = 0.1
"""Particles of the same body closer than this, in spacings, are the same particle twice."""

_SLACK = 1.0 - 1e-6
"""Exactly at a limit is allowed, whatever the round-off."""


@dataclass(frozen=True)
class Measure:
    """A number taken from the particles, reported at the end and in the history.

    Attributes:
        function: Gives the number from a picture of all particles.
        unit: SI unit, ``"1"`` if dimensionless.
        peak: Report the largest number so far, among the rows of the history.
    """

    function: Callable[[State], float]
    unit: str
    peak: bool = False


@dataclass(frozen=True, eq=False)
class SceneData:
    """A finished scene: n particles and everything a solver needs.

    Attributes:
        name: Name of the scene.
        dim: Space dimension, 1, 2 or 3.
        spacing: Particle spacing [m].
        h: Smoothing length [m].
        numerics: Numerical settings.
        until: End time [s].
        snapshots: Number of snapshots after the first.
        x: Positions [m], shape [n, 3], float64.
        v: Velocities [m/s], shape [n, 3], float64.
        m: Masses [kg] (per metre in 2D, per square metre in 1D), shape [n], float64.
        rho: Densities [kg/m^3], shape [n], float64.
        e: Specific internal energies [J/kg], shape [n], float64.
        body: Index into ``bodies``, shape [n], int32.
        mat: Index into ``materials``, shape [n], int32.
        fixed: Bits 1, 2, 4 where velocity component x, y, z is prescribed, shape [n], int32.
        eulerian: Where an adaptive scheme starts with Eulerian particles, shape [n], bool.
        bodies: Body names.
        materials: Materials, each once.
        planes: Symmetry planes as (axis 0, 1 or 2, position [m]); all particles lie on one side of each.
        measures: Measures by name.
        guards: What the run watches for.
    """

    name: str
    dim: int
    spacing: float
    h: float
    numerics: Numerics
    until: float
    snapshots: int
    x: np.ndarray
    v: np.ndarray
    m: np.ndarray
    rho: np.ndarray
    e: np.ndarray
    body: np.ndarray
    mat: np.ndarray
    fixed: np.ndarray
    eulerian: np.ndarray
    bodies: list[str]
    materials: list[Material]
    planes: tuple[tuple[int, float], ...]
    measures: dict[str, Measure]
    guards: Guards

    def __repr__(self) -> str:
        return f"SceneData({self.name!r}, {self.dim}D, {len(self.x)} particles, bodies: {', '.join(self.bodies)})"


class Scene:
    """A problem under construction.

    Example:
        >>> scene = Scene("impact", dim=2, spacing=1e-4, until=8e-6)
        >>> scene.add_body("ball", Disc(5e-3, (-5.2e-3, 0)), "aluminium", velocity=(3100, 0))
        >>> scene.add_body("plate", Box((0, -25e-3), (2e-3, 25e-3)), "aluminium")
        >>> scene.fix("plate", lambda x: abs(x[:, 1]) > 24.8e-3)

    Attributes:
        name: Name; snapshots are called after it.
        dim: Space dimension, 1, 2 or 3.
        spacing: Particle spacing [m], shared by all bodies.
        numerics: Numerical settings.
        until: End time [s].
        snapshots: Number of snapshots after the first.
        guards: What the run watches for.
        bodies: Bodies by name.
        planes: Symmetry planes as (axis, position [m]).
        measures: Measures by name.
    """

    def __init__(
        self,
        name: str,
        *,
        dim: int,
        spacing: float,
        until: float,
        numerics: Numerics | None = None,
        snapshots: int = 20,
        guards: Guards | None = None,
    ):
        """Start an empty scene.

        Raises:
            InputError: If a value is not allowed.
        """
        if not isinstance(name, str) or not re.fullmatch(r"\w[\w.-]*", name):
            raise checks.refuse("name of the scene", name, "letters, digits, _, - and . (it names files)")
        if isinstance(dim, bool) or dim not in (1, 2, 3):
            raise checks.refuse("dim", dim, "1, 2 or 3")
        if isinstance(snapshots, bool) or not isinstance(snapshots, int | np.integer) or snapshots < 1:
            raise checks.refuse("snapshots", snapshots, "a whole number, at least 1")
        if not isinstance(numerics, Numerics | None):
            raise checks.refuse("numerics", numerics, "warpsph.config.Numerics(...)")
        if not isinstance(guards, Guards | None):
            raise values.refuse("guards", guards, "warpsph.Guards(...)")
        self.name, self.dim, self.snapshots = name, int(dim), int(snapshots)
        self.spacing = checks.positive("spacing", spacing)
        self.until = checks.positive("until", until)
        self.numerics = numerics or Numerics()
        self.guards = guards or Guards()
        self.bodies: dict[str, Body] = {}
        self.planes: list[tuple[int, float]] = []
        self.measures: dict[str, Measure] = {}

    def __len__(self) -> int:
        return sum(map(len, self.bodies.values()))

    def __repr__(self) -> str:
        names = ", ".join(f"{b.name} ({len(b)})" for b in self.bodies.values())
        return f"Scene({self.name!r}, {self.dim}D, spacing {self.spacing:g} m, {len(self)} particles: {names or 'no bodies'})"

    def add_body(
        self,
        name: str,
        shape: Shape | np.ndarray,
        material: Material | str,
        *,
        lattice: Lattice | str | None = None,
        velocity: Velocity = (0.0, 0.0, 0.0),
        density: float | None = None,
        internal_energy: float = 0.0,
        volume: float | np.ndarray | None = None,
    ) -> Body:
        """Add a body: a shape filled with a lattice of particles, or particles where you want them.

        Args:
            name: Name of the body, used once.
            shape: Shape of the problem's dimension, or points [m], shape [n, dim] or [n, 3], a spacing apart.
            material: Material, or the name of one in the library.
            lattice: Lattice or its name, see `warpsph.lattices.LATTICES`; default ``"cartesian"``. Not with points.
            velocity: Initial velocity [m/s]: a vector, one per particle, or a function of the positions [m],
                shape [n, 3], that gives one per particle (see `spin`).
            density: Initial density [kg/m^3]; default the material's.
            internal_energy: Initial specific internal energy [J/kg].
            volume: Volume of a particle [m^dim], a number or one for each; default the cell of the lattice,
                ``spacing**dim`` for points. A particle's mass is density times volume.

        Returns:
            The body.

        Raises:
            InputError: If a value is not allowed, or no particle lies in the shape.
        """
        if not checks.is_name(name) or name in self.bodies:
            raise checks.refuse(
                "name of a body",
                name,
                f"a printable text other than {', '.join(self.bodies)}"
                if self.bodies
                else "a printable text",
            )
        x, cell = self._particles(name, shape, lattice)
        material = self._material(name, material)
        self.bodies[name] = added = Body(
            name=name,
            materials=[material],
            mat=np.zeros(len(x), dtype=np.int32),
            x=x,
            v=initial_velocity(name, velocity, x, self.dim),
            volume=particle_volume(name, cell if volume is None else volume, len(x)),
            density=np.full(len(x), self._density(name, material, density)),
            internal_energy=checks.number(f"internal_energy of body {name!r}", internal_energy),
            fixed=np.zeros(len(x), dtype=np.int32),
            eulerian=np.zeros(len(x), dtype=bool),
        )
        return added

    def set_material(
        self,
        body: str,
        material: Material | str,
        where: Shape | Callable[[np.ndarray], np.ndarray] | np.ndarray,
        *,
        density: float | None = None,
    ) -> None:
        """Give some particles of a body another material: an inlay that is bonded to the rest.

        Args:
            body: Name of the body.
            material: Material, or the name of one in the library.
            where: Which of its particles, as in `fix`.
            density: Their initial density [kg/m^3]; default the material's. They keep their volume.

        Raises:
            InputError: If a value is not allowed, or no particle is selected.
        """
        found, chosen = self._chosen("set_material", body, where)
        material = self._material(body, material)
        if material not in found.materials:
            found.materials.append(material)
        found.mat[chosen] = found.materials.index(material)
        found.density[chosen] = self._density(body, material, density)

    def make_eulerian(
        self, body: str, where: Shape | Callable[[np.ndarray], np.ndarray] | np.ndarray | None = None
    ) -> None:
        """Start an adaptive scheme with Eulerian particles in a region; all others are Total Lagrangian.

        Args:
            body: Name of the body.
            where: Which of its particles, as in `fix`; default all.

        Raises:
            InputError: If there is no such body, or no particle is selected.
        """
        found, chosen = self._chosen("make_eulerian", body, where)
        found.eulerian[chosen] = True

    def fix(
        self,
        body: str,
        where: Shape | Callable[[np.ndarray], np.ndarray] | np.ndarray | None = None,
        *,
        components: str = "xyz",
    ) -> None:
        """Keep velocity components of a body's particles as they start: clamped if zero, driven if not.

        Args:
            body: Name of the body.
            where: Which of its particles: those in a shape, or a function of the positions [m], shape [n, 3], that
                gives a mask, shape [n], or that mask; default all.
            components: Which components, any of the letters x, y, z; those the problem has not are left out.

        Raises:
            InputError: If there is no such body, no such component, or no particle is selected.
        """
        letters = components if isinstance(components, str) else ""
        bits = sum(1 << axis for axis, letter in enumerate("xyz"[: self.dim]) if letter in letters)
        if not bits or not set(letters) <= set("xyz"):
            raise checks.refuse(
                f"components of body {body!r} to fix", components, f"letters of {'xyz'[: self.dim]}"
            )
        found, chosen = self._chosen("fix", body, where)
        found.fixed[chosen] |= bits

    def add_symmetry_plane(self, axis: Literal["x", "y", "z"], position: float = 0.0) -> None:
        """Add a plane that mirrors the particles: frictionless, and nothing crosses it.

        All particles must lie on one side, at least a quarter of a spacing away: half a spacing is natural.

        Args:
            axis: Axis normal to the plane; one plane for each.
            position: Coordinate of the plane along that axis [m].

        Raises:
            InputError: If the problem has no such axis, or it has its plane already.
        """
        axes = "xyz"[: self.dim]
        if axis not in tuple(axes):
            raise checks.refuse("axis of a symmetry plane", axis, f"{', '.join(axes)} in {self.dim}D")
        if axes.index(axis) in dict(self.planes):
            raise checks.refuse("axis of a symmetry plane", axis, "one plane for each axis")
        self.planes.append((axes.index(axis), checks.number("position of a symmetry plane", position)))

    def add_measure(
        self, name: str, function: Callable[[State], float], unit: str = "1", *, peak: bool = False
    ) -> None:
        """Add a number that is taken from the particles and reported.

        Args:
            name: Name in the summary and the history.
            function: Gives the number from a `warpsph.state.State`, which is good until it returns.
            unit: SI unit.
            peak: Report the largest number so far; it is looked at some 200 times a run, for the history.

        Raises:
            InputError: If the name is in use, name or unit cannot be printed, or the function cannot be called.
        """
        if not checks.is_name(name) or name in self.measures:
            others = f" other than {', '.join(self.measures)}" if self.measures else ""
            raise checks.refuse("name of a measure", name, f"a printable text{others}")
        if unit and not checks.is_name(unit):
            raise checks.refuse(f"unit of measure {name!r}", unit, "a printable text")
        if not callable(function):
            raise checks.refuse(f"function of measure {name!r}", function, "a function of a State")
        self.measures[name] = Measure(function, unit, peak)

    def finalize(self) -> SceneData:
        """Check the scene as a whole and give its particles, body after body.

        Raises:
            InputError: If there are no bodies, bodies overlap, particles coincide, two materials share a name, or
                particles lie beyond a symmetry plane or on it, or outside of the domain.
        """
        if not self.bodies:
            raise bodies.none(self.name)
        parts = list(self.bodies.values())
        lengths = [len(b) for b in parts]
        used = _distinct([material for b in parts for material in b.materials])
        rho = np.concatenate([b.density for b in parts])
        data = SceneData(
            name=self.name, dim=self.dim, spacing=self.spacing, h=self.numerics.smoothing_ratio * self.spacing,
            numerics=self.numerics, until=self.until, snapshots=self.snapshots,
            x=np.concatenate([b.x for b in parts]),
            v=np.concatenate([b.v for b in parts]),
            m=rho * np.concatenate([b.volume for b in parts]),
            rho=rho,
            e=np.repeat([b.internal_energy for b in parts], lengths),
            body=np.repeat(np.arange(len(parts), dtype=np.int32), lengths),
            mat=np.concatenate([np.array(list(map(used.index, b.materials)), dtype=np.int32)[b.mat] for b in parts]),
            fixed=np.concatenate([b.fixed for b in parts]),
            eulerian=np.concatenate([b.eulerian for b in parts]),
            bodies=list(self.bodies), materials=used, planes=tuple(self.planes), measures=dict(self.measures),
            guards=self.guards,
        )  # fmt: skip
        _check_distances(data)
        for axis, position in data.planes:
            _check_plane(data, axis, position)
        _check_domain(data)
        return data

    def _particles(
        self, name: str, shape: Shape | np.ndarray, lattice: Lattice | str | None
    ) -> tuple[np.ndarray, float]:
        """Positions [m], shape [n, 3], and volume of the cell [m^dim] of a new body."""
        if not isinstance(shape, Shape):
            if lattice is not None:
                raise checks.refuse(f"lattice of body {name!r}", lattice, "none, for its points are given")
            return given_points(name, shape, self.spacing, self.dim), self.spacing**self.dim
        pattern = lattices.get("cartesian" if lattice is None else lattice)
        x = pattern.fill(shape, self.spacing, self.dim, f"body {name!r}")
        if len(x) == 0:
            raise bodies.empty(name, shape, self.spacing)
        return x, pattern.cell_volume(self.spacing, self.dim)

    def _material(self, name: str, material: Material | str) -> Material:
        if isinstance(material, str):
            return materials.get(material)
        if not isinstance(material, Material):
            raise checks.refuse(f"material of body {name!r}", material, "a Material or the name of one")
        return material

    def _density(self, name: str, material: Material, density: float | None) -> float:
        return material.density if density is None else checks.positive(f"density of body {name!r}", density)

    def _chosen(
        self, act: str, body: str, where: Shape | Callable | np.ndarray | None
    ) -> tuple[Body, np.ndarray]:
        """The body of that name, and the mask of its particles that are meant, shape [n].

        Raises:
            InputError: If there is no such body, or no particle is meant.
        """
        if body not in self.bodies:
            allowed = ", ".join(self.bodies) or "none, for the scene has no bodies yet"
            raise checks.refuse(f"body to {act}", body, allowed)
        found = self.bodies[body]
        chosen = self._selection(act, found, where)
        if not chosen.any():
            raise bodies.nobody_meant(act, body, len(found))
        return found, chosen

    def _selection(self, act: str, body: Body, where: Shape | Callable | np.ndarray | None) -> np.ndarray:
        """Mask of the particles of a body that are meant, shape [n]."""
        if where is None:
            return np.ones(len(body), dtype=bool)
        if isinstance(where, Shape):
            return where.contains(body.x, lattices.ROUND_OFF * self.spacing)
        mask = np.asarray(where(body.x.copy()) if callable(where) else where)
        if mask.dtype != bool or mask.shape != (len(body),):
            raise bodies.no_mask(act, body.name, mask, len(body))
        return mask


def spin(
    rate: float,
    center: tuple[float, ...] = (0.0, 0.0, 0.0),
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0),
) -> Velocity:
    """Give the velocity of a rigid rotation, for `Scene.add_body`.

    Args:
        rate: Angular velocity [rad/s], right-handed about the axis.
        center: A point on the axis [m].
        axis: Direction of the axis; z in 2D.

    Raises:
        InputError: If a value is not a finite number, or the axis is zero.
    """
    direction = np.array(checks.vector("axis of spin", axis, 3))
    if not direction.any():
        raise checks.refuse("axis of spin", axis, "a vector that is not zero")
    omega = checks.number("rate of spin", rate) * direction / np.linalg.norm(direction)
    start = checks.vector3(checks.vector("center of spin", center, 2, 3))
    return lambda x: np.cross(omega, x - start)


def _distinct(found: list[Material]) -> list[Material]:
    """Give each material once.

    Raises:
        InputError: If two different materials have the same name.
    """
    used: dict[str, Material] = {}
    for material in found:
        if used.setdefault(material.name, material) != material:
            raise values.clash(
                f"material {material.name!r}", "another of that name", "one name for each set of constants"
            )
    return list(used.values())


def _check_distances(data: SceneData) -> None:
    """Refuse bodies that overlap and particles that are there twice."""
    limit = OVERLAP * data.spacing * _SLACK
    i, j = close_pairs(data.x[:, : data.dim], limit)
    across = data.body[i] != data.body[j]
    if across.any():
        first, second = i[across][0], j[across][0]
        one, other = data.bodies[data.body[first]], data.bodies[data.body[second]]
        raise bodies.overlap(one, other, across.sum(), data.x[first, : data.dim], OVERLAP * data.spacing)
    same = np.linalg.norm(data.x[i] - data.x[j], axis=1) < DUPLICATE * data.spacing
    if same.any():
        first = i[same][0]
        raise bodies.coincide(data.bodies[data.body[first]], same.sum(), data.x[first, : data.dim], DUPLICATE)


def _check_plane(data: SceneData, axis: int, position: float) -> None:
    """Refuse particles beyond a symmetry plane, or so near that they would overlap with their mirror image."""
    distance = data.x[:, axis] - position
    side = 1.0 if (distance > 0.0).sum() * 2 >= len(distance) else -1.0
    nearest = int(np.argmin(side * distance))
    if side * distance[nearest] < 0.5 * OVERLAP * data.spacing * _SLACK:
        name = data.bodies[data.body[nearest]]
        raise bodies.beyond_plane(name, data.x[nearest, : data.dim], "xyz"[axis], position)


def _check_domain(data: SceneData) -> None:
    """Refuse particles that start outside of the domain."""
    if data.guards.domain is None:
        return
    low, high = data.guards.domain
    if len(low) != data.dim:
        raise values.refuse("domain of Guards", data.guards.domain, f"corners of {data.dim} components")
    x = data.x[:, : data.dim]
    outside = np.flatnonzero(np.any((x < low) | (x > high), axis=1))
    if len(outside):
        first = outside[0]
        raise bodies.outside_domain(data.bodies[data.body[first]], x[first], low, high, len(outside))
