"""Steel bar hits a silicon carbide tile at 800 m/s in plane strain (Connolly et al. 2013, section 5)."""

import numpy as np

from warpsph.config import LimiterName, Numerics, RiemannName
from warpsph.lattices import Cartesian
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

LENGTH, WIDTH = 20e-3, 10e-3
"""Length (x) and width (y) of the bar [m]."""

THICKNESS, HEIGHT = 30e-3, 100e-3
"""Thickness (x) and height (y) of the tile [m]."""

REAR = 0.1
"""Share of the tile's thickness that counts as near its rear face."""

GAUGE = 2e-3
"""Depth below the face that is hit at which the first wave is looked at [m]: the sides release it there only later."""


def build(
    scheme: str = "ts2",
    spacing: float = 2.5e-4,
    speed: float = 800.0,
    riemann: RiemannName = "two-shock",
    limiter: LimiterName = "minmod",
    limiter_beta: float = 1.5,
    limit_jump: bool = False,
) -> Scene:
    """Build bar and tile one spacing apart, in contact: t = 0 is the impact.

    Args:
        scheme: Scheme; the paper's are av, ts1 and ts2.
        spacing: Particle spacing [m]; the paper's is 2.5e-4. Both edges of a body bear particles.
        speed: Speed of the bar [m/s].
        riemann: Riemann solver of the Godunov schemes.
        limiter: Slope limiter of the second-order ones.
        limiter_beta: Sweby's beta, 1 to 2.
        limit_jump: Slopes are bounded by the pair's own difference too.
    """
    numerics = Numerics(
        scheme=scheme, smoothing_ratio=1.2, riemann=riemann, limiter=limiter,
        limiter_beta=limiter_beta, limit_jump=limit_jump,
    )  # fmt: skip
    scene = Scene("sic_impact", dim=2, spacing=spacing, until=15e-6, snapshots=15, numerics=numerics)
    bar = Box((-LENGTH - spacing, -0.5 * WIDTH), (-spacing, 0.5 * WIDTH))
    tile = Box((0.0, -0.5 * HEIGHT), (THICKNESS, 0.5 * HEIGHT))
    scene.add_body("projectile", bar, "steel-jc", lattice=Cartesian("edges"), velocity=(speed, 0.0))
    target = scene.add_body("target", tile, "sic", lattice=Cartesian("edges"))
    add_damage(scene)
    add_rear(scene, target.x)
    return scene


def add_damage(scene: Scene) -> None:
    """Add what the impact leaves: how much of the tile has failed, and how deep the bar is in it."""

    def failed(state: State) -> np.ndarray:
        return state.of("target") & (state.D >= 1.0)

    def share(state: State) -> float:
        return float(state.m[failed(state)].sum() / state.m[state.of("target")].sum())

    def penetration(state: State) -> float:
        return float(state.x[state.of("projectile"), 0].max())

    scene.add_measure("damaged_mass", lambda state: float(state.m[failed(state)].sum()), "kg/m")
    scene.add_measure("damaged_share", share, "1")
    scene.add_measure("penetration", penetration, "m")


def add_rear(scene: Scene, x: np.ndarray) -> None:
    """Add what the waves do, on the way and at the rear face.

    Args:
        scene: The scene.
        x: Positions of the tile's particles at the start [m], shape [n, 3]; the tile is the last body.
    """
    first = len(scene) - len(x)
    axis = np.abs(x[:, 1]) <= 2.0 * scene.spacing
    rear = first + np.flatnonzero(x[:, 0] >= (1.0 - REAR) * THICKNESS)
    face = first + np.flatnonzero(axis & (x[:, 0] >= x[:, 0].max() - 0.5 * scene.spacing))
    gauge = first + np.flatnonzero(axis & (np.abs(x[:, 0] - GAUGE) <= 0.5 * scene.spacing))
    scene.add_measure("spall_velocity", lambda state: float(state.v[rear, 0].max()), "m/s")
    scene.add_measure("spall_velocity_peak", lambda state: float(state.v[rear, 0].max()), "m/s", peak=True)
    scene.add_measure("rear_velocity", lambda state: float(state.v[face, 0].mean()), "m/s")
    scene.add_measure("gauge_pressure", lambda state: float(state.p[gauge].mean()), "Pa", peak=True)


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
