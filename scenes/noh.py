"""Noh's implosion: a cold gas runs into a wall (1D) or onto an axis (2D), against the exact solution (Noh 1987)."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from warpsph import checks
from warpsph.config import LimiterName, Numerics, RiemannName
from warpsph.lattices import Cartesian
from warpsph.materials import Fluid, IdealGas, Material
from warpsph.measure import once
from warpsph.scene import Scene
from warpsph.shapes import Box, Disc
from warpsph.state import State

GAMMA = 5.0 / 3.0
GAS = Material(
    "monatomic gas", 1.0, IdealGas(gamma=GAMMA), Fluid(), source="ideal gas without inner degrees of freedom"
)

COLD = 1e-6
"""Specific internal energy at the start [J/kg], of 0.5 J/kg behind the shock."""

UNTIL = 0.6
"""When the fields are compared [s]: the shock is at 0.2 m, and the edge of the gas, 1 m away at first, at 0.4 m."""

INSIDE = 0.3
"""How far from the origin they are compared [m]: what lies beyond may know of the edge."""

FIELDS: dict[str, Callable[[State], np.ndarray]] = {
    "rho": lambda state: state.rho,
    "v": lambda state: -inward(state),
    "p": lambda state: state.p,
}
"""The fields that are compared, of a picture of all particles, shape [n]."""


def exact(r: np.ndarray, time: float, dim: int) -> dict[str, np.ndarray]:
    """Exact fields of a gas of density 1 kg/m^3 that comes in at 1 m/s; the shock runs outwards at (γ - 1)/2 m/s.

    Args:
        r: Distance from the wall or the axis [m], shape [n], positive.
        time: Time [s].
        dim: 1 for the wall, 2 for the axis.

    Returns:
        Density, outward velocity and pressure in SI units, each of shape [n], by the keys of `FIELDS`.
    """
    behind = r < shock_speed() * time
    peak = density_behind(dim)
    return {
        "rho": np.where(behind, peak, (1.0 + time / r) ** (dim - 1)),
        "v": np.where(behind, 0.0, -1.0),
        "p": np.where(behind, peak * shock_speed(), 0.0),
    }


def shock_speed() -> float:
    """Speed of the shock [m/s]."""
    return 0.5 * (GAMMA - 1.0)


def density_behind(dim: int) -> float:
    """Density behind the shock [kg/m^3]: what the flow has focused, times the compression of a strong shock."""
    return ((GAMMA + 1.0) / (GAMMA - 1.0)) ** dim


def radius(state: State) -> np.ndarray:
    """Distance of the particles from the wall or the axis [m], shape [n]."""
    return np.linalg.norm(state.x, axis=1)


def inward(state: State) -> np.ndarray:
    """Velocity of the particles towards the wall or the axis [m/s], shape [n]."""
    return -np.einsum("ik,ik->i", state.v, state.x) / radius(state)


def build(
    scheme: str = "ts2",
    particles: int = 100,
    dim: Literal[1, 2] = 1,
    riemann: RiemannName = "two-shock",
    limiter: LimiterName = "superbee",
    limit_jump: bool = False,
) -> Scene:
    """Build the gas within 1 m of the origin, with planes of symmetry in place of the wall, or of the other quadrants.

    Args:
        scheme: Scheme.
        particles: Particles along an axis.
        dim: Dimension: 1 for the wall, 2 for the axis.
        riemann: Riemann solver of the Godunov schemes; the acoustic one does not feel a shock in a gas without
            temperature, whose impedance is zero.
        limiter: Slope limiter of the second-order ones.
        limit_jump: Bound slopes by the pair's own difference too.
    """
    if particles < 10:
        raise checks.refuse("particles", particles, "10 or more")
    numerics = Numerics(scheme=scheme, riemann=riemann, limiter=limiter, limit_jump=limit_jump)
    scene = Scene("noh", dim=dim, spacing=1.0 / particles, until=UNTIL, snapshots=12, numerics=numerics)
    shape = Box(0.0, 1.0) if dim == 1 else Disc(1.0) & Box((0.0, 0.0), (1.0, 1.0))
    scene.add_body(
        "gas", shape, GAS, lattice=Cartesian("halves"), internal_energy=COLD,
        velocity=lambda x: -x / np.linalg.norm(x, axis=1, keepdims=True),
    )  # fmt: skip
    for axis in "xy"[:dim]:
        scene.add_symmetry_plane(axis)
    add_measures(scene)
    return scene


def add_measures(scene: Scene) -> None:
    """Add errors over the values behind the shock, the first particle's lack of density, a plateau and the front.

    The plateau is the median density half way between origin and exact shock, over half that distance.
    """
    peak = density_behind(scene.dim)
    scale = {"rho": peak, "v": 1.0, "p": peak * shock_speed()}
    compared = once(lambda state: exact(radius(state), state.time, scene.dim))

    def error(name: str) -> Callable[[State], float]:
        def l1(state: State) -> float:
            inside = radius(state) < INSIDE
            difference = FIELDS[name](state) - compared(state)[name]
            return float(np.abs(difference[inside]).mean() / scale[name])

        return l1

    def wall_deficit(state: State) -> float:
        return float(1.0 - state.rho[np.argmin(radius(state))] / peak)

    def plateau(state: State) -> float:
        within = np.abs(radius(state) / (shock_speed() * max(state.time, 1e-300)) - 0.5) < 0.25
        return float(np.median(state.rho[within])) if within.any() else 0.0

    def shock(state: State) -> float:
        """Radius of as many particles as have lost half their speed, whichever these are."""
        stopped = int((inward(state) < 0.5).sum())
        return float(np.sort(radius(state))[max(stopped - 1, 0)])

    for name in FIELDS:
        scene.add_measure(f"l1_{name}", error(name))
    scene.add_measure("wall_deficit", wall_deficit)
    scene.add_measure("plateau_density", plateau, "kg/m^3")
    scene.add_measure("shock_position", shock, "m")


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
