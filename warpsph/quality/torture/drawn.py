"""A drawn scene as plain numbers, and the scene that it stands for.

Lengths are in spacings, so that a description reads the same at any scale; its ``repr`` makes it again.
"""

import dataclasses
import math
import zlib
from dataclasses import dataclass

import numpy as np

from warpsph import materials
from warpsph.config import Contact, Conversion, Numerics
from warpsph.materials import Law, Material
from warpsph.scene import Scene, spin
from warpsph.shapes import Box, Disc, Ring, Shape, Sphere

LAWS = {
    "elastic": Material("elastic", 2700.0, materials.LinearElastic(K=80e9), materials.Elastic(G=27e9)),
    "dense": Material("dense", 19300.0, materials.LinearElastic(K=180e9), materials.PerfectlyPlastic(G=27e9, Y=0.1e9)),
    "water": Material("water", 1000.0, materials.StiffenedGas(c0=1480.0, gamma0=2.0), materials.Fluid()),
    "spray": Material(
        "spray", 1000.0, materials.StiffenedGas(c0=1480.0, gamma0=1.0), materials.Fluid(), pressure_cutoff=0.0
    ),
    "loose": Material(
        "loose", 1600.0, materials.IsothermalMieGrueneisen(c0=600.0, S1=1.4), materials.PerfectlyPlastic(G=1e8, Y=1e5)
    ),
    "molten": Material(
        "molten", 2700.0, materials.ShockMieGrueneisen(c0=5300.0, S1=1.34, Gamma0=2.0), materials.Fluid()
    ),
    "glass": Material(
        "glass", 2500.0, materials.Polynomial(k1=45e9, k2=-138e9, k3=290e9, B0=1.0, B1=0.5), materials.Elastic(G=30e9)
    ),
    "gas": Material("gas", 1.0, materials.IdealGas(gamma=5.0 / 3.0), materials.Fluid()),
}  # fmt: skip
"""Materials beside those of the library, for laws that it has no use for."""


@dataclass(frozen=True)
class DrawnMaterial:
    """A material with some constants changed.

    Attributes:
        base: Name of one of `LAWS` or of the library.
        factors: Factors of constants of its laws, by their letters.
        cutoff: Its pressure cut-off [Pa], if another than its own.
        carries: What it carries once it has failed, if it has a damage law.
    """

    base: str
    factors: tuple[tuple[str, float], ...] = ()
    cutoff: float | None = None
    carries: str | None = None

    def constants(self) -> dict[str, float]:
        """Constants of the base's laws by their letters."""
        base = self._base()
        laws = (base.eos, base.strength, base.damage)
        return {name: value for law in laws if law is not None for name, value in law.constants.items()}

    def _base(self) -> Material:
        return LAWS[self.base] if self.base in LAWS else materials.get(self.base)

    def made(self) -> Material:
        """Make it; one that is changed has a name of its own."""
        base = self._base()
        if self == DrawnMaterial(self.base):
            return base
        changes = {
            part: _changed(getattr(base, part), dict(self.factors)) for part in ("eos", "strength", "damage")
        }
        if self.cutoff is not None:
            changes["pressure_cutoff"] = self.cutoff
        if self.carries is not None and changes["damage"] is not None:
            changes["damage"] = dataclasses.replace(changes["damage"], carries=self.carries)
        name = f"{self.base} changed {zlib.crc32(repr(self).encode()) & 0xFFFF:04x}"
        return dataclasses.replace(base, name=name, **changes)


@dataclass(frozen=True)
class DrawnBody:
    """A body.

    Attributes:
        kind: ``"box"``, ``"ball"``, ``"ring"``, ``"points"`` (a disturbed lattice) or ``"particle"``.
        size: Extent along each axis; of a ball and a ring, only the first counts.
        center: Its middle.
        material: What it is made of.
        inlay: Material of its particles on the high side of x.
        lattice: Name of the lattice, or none for that of the box.
        angle: By how much its shape is turned [degrees].
        noise: How far points are off a lattice.
        velocity: Velocity [m/s].
        spin: Speed at its edge of a rotation about its middle [m/s].
        swelling: Speed at its edge at which its particles run apart, or together [m/s].
        density: Density over the material's.
        energy: Specific internal energy [J/kg].
        fixed: Components of velocity that are prescribed.
        fixed_all: All its particles are, not only those on the low side of x.
        eulerian: Its particles on the high side of x start as Eulerian ones (True), or none; all of them: ``"all"``.
    """

    kind: str
    size: tuple[float, float, float]
    center: tuple[float, float, float]
    material: DrawnMaterial
    inlay: DrawnMaterial | None = None
    lattice: str | None = None
    angle: float = 0.0
    noise: float = 0.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spin: float = 0.0
    swelling: float = 0.0
    density: float = 1.0
    energy: float = 0.0
    fixed: str = ""
    fixed_all: bool = False
    eulerian: bool | str = False


@dataclass(frozen=True)
class DrawnScene:
    """A scene and how it is run.

    Attributes:
        dim: Space dimension.
        precision: Precision of the run.
        spacing: Particle spacing [m].
        bodies: Its bodies.
        numerics: Arguments of `warpsph.config.Numerics`.
        contact: Arguments of `warpsph.config.Contact`, if there is contact.
        conversion: Arguments of `warpsph.config.Conversion`, if there is conversion.
        planes: Symmetry planes as (axis, side -1 or 1, distance from the nearest particle).
        origin: Where its middle is.
        wild: What it has that no one would ask for lightly.
    """

    dim: int
    precision: str
    spacing: float
    bodies: tuple[DrawnBody, ...]
    numerics: tuple[tuple[str, object], ...] = ()
    contact: tuple[tuple[str, float], ...] = ()
    conversion: tuple[tuple[str, object], ...] = ()
    planes: tuple[tuple[str, int, float], ...] = ()
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wild: tuple[str, ...] = ()

    def made(self) -> Scene:
        """Build the scene.

        Raises:
            InputError: If something in it is not allowed.
        """
        options = dict(self.numerics)
        if self.contact:
            options["contact"] = Contact(**dict(self.contact))
        if self.conversion:
            options["conversion"] = Conversion(**dict(self.conversion))
        scene = Scene("drawn", dim=self.dim, spacing=self.spacing, until=1.0, numerics=Numerics(**options))
        for number, body in enumerate(self.bodies):
            self._add(scene, f"body{number}", body)
        for axis, side, distance in self.planes:
            along = np.concatenate([body.x[:, "xyz".index(axis)] for body in scene.bodies.values()])
            nearest = along.min() if side < 0 else along.max()
            scene.add_symmetry_plane(axis, nearest + side * distance * self.spacing)
        return scene

    def _add(self, scene: Scene, name: str, body: DrawnBody) -> None:
        center = self.spacing * (np.array(self.origin) + body.center)
        center[self.dim :] = 0.0

        edge = 0.5 * max(body.size) * self.spacing

        def velocity(x: np.ndarray) -> np.ndarray:
            v = body.velocity + spin(body.spin / edge, tuple(center))(x) + body.swelling / edge * (x - center)
            v[:, self.dim :] = 0.0
            return v

        material = body.material.made()
        density = None if body.density == 1.0 else body.density * material.density
        scene.add_body(
            name, self._filled(body, center), material, lattice=body.lattice, velocity=velocity, density=density,
            internal_energy=body.energy,
        )  # fmt: skip
        if body.inlay is not None:
            scene.set_material(name, body.inlay.made(), lambda x: x[:, 0] >= center[0])
        if body.fixed:
            low = None if body.fixed_all else (lambda x: x[:, 0] <= center[0])
            scene.fix(name, low, components=body.fixed)
        if body.eulerian:
            scene.make_eulerian(name, None if body.eulerian == "all" else (lambda x: x[:, 0] >= center[0]))

    def _filled(self, body: DrawnBody, center: np.ndarray) -> Shape | np.ndarray:
        """A body's shape or points [m]."""
        size, middle = self.spacing * np.array(body.size)[: self.dim], tuple(center[: self.dim])
        radius = 0.5 * size[0]
        if body.kind == "particle":
            return center[None]
        if body.kind == "points":
            return center + self._points(body)
        if body.kind == "ball" and self.dim > 1:
            return Disc(radius, middle) if self.dim == 2 else Sphere(radius, middle)
        if body.kind == "ring" and self.dim == 2:
            return Ring(0.6 * radius, radius, middle)
        low, high = np.array(middle) - 0.5 * size, np.array(middle) + 0.5 * size
        box = Box(tuple(low.tolist()), tuple(high.tolist()))
        return box.rotate("z", body.angle, center=middle) if body.angle and self.dim > 1 else box

    def _points(self, body: DrawnBody) -> np.ndarray:
        """Points of a disturbed lattice about the origin [m], shape [n, 3]."""
        counts = [max(math.floor(size), 1) for size in body.size[: self.dim]]
        index = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, self.dim)
        x = np.zeros((len(index), 3))
        x[:, : self.dim] = index - 0.5 * (np.array(counts) - 1)
        shift = np.random.default_rng(len(x)).uniform(-body.noise, body.noise, size=x.shape)
        x[:, : self.dim] += shift[:, : self.dim]
        return self.spacing * x


def _changed(law: Law | None, factors: dict[str, float]) -> Law | None:
    """A law with those of its constants changed that there are factors for."""
    if law is None:
        return None
    changes = {name: value * factors[name] for name, value in law.constants.items() if name in factors}
    return dataclasses.replace(law, **changes)
