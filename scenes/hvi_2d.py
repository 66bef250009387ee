"""Aluminium disc hits aluminium plate at 3.1 km/s in two dimensions (Young et al., AdapTLE, section 3.2)."""

from typing import Literal

import numpy as np

from warpsph.config import Numerics
from warpsph.lattices import CoreAndRings, Rings
from warpsph.scene import Scene
from warpsph.shapes import Box, Disc
from warpsph.state import State

RADIUS, THICKNESS, HEIGHT = 5e-3, 2e-3, 50.1e-3
"""Disc radius, plate thickness and plate height [m]."""


def build(
    scheme: str = "sav1",
    spacing: float = 1e-4,
    speed: float = 3100.0,
    lattice: Literal["core-and-rings", "rings"] = "core-and-rings",
    plane: Literal["strain", "stress"] = "strain",
) -> Scene:
    """Build disc and plate, so far apart that their supports are about to overlap: t = 0 of the measures.

    Args:
        scheme: Scheme.
        spacing: Particle spacing [m]; the paper's is 1e-4.
        speed: Speed of the disc [m/s].
        lattice: Arrangement of the disc's particles: 7830 or, as concentric rings, 8012 at the paper's spacing.
        plane: Plane strain or plane stress.
    """
    numerics = Numerics(scheme=scheme, smoothing_ratio=1.4, plane=plane)
    scene = Scene("hvi_2d", dim=2, spacing=spacing, until=8e-6, snapshots=20, numerics=numerics)
    gap = 2.0 * 1.4 * spacing - 0.5 * spacing
    filling = CoreAndRings() if lattice == "core-and-rings" else Rings("edges")
    scene.add_body(
        "projectile", Disc(RADIUS, (-RADIUS - gap, 0.0)), "aluminium", lattice=filling, velocity=(speed, 0.0)
    )
    scene.add_body("plate", Box((0.0, -0.5 * HEIGHT), (THICKNESS, 0.5 * HEIGHT)), "aluminium")
    centre = int(np.argmin(np.linalg.norm(scene.bodies["projectile"].x - [-RADIUS - gap, 0.0, 0.0], axis=1)))
    scene.add_measure("peak_pressure", lambda state: float(state.p_high[centre]), "Pa")
    scene.add_measure("projectile_travel", lambda state: nose(state), "m")
    return scene


def nose(state: State) -> float:
    """Leading edge of the projectile [m]."""
    return float(state.x[state.of("projectile"), 0].max())


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
