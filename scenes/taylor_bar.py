"""Copper bar hits a rigid wall at 190 m/s: Taylor's test with the constants of Johnson & Cook 1983."""

import numpy as np

from warpsph.config import Conversion, Numerics
from warpsph.lattices import Cartesian
from warpsph.measure import once
from warpsph.scene import Scene
from warpsph.schemes import SCHEMES, GodunovSettings
from warpsph.shapes import Box, Cylinder
from warpsph.state import State

LENGTH, DIAMETER = 25.4e-3, 7.62e-3
"""Length L0 and diameter D0 of the bar [m]."""

GAUGE = 0.2
"""Distance from the wall, over L0, at which a second diameter is taken."""

UNTIL = 80e-6
"""End time [s]: the bar has been at rest for some 15 µs."""

SMOOTHING_RATIO = 1.2
"""h over the spacing."""


def build(
    scheme: str = "tl",
    spacing: float = 3.175e-4,
    speed: float = 190.0,
    quarter: bool = True,
    conversion_strain: float = 0.85,
    viscosity: float = 0.2,
) -> Scene:
    """Build the bar with its foot on the wall, the plane z = 0, along whose normal it moves.

    The wall is a symmetry plane: without friction, and it holds the bar back too. That matters only after the bar has
    come to rest, when its elastic rebound, a few metres per second, would part them.

    Args:
        scheme: Any scheme; of the adaptle ones, particles convert at the strain given below.
        spacing: Particle spacing [m]; the next that divides the length. A multiple of 3 across the diameter fits both.
        speed: Speed of the bar [m/s].
        quarter: Only the quarter x, y > 0 between symmetry planes.
        conversion_strain: Equivalent strain beyond which a particle becomes Eulerian.
        viscosity: α of the artificial viscosity, β is twice as much; the Godunov schemes have none. There is no strong
            shock here, and α = 1 makes a coarse bar some 6 % too long.
    """
    layers = max(round(LENGTH / spacing), 2)
    conversion = Conversion(strain=conversion_strain) if scheme.startswith("adaptle") else None
    viscous = not isinstance(SCHEMES.get(scheme), GodunovSettings)
    numerics = Numerics(
        scheme=scheme, smoothing_ratio=SMOOTHING_RATIO, conversion=conversion,
        viscosity_alpha=viscosity if viscous else None, viscosity_beta=2.0 * viscosity if viscous else None,
    )  # fmt: skip
    scene = Scene("taylor_bar", dim=3, spacing=LENGTH / layers, until=UNTIL, snapshots=16, numerics=numerics)
    radius = 0.5 * DIAMETER
    shape = Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, LENGTH), radius)
    if quarter:
        shape = shape & Box((0.0, 0.0, 0.0), (radius, radius, LENGTH))
        scene.add_symmetry_plane("x")
        scene.add_symmetry_plane("y")
    scene.add_symmetry_plane("z")
    bar = scene.add_body("bar", shape, "copper", lattice=Cartesian("halves"), velocity=(0.0, 0.0, -speed))
    add_lengths(scene, bar.x)
    return scene


def add_lengths(scene: Scene, x: np.ndarray) -> None:
    """Add length and diameters, of surfaces: half a spacing beyond the last particles, as far apart as these now are.

    Args:
        scene: The scene, with the bar alone.
        x: Positions of the bar's particles at the start [m], shape [n, 3].
    """
    row = rows(x, scene.spacing)
    layer = np.floor(x[:, 2] / scene.spacing).astype(int)
    last, before = (np.flatnonzero(layer == layer.max() - k) for k in (0, 1))
    outline = once(lambda state: profile(state.x, row))

    def length(state: State) -> float:
        return float(beyond(state.x[last, 2].mean(), state.x[before, 2].mean()))

    def gauge(state: State) -> float:
        z, diameter = outline(state)
        return float(np.interp(GAUGE * LENGTH, z, diameter))

    scene.add_measure("final_length", length, "m")
    scene.add_measure("foot_diameter", lambda state: float(outline(state)[1].max()), "m")
    scene.add_measure("diameter_02", gauge, "m")


def rows(x: np.ndarray, spacing: float) -> np.ndarray:
    """Rows of particles from the axis to the side of the bar.

    Args:
        x: Positions at the start [m], shape [n, 3].
        spacing: Particle spacing [m].

    Returns:
        Particle numbers from the axis outwards, shape [layers, 2, k]: in each layer, from the wall upwards, one row
        along x and one along y.
    """
    cell = np.floor(x / spacing).astype(int)
    found = []
    for along, beside in ((0, 1), (1, 0)):
        row = np.flatnonzero((cell[:, along] >= 0) & (cell[:, beside] == 0))
        row = row[np.lexsort((cell[row, along], cell[row, 2]))]
        found.append(row.reshape(cell[:, 2].max() + 1, -1))
    return np.stack(found, axis=1)


def profile(x: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Outline of the bar: heights of the last particles of the rows and diameters there [m], in order of height.

    Args:
        x: Positions [m], shape [n, 3].
        row: The rows, see `rows`.
    """
    outer, inner = x[row[:, :, -1]], x[row[:, :, -2]]
    radius = [beyond(outer[:, k, k], inner[:, k, k]) for k in (0, 1)]
    z, diameter = outer[:, :, 2].mean(axis=1), radius[0] + radius[1]
    order = np.argsort(z)
    return z[order], diameter[order]


def beyond(last: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Coordinate [m] half a spacing beyond the last of a row, by the spacing from the one before it."""
    return last + 0.5 * (last - before)


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
