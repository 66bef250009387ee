"""Small scenes, one for every scheme and every option that a restart could forget something of."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import warp as wp

from warpsph import materials as lib
from warpsph.config import Contact, Conversion, Numerics
from warpsph.kernels.spec import Spec
from warpsph.scene import Scene
from warpsph.schemes import SCHEMES, LagrangianSettings
from warpsph.shapes import Box, Disc, Sphere

SPACING = 1e-3
"""Particle spacing [m]."""

RADII = {1: 24.0, 2: 4.5, 3: 2.6}
"""Radius of a body in spacings: some 50 to 150 particles in two of them."""

METAL = lib.get("aluminium-jc")
FRAGILE = lib.Material(
    "fragile", METAL.density, METAL.eos, METAL.strength, METAL.pressure_cutoff, lib.JohnsonCookDamage(D1=0.05)
)
"""A metal that fails early."""


@dataclass(frozen=True)
class Variant:
    """Two bodies that meet off their axis, and how.

    Attributes:
        numerics: Numerical settings by name.
        dim: Space dimension.
        precision: Arithmetic.
        material: Of both bodies.
        speed: Of the first one [m/s].
        until: End time [s].
        more: What else is done to the scene.
    """

    numerics: dict
    dim: int = 2
    precision: str = "float64"
    material: lib.Material | str = "aluminium"
    speed: float = 1200.0
    until: float = 3e-6
    more: Callable[[Scene], None] | None = None


def make(name: str) -> Scene:
    """Build the scene of a variant, by its name."""
    variant = VARIANTS[name]
    scene = Scene(
        "bodies", dim=variant.dim, spacing=SPACING, until=variant.until, snapshots=3,
        numerics=Numerics(**variant.numerics),
    )  # fmt: skip
    r, gap = RADII[variant.dim] * SPACING, 1.2 * SPACING
    shape = {1: lambda c: Box(c[0] - r, c[0] + r), 2: lambda c: Disc(r, c[:2]), 3: lambda c: Sphere(r, c)}
    centre = (r + 0.5 * gap, 0.4 * r, 0.0)
    scene.add_body(
        "left",
        shape[variant.dim]((-centre[0], 0.0, 0.0)),
        variant.material,
        velocity=(variant.speed, 0.0, 0.0),
    )
    scene.add_body("right", shape[variant.dim](centre), variant.material)
    scene.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    scene.add_measure("peak_speed", lambda state: np.abs(state.v).max(), "m/s", peak=True)
    if variant.more is not None:
        variant.more(scene)
    return scene


def _planes(scene: Scene) -> None:
    """Mirror everything below and beside it."""
    scene.add_symmetry_plane("y", -5.2 * SPACING)
    scene.add_symmetry_plane("x", 11.1 * SPACING)


def _driven(scene: Scene) -> None:
    """Hold the back of one body, and push that of the other on."""
    scene.fix("left", lambda x: x[:, 0] < -8.0 * SPACING)
    scene.fix("right", lambda x: x[:, 0] > 8.0 * SPACING, components="x")


def _eulerian_front(scene: Scene) -> None:
    """Start with Eulerian particles where the bodies meet."""
    scene.make_eulerian("left", lambda x: x[:, 0] > -3.0 * SPACING)


@functools.cache
def _sheared(s: Spec) -> wp.Function:
    """A criterion as a user would write one: a share of plastic strain and of shear."""
    real = s.real

    @wp.func
    def sheared(F: s.mat, tau: s.mat, p: real, ep: real, D: real, T: real):
        return (ep + wp.abs(F[0, 1])) / real(0.2)

    return sheared


def _of_scheme(name: str) -> Variant:
    """A scheme as it is; particles of coupled ones convert."""
    settings = SCHEMES[name]
    coupled = isinstance(settings, LagrangianSettings) and settings.eulerian is not None
    return Variant({"scheme": name} | ({"conversion": Conversion(strain=0.08)} if coupled else {}))


CONTACT = Contact(stiffness=0.25)
EROSION = {"scheme": "tl", "erosion": True, "contact": CONTACT, "hourglass": 5.0}
DAMAGE = {"scheme": "adaptle-mixed-as", "conversion": Conversion(strain=0.1, damage=True)}
MON, TS2, PM = {"scheme": "mon-mixed-as"}, {"scheme": "ts2"}, {"scheme": "pm"}
STRAIN = {"scheme": "adaptle", "conversion": Conversion(strain=0.05)}

OPTIONS: dict[str, Variant] = {
    "sav1, contact": Variant({"scheme": "sav1", "contact": CONTACT}),
    "tl, contact": Variant({"scheme": "tl", "contact": CONTACT}),
    "tl, contact, hourglass control, erosion": Variant(EROSION, material=FRAGILE),
    "adaptle-as, contact, conversion by damage": Variant(
        {"scheme": "adaptle-as", "conversion": Conversion(damage=True), "contact": CONTACT}, material=FRAGILE
    ),
    "adaptle-mixed-as, conversion by strain and damage": Variant(DAMAGE, material=FRAGILE),
    "adaptle, conversion by strain, 2.5 km/s": Variant(STRAIN, speed=2500.0, until=1e-6),
    "adaptle, conversion by Green-Lagrange strain": Variant(
        {"scheme": "adaptle", "conversion": Conversion(strain=0.08, measure="green-lagrange")}
    ),
    "adaptle, conversion by Almansi strain, printed coupling": Variant(
        {
            "scheme": "adaptle",
            "conversion": Conversion(strain=0.08, measure="almansi"),
            "coupling": "printed",
        }
    ),
    "adaptle, conversion by plastic strain, inverted ones too": Variant(
        {"scheme": "adaptle", "conversion": Conversion(strain=0.1, measure="plastic"), "inverted": "convert"}
    ),
    "adaptle, a criterion of one's own": Variant(
        {"scheme": "adaptle", "conversion": Conversion(criterion=_sheared)}
    ),
    "adaptle-mixed, Eulerian from the start in part": Variant(
        {"scheme": "adaptle-mixed", "conversion": Conversion(strain=0.1)}, more=_eulerian_front
    ),
    "sav2-mixed-as, thin skin: particles sorted in memory on the way": Variant(
        {"scheme": "sav2-mixed-as", "skin": 0.1}, until=4e-6
    ),
    "mon-mixed-as, symmetry planes": Variant(MON, more=_planes),
    "adaptle, symmetry planes": Variant(STRAIN, more=_planes),
    "mon-mixed-as, driven particles": Variant(MON, more=_driven),
    "tl, contact, driven particles": Variant({"scheme": "tl", "contact": CONTACT}, more=_driven),
    "mon-mixed-as, plane stress": Variant(MON | {"plane": "stress"}),
    "adaptle, plane stress": Variant(STRAIN | {"plane": "stress"}),
    "sav1, Johnson-Cook with damage": Variant({"scheme": "sav1"}, material=FRAGILE),
    "sav1, Johnson-Holmquist 1": Variant({"scheme": "sav1"}, material="sic", speed=800.0),
    "ts2, two-shock, minmod": Variant(TS2 | {"riemann": "two-shock", "limiter": "minmod"}),
    "bal, Wendland C2": Variant({"scheme": "bal", "kernel": "wendland_c2"}),
    "mon-mixed-as, float32": Variant(MON, precision="float32"),
    "ts2, float32": Variant(TS2, precision="float32"),
    "adaptle-mixed-as, damage, float32": Variant(DAMAGE, material=FRAGILE, precision="float32"),
    "mon-mixed-as, mixed precision": Variant(MON, precision="mixed"),
    "pm, mixed precision": Variant(PM, precision="mixed"),
    "tl, contact, erosion, mixed precision": Variant(EROSION, material=FRAGILE, precision="mixed"),
    "sav1, 1D": Variant({"scheme": "sav1"}, dim=1),
    "ts2, 1D": Variant(TS2, dim=1),
    "adaptle, 1D": Variant(STRAIN, dim=1),
    "mon-mixed-as, 3D": Variant(MON, dim=3, until=1.5e-6),
    "pm, 3D": Variant(PM, dim=3, until=1.5e-6),
    "adaptle-mixed-as, damage, 3D": Variant(DAMAGE, dim=3, material=FRAGILE, until=1.5e-6),
    "tl, contact, erosion, 3D": Variant(EROSION, dim=3, material=FRAGILE, until=1.5e-6),
}
"""Options, each with a scheme that has them."""

VARIANTS: dict[str, Variant] = {name: _of_scheme(name) for name in SCHEMES} | OPTIONS
"""Every scheme, and then the options."""
