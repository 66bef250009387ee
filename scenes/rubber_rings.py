"""Two rubber rings collide and bounce off each other (Swegle et al. 1995; Gray, Monaghan & Swift 2001)."""

import numpy as np

from warpsph.config import Contact, Numerics
from warpsph.lattices import Rings
from warpsph.materials import Elastic, LinearElastic, Material
from warpsph.measure import groups, once
from warpsph.overlap import close_pairs
from warpsph.scene import Scene
from warpsph.shapes import Ring
from warpsph.state import State

INNER, OUTER = 0.03, 0.04
"""Radii of the rings [m]."""

DENSITY, SOUND = 1010.0, 852.0
"""Density [kg/m^3] and bulk sound speed [m/s] of the rubber; the motion depends on ratios of stresses and speeds only."""

RUBBER = Material(
    "rubber", DENSITY, LinearElastic(K=DENSITY * SOUND**2), Elastic(G=0.22 * DENSITY * SOUND**2),
    source="Gray, Monaghan & Swift 2001: Poisson's ratio 0.3975",
)  # fmt: skip

UNTIL = 2.5e-3
"""End time [s]: the rings have parted at about 1.3 ms."""

NAMES = ("left", "right")


def build(scheme: str = "tl", spacing: float = 1e-3, speed: float = 0.059, stiffness: float = 0.25) -> Scene:
    """Build the rings two spacings apart, each the mirror image of the other.

    Args:
        scheme: Scheme. In an Eulerian one the rings feel each other through the kernel; without artificial stress
            (sav1) they break where they are in tension, which is not physical.
        spacing: Particle spacing [m].
        speed: Speed of each ring over the bulk sound speed.
        stiffness: Stiffness of the contact in a Total Lagrangian or coupled scheme.
    """
    contact = Contact(stiffness=stiffness) if scheme.startswith(("tl", "adaptle")) else None
    numerics = Numerics(scheme=scheme, contact=contact)
    scene = Scene("rubber_rings", dim=2, spacing=spacing, until=UNTIL, numerics=numerics)
    left = Rings().fill(Ring(INNER, OUTER, (-OUTER - spacing, 0.0)), spacing, 2)
    scene.add_body("left", left, RUBBER, velocity=(speed * SOUND, 0.0))
    scene.add_body("right", left * (-1.0, 1.0, 1.0), RUBBER, velocity=(-speed * SOUND, 0.0))
    add_bounce(scene, speed * SOUND)
    add_fracture(scene)
    return scene


def add_bounce(scene: Scene, speed: float) -> None:
    """Add how far the rings are apart, less a spacing, and their speed of separation over that of approach.

    Args:
        scene: The scene.
        speed: Speed of each ring at the start [m/s].
    """

    def gap(state: State) -> float:
        left, right = (state.x[state.of(name), 0] for name in NAMES)
        return float(right.min() - left.max()) - state.spacing

    def restitution(state: State) -> float:
        left, right = (state.v[state.of(name), 0].mean() for name in NAMES)
        return float(right - left) / (2.0 * speed)

    scene.add_measure("gap", gap, "m")
    scene.add_measure("restitution", restitution)


def add_fracture(scene: Scene) -> None:
    """Add into how many pieces the rings are connected, the smallest share of a ring in one piece, and the stretch.

    Pieces are more than a support apart; the stretch is that of the distance between initial nearest neighbours.
    """
    x = np.concatenate([body.x for body in scene.bodies.values()])
    first, second = close_pairs(x, 1.2 * scene.spacing)
    distance = np.linalg.norm(x[first] - x[second], axis=1)

    @once
    def sizes(state: State) -> list[np.ndarray]:
        numbers = (groups(state.x[state.of(name)], 2.0 * state.h) for name in NAMES)
        return [np.bincount(number[number >= 0], minlength=1) for number in numbers]

    def stretch(state: State) -> float:
        return float((np.linalg.norm(state.x[first] - state.x[second], axis=1) / distance).max())

    scene.add_measure("pieces", lambda state: float(sum(map(len, sizes(state)))))
    scene.add_measure("largest_piece", lambda state: float(min(s.max() / s.sum() for s in sizes(state))))
    scene.add_measure("stretch_max", stretch, peak=True)


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
