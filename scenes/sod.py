"""Sod's shock tube: a shock, a contact and a rarefaction in an ideal gas, measured against the exact solution."""

from typing import Literal

import numpy as np

from warpsph.config import LimiterName, Numerics, RiemannName
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

GAMMA = 1.4
LEFT, RIGHT = (1.0, 0.0, 1.0), (0.125, 0.0, 0.1)
"""Density [kg/m^3], velocity [m/s] and pressure [Pa] on either side of x = 0 (Sod 1978)."""

WALL = 8
"""Particles at rest that close the tube at either end; in 2D also rows that slide along the outside of the strip."""

ROWS = 16
"""Rows of particles in the strip that stands for the tube in 2D, from the plane of symmetry outwards."""


def exact(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Density, velocity and pressure at x/t = ``xi`` [m/s], each of its shape (Toro 2009, chapter 4)."""
    (rho_l, _, p_l), (rho_r, _, p_r) = LEFT, RIGHT
    c_l = np.sqrt(GAMMA * p_l / rho_l)
    g = (GAMMA - 1.0) / (GAMMA + 1.0)
    low, high = p_r, p_l
    for _ in range(100):
        p = 0.5 * (low + high)
        u_left = 2.0 * c_l / (GAMMA - 1.0) * (1.0 - (p / p_l) ** ((GAMMA - 1.0) / (2.0 * GAMMA)))
        u_right = (p - p_r) * np.sqrt(2.0 / ((GAMMA + 1.0) * rho_r) / (p + g * p_r))
        low, high = (p, high) if u_left > u_right else (low, p)
    u, c_star = u_left, c_l * (p / p_l) ** ((GAMMA - 1.0) / (2.0 * GAMMA))
    shock = np.sqrt(GAMMA * p_r / rho_r) * np.sqrt(
        (GAMMA + 1.0) / (2.0 * GAMMA) * p / p_r + (GAMMA - 1.0) / (2.0 * GAMMA)
    )
    c_fan = np.maximum(2.0 / (GAMMA + 1.0) * c_l - g * xi, 0.0)  # negative far outside of the fan
    fan = (
        rho_l * (c_fan / c_l) ** (2.0 / (GAMMA - 1.0)),
        2.0 / (GAMMA + 1.0) * (c_l + xi),
        p_l * (c_fan / c_l) ** (2.0 * GAMMA / (GAMMA - 1.0)),
    )
    where = [xi < -c_l, xi < u - c_star, xi < u, xi < shock]
    star_l = (rho_l * (p / p_l) ** (1.0 / GAMMA), u, p)
    star_r = (rho_r * (p / p_r + g) / (g * p / p_r + 1.0), u, p)
    return tuple(np.select(where, [LEFT[k], fan[k], star_l[k], star_r[k]], RIGHT[k]) for k in range(3))


def error(name: str, k: int):
    """Make the measure of one field: mean absolute error in the tube over the larger of both initial values."""

    def l1(state: State) -> float:
        if state.time == 0.0:
            return 0.0
        tube = (np.abs(state.x[:, 0]) < 0.5) & (state.x[:, 1] < 0.5 * ROWS * state.spacing)
        values = state.v[tube, 0] if name == "v" else getattr(state, name)[tube]
        return float(np.mean(np.abs(values - exact(state.x[tube, 0] / state.time)[k])) / max(LEFT[k], 1.0))

    return l1


def build(
    scheme: str = "sav1",
    particles: int = 400,
    dim: Literal[1, 2] = 1,
    smoothing_ratio: float = 2.4,
    riemann: RiemannName = "two-shock",
    limiter: LimiterName = "superbee",
    limit_jump: bool = False,
) -> Scene:
    """Build the tube, 1 m long and closed by particles at rest.

    In 2D it is a strip over a plane of symmetry. Outside, where there can be no second plane, slide rows of particles
    that keep their y; the errors are taken over the inner half of the other rows.

    Args:
        scheme: Scheme.
        particles: Particles along the tube.
        dim: Dimension of the problem.
        smoothing_ratio: h over the spacing. h is constant, and the gas spreads to 2.3 times its initial spacing: below
            about 2 the rarefaction runs out of neighbours and no resolution helps.
        riemann: Riemann solver of the Godunov schemes.
        limiter: Slope limiter of the second-order ones.
        limit_jump: Bound slopes by the pair's own difference too.
    """
    spacing = 1.0 / particles
    numerics = Numerics(
        scheme=scheme,
        smoothing_ratio=smoothing_ratio,
        riemann=riemann,
        limiter=limiter,
        limit_jump=limit_jump,
    )
    scene = Scene("sod", dim=dim, spacing=spacing, until=0.2, snapshots=10, numerics=numerics)
    end, top = 0.5 + WALL * spacing, (ROWS + WALL) * spacing
    for name, (rho, _, p), low, high in (("left", LEFT, -end, 0.0), ("right", RIGHT, 0.0, end)):
        tube = Box(low, high) if dim == 1 else Box((low, 0.0), (high, top))
        scene.add_body(name, tube, "air", density=rho, internal_energy=p / ((GAMMA - 1.0) * rho))
        scene.fix(name, lambda x: np.abs(x[:, 0]) > 0.5)
        if dim == 2:
            scene.fix(name, lambda x: x[:, 1] > ROWS * spacing, components="y")
    if dim == 2:
        scene.add_symmetry_plane("y")
    for k, field in enumerate(("rho", "v", "p")):
        scene.add_measure(f"l1_{field}", error(field, k))
    return scene


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
