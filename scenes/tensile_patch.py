"""Square under tension in its middle: where Eulerian kernels clump (Young et al., AdapTLE, section 3.1)."""

from functools import partial
from typing import Literal

import numpy as np

from warpsph import materials
from warpsph.config import CouplingName, InterfaceStressName, Numerics
from warpsph.materials import LinearElastic, Material
from warpsph.overlap import close_pairs
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

HALF, PATCH = 0.5, 0.25
"""Half the side of the square, and of the patch under tension [m]."""

SMOOTHING_RATIO, CFL = 1.2, 0.25
"""h over the spacing, and Courant number."""

STEP = CFL * SMOOTHING_RATIO * 0.01 / materials.get("patch").longitudinal_speed
"""The paper's time step, 2.586 ms [s]: that of its 100 particles along a side. Times are counted in it."""

FRAME = 20
"""Steps of the paper from one snapshot to the next: the two of its pictures, 180 and 500, are among them."""

SCHEMES = {"tl": "tl", "eul": "sav1-mixed", "eul-as": "sav1-mixed-as", "coupled": "adaptle-mixed-as"}
"""Scheme of each formulation: all have the mixed correction, as in the paper."""

TENSION = {"impulse": 10.0, "persistent": 0.25}
"""Default tension of each reading [Pa]."""

FAR = 1.5
"""Distance of a nearest neighbour, in spacings, from which on it is not looked for."""


def build(
    formulation: Literal["tl", "eul", "eul-as", "coupled"] = "tl",
    reading: Literal["impulse", "persistent"] = "impulse",
    tension: float | None = None,
    impulse_steps: float = 0.5,
    plane: Literal["strain", "stress"] = "strain",
    coupling: CouplingName = "conservative",
    interface_stress: InterfaceStressName = "both",
    steps: int = 500,
    particles: int = 100,
) -> Scene:
    """Build the square, at rest but for the tension.

    The printed 10 Pa cannot stay in a law with E = 1 Pa: they act in the first evaluation of the forces only. A
    leapfrog scheme uses that one for its first half kick alone, an impulse of half a step; another may for a whole one.
    Half a step fits the printed pressures better. A tension of 0.2 to 0.3 Pa that stays, in plane strain, fits them too
    if they are those of the strain alone.

    Args:
        formulation: Total Lagrangian; Eulerian, plain or with artificial stress; or coupled: the upper half
            Eulerian with artificial stress, the lower Total Lagrangian.
        reading: The tension acts as an impulse, or persists.
        tension: Tension in the patch [Pa]; default 10 for the impulse, 0.25 if it persists.
        impulse_steps: How long it acts as an impulse, in steps of the paper: 0.5 or 1.
        plane: Plane strain or plane stress. The paper does not say; its time step is that of waves in plane strain, and
            its Eulerian pressures fit that. In plane stress a tension that persists thins the sheet at once, until none
            is left across it.
        coupling: Coupling of the halves.
        interface_stress: Where the artificial stress of an Eulerian and a Total Lagrangian particle acts: on both, on
            none, or on the Eulerian one alone, which does not conserve momentum.
        steps: End time in steps of the paper, 2.586 ms each; its pictures are of 180 and 500.
        particles: Particles along a side: a multiple of four, so that patch and halves end between particles.
    """
    numerics = Numerics(
        scheme=SCHEMES[formulation], smoothing_ratio=SMOOTHING_RATIO, cfl=CFL, plane=plane,
        viscosity_alpha=0.2, viscosity_beta=0.4, coupling=coupling, interface_stress=interface_stress,
    )  # fmt: skip
    scene = Scene(
        "tensile_patch", dim=2, spacing=2.0 * HALF / particles, until=steps * STEP,
        snapshots=max(round(steps / FRAME), 1), numerics=numerics,
    )  # fmt: skip
    pull = TENSION[reading] if tension is None else tension
    kick = partial(impulse, tension=impulse_steps * pull, spacing=scene.spacing)
    box, velocity = Box((-HALF, -HALF), (HALF, HALF)), kick if reading == "impulse" else (0.0, 0.0)
    square = scene.add_body("square", box, "patch", velocity=velocity)
    stays = np.zeros(len(square))
    if reading == "persistent":
        stretched = under_tension(materials.get("patch"), pull)
        scene.set_material("square", stretched, central, density=materials.get("patch").density)
        stays = pull * central(square.x)
    if formulation == "coupled":
        scene.make_eulerian("square", lambda x: x[:, 1] > 0.0)
    add_pressures(scene, stays)
    add_faults(scene, np.floor(square.x[:, 1] / scene.spacing).astype(int))
    return scene


def add_pressures(scene: Scene, stays: np.ndarray) -> None:
    """Add the range of pressure, and of the pressure that comes of strain: without the tension that stays [Pa], shape [n]."""
    scene.add_measure("pressure_min", lambda state: float(state.p.min()), "Pa")
    scene.add_measure("pressure_max", lambda state: float(state.p.max()), "Pa")
    scene.add_measure("strain_pressure_min", lambda state: float((state.p + stays).min()), "Pa")
    scene.add_measure("strain_pressure_max", lambda state: float((state.p + stays).max()), "Pa")


def add_faults(scene: Scene, row: np.ndarray) -> None:
    """Add what can go wrong; ``row`` as in `interface_jump`."""
    scene.add_measure("clumping", clumping, "1")
    scene.add_measure("interface_jump", partial(interface_jump, row=row), "Pa")
    scene.add_measure("drift_y", lambda state: float(np.average(state.x[:, 1], weights=state.m)), "m")


def central(x: np.ndarray) -> np.ndarray:
    """Mask of the particles in the patch, shape [n], from positions [m], shape [n, 3]."""
    return (np.abs(x) < PATCH).all(axis=1)


def impulse(x: np.ndarray, tension: float, spacing: float) -> np.ndarray:
    """Velocity [m/s], shape [n, 3], that the tension gives in one step of the paper to particles at rest.

    v_a = dt/rho sum_b V_b (sigma_a + sigma_b) grad_a W_ab with the plain gradient: the same for all formulations.

    Args:
        x: Positions [m], shape [n, 3].
        tension: Tension in the patch [Pa].
        spacing: Particle spacing [m].
    """
    h = SMOOTHING_RATIO * spacing
    i, j = close_pairs(x[:, :2], 2.0 * h)
    apart = x[i] - x[j]
    distance = np.linalg.norm(apart, axis=1)
    stress = tension * central(x)
    pair = spacing**2 * (stress[i] + stress[j]) * kernel_slope(distance, h) / distance
    v = np.zeros_like(x)
    np.add.at(v, i, pair[:, None] * apart)
    np.add.at(v, j, -pair[:, None] * apart)
    return STEP / materials.get("patch").density * v


def kernel_slope(r: np.ndarray, h: float) -> np.ndarray:
    """dW/dr [1/m^3] of the cubic spline in two dimensions, shape [n], at distances up to 2 h."""
    q = r / h
    shape = np.where(q < 1.0, -3.0 * q + 2.25 * q**2, -0.75 * (2.0 - q) ** 2)
    return 10.0 / (7.0 * np.pi * h**3) * shape


def under_tension(material: Material, tension: float) -> Material:
    """Give a linear elastic material that bears a tension [Pa] at the other one's reference density.

    p = K' (rho/rho_r - 1) with rho_r = rho_0 (1 + t/K) and K' = K rho_r/rho_0 is K (rho/rho_0 - 1) - t.
    """
    stretch = 1.0 + tension / material.eos.K
    return Material(
        f"{material.name}-under-tension",
        stretch * material.density,
        LinearElastic(K=stretch * material.eos.K),
        material.strength,
        source=f"{material.source}, its pressure lowered by {tension:g} Pa",
    )


def interface_jump(state: State, row: np.ndarray) -> float:
    """How much more the pressure changes across y = 0 than it does one row further inside [Pa].

    The mean of |p - p'| over neighbours in the two rows beside the interface, less the mean of the same on both sides
    between these and the next rows.

    Args:
        state: The particles.
        row: Row of each particle at the start, shape [n]: 0 is the first above the interface, -1 the first below.
    """
    lower, below, above, upper = (state.p[row == k] for k in (-2, -1, 0, 1))
    inside = 0.5 * (np.abs(upper - above).mean() + np.abs(below - lower).mean())
    return float(np.abs(above - below).mean() - inside)


def clumping(state: State) -> float:
    """Distance to the nearest neighbour, over the spacing, that one particle in twenty falls short of.

    1 for the lattice; half as much where particles pair up. Particles that have flown away count as far apart.
    """
    nearest = np.full(len(state.x), FAR)
    near = np.flatnonzero((np.abs(state.x) < 10.0 * HALF).all(axis=1))
    x = np.asarray(state.x[near, :2], dtype=np.float64)
    if len(x) > 1:
        i, j = close_pairs(x, FAR * state.spacing)
        distance = np.linalg.norm(x[i] - x[j], axis=1) / state.spacing
        np.minimum.at(nearest, near[i], distance)
        np.minimum.at(nearest, near[j], distance)
    return float(np.percentile(nearest, 5.0))


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
