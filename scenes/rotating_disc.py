"""Elastic disc spins freely: stress and widening against the exact ones, angular momentum against its start."""

import numpy as np

from warpsph import checks
from warpsph.config import Numerics
from warpsph.lattices import Rings
from warpsph.materials import Elastic, LinearElastic, Material
from warpsph.scene import Scene, spin
from warpsph.shapes import Disc
from warpsph.state import State

RADIUS = 0.04
"""Radius of the disc [m]."""

DENSITY, K = 1000.0, 1e9
"""Density [kg/m^3] and bulk modulus [Pa]: a bulk sound speed of 1000 m/s."""

POISSON = 0.3
"""Poisson's ratio."""

G = 1.5 * K * (1.0 - 2.0 * POISSON) / (1.0 + POISSON)
SOLID = Material("elastic", DENSITY, LinearElastic(K=K), Elastic(G=G), source="made up: Poisson's ratio 0.3")


def exact_stress(r: np.ndarray, rate: float) -> np.ndarray:
    """Radial, hoop and axial stress [Pa] at rest in the turning frame, shape [3, n].

    Timoshenko & Goodier, Theory of Elasticity, rotating disc, in plane strain: nu/(1 - nu) in place of nu.

    Args:
        r: Distance from the axis [m], shape [n].
        rate: Angular velocity [rad/s].
    """
    factor = DENSITY * rate**2 / (8.0 * (1.0 - POISSON))
    radial = factor * (3.0 - 2.0 * POISSON) * (RADIUS**2 - r**2)
    hoop = factor * ((3.0 - 2.0 * POISSON) * RADIUS**2 - (1.0 + 2.0 * POISSON) * r**2)
    return np.stack((radial, hoop, POISSON * (radial + hoop)))


def exact_growth(rate: float) -> float:
    """Growth of the radius over the radius that goes with `exact_stress`: the hoop strain of the rim.

    Args:
        rate: Angular velocity [rad/s].
    """
    return DENSITY * (rate * RADIUS) ** 2 * (1.0 - 2.0 * POISSON) / (8.0 * G)


def build(
    scheme: str = "tl", spacing: float = 2e-3, speed: float = 0.05, turns: float = 1.0, viscosity: float = 4.0
) -> Scene:
    """Build the disc round and free of stress, in rigid rotation: it springs outwards until viscosity has stilled that.

    Args:
        scheme: Scheme; with plain gradients every one makes stress of a rotation and loses angular momentum.
        spacing: Particle spacing [m].
        speed: Speed of the rim over the bulk sound speed: strains of its square are left out of the exact solution.
        turns: How long it runs, in revolutions.
        viscosity: Linear coefficient of the artificial viscosity: it stills the more, the coarser the spacing.
    """
    rate = checks.positive("speed", speed) * SOLID.bulk_speed / RADIUS
    until = checks.positive("turns", turns) * 2.0 * np.pi / rate
    numerics = Numerics(scheme=scheme, viscosity_alpha=viscosity)
    scene = Scene("rotating_disc", dim=2, spacing=spacing, until=until, numerics=numerics)
    disc = scene.add_body("disc", Disc(RADIUS), SOLID, lattice=Rings(), velocity=spin(rate))
    add_rotation(scene, disc.x, disc.v)
    add_stress(scene, np.linalg.norm(disc.x, axis=1), rate)
    return scene


def add_rotation(scene: Scene, x: np.ndarray, v: np.ndarray) -> None:
    """Add what a rigid rotation keeps: angular momentum, radius and shape.

    The shape is told by the ratio of the principal second moments of the particles, as that of an ellipse's axes.

    Args:
        scene: The scene.
        x: Positions at the start [m], shape [n, 3].
        v: Velocities at the start [m/s], shape [n, 3].
    """
    start = np.cross(x, v)[:, 2].sum()
    radius = np.linalg.norm(x, axis=1)
    rim = radius > radius.max() - 0.5 * scene.spacing

    def angular_momentum(state: State) -> float:
        return float(np.cross(state.x, state.v)[:, 2].sum() / start - 1.0)

    def growth(state: State) -> float:
        return float((np.linalg.norm(state.x[rim], axis=1) / radius[rim]).mean() - 1.0)

    def axes(state: State) -> float:
        small, large = np.linalg.eigvalsh(np.cov(state.x[:, :2].T))
        return float(np.sqrt(small / large))

    scene.add_measure("angular_momentum_change", angular_momentum)
    scene.add_measure("radius_growth", growth)
    scene.add_measure("axes_ratio", axes)


def add_stress(scene: Scene, radius: np.ndarray, rate: float) -> None:
    """Add the mean errors of the stresses and the largest von Mises stress, all over the largest exact ones.

    Args:
        scene: The scene.
        radius: Distance of the particles from the axis at the start [m], shape [n].
        rate: Angular velocity [rad/s].
    """
    stress = exact_stress(radius, rate)
    pressure = -stress.mean(axis=0)
    mises = np.sqrt(1.5) * np.linalg.norm(stress + pressure, axis=0)

    def pressure_error(state: State) -> float:
        return float(np.abs(state.p - pressure).mean() / np.abs(pressure).max())

    def mises_error(state: State) -> float:
        return float(np.abs(von_mises(state) - mises).mean() / mises.max())

    def highest(state: State) -> float:
        return float(von_mises(state).max() / mises.max())

    scene.add_measure("pressure_error", pressure_error)
    scene.add_measure("von_mises_error", mises_error)
    scene.add_measure("von_mises_max", highest)
    scene.add_measure("von_mises_peak", highest, peak=True)


def von_mises(state: State) -> np.ndarray:
    """Von Mises stress [Pa], shape [n]."""
    return np.sqrt(1.5) * np.linalg.norm(state.tau, axis=(1, 2))


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
