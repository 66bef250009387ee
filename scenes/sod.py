"""Sod's shock tube: a shock, a contact and a rarefaction in an ideal gas, measured against the exact solution."""

from typing import Literal

import numpy as np

from warpsph.config import Numerics
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

GAMMA = 1.4
LEFT, RIGHT = (1.0, 0.0, 1.0), (0.125, 0.0, 0.1)
"""Density [kg/m^3], velocity [m/s] and pressure [Pa] on either side of x = 0 (Sod 1978)."""

WALL = 8
"""Particles at rest that close the tube at either end."""


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
        tube = np.abs(state.x[:, 0]) < 0.5
        values = state.v[tube, 0] if name == "v" else getattr(state, name)[tube]
        return float(np.mean(np.abs(values - exact(state.x[tube, 0] / state.time)[k])) / max(LEFT[k], 1.0))

    return l1


def build(
    scheme: Literal["sav1", "sav2", "bal", "mon", "sav1-mixed"] = "sav1",
    particles: int = 400,
    smoothing_ratio: float = 2.4,
) -> Scene:
    """Build the tube, 1 m long and closed by particles at rest.

    Args:
        scheme: Scheme.
        particles: Particles in the tube.
        smoothing_ratio: h over the spacing. h is constant, and the gas spreads to 2.3 times its initial spacing: below
            about 2 the rarefaction runs out of neighbours and no resolution helps.
    """
    spacing = 1.0 / particles
    scene = Scene(
        "sod", dim=1, spacing=spacing, until=0.2, snapshots=10,
        numerics=Numerics(scheme=scheme, smoothing_ratio=smoothing_ratio),
    )  # fmt: skip
    end = 0.5 + WALL * spacing
    for name, (rho, _, p), low, high in (("left", LEFT, -end, 0.0), ("right", RIGHT, 0.0, end)):
        scene.add_body(name, Box(low, high), "air", density=rho, internal_energy=p / ((GAMMA - 1.0) * rho))
        scene.fix(name, lambda x: np.abs(x[:, 0]) > 0.5)
    for k, field in enumerate(("rho", "v", "p")):
        scene.add_measure(f"l1_{field}", error(field, k))
    return scene


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
