"""Elastic plate, clamped at one end, vibrates in its first mode (Gray, Monaghan & Swift 2001, section 6)."""

import numpy as np

from warpsph import checks
from warpsph.config import Numerics
from warpsph.materials import Elastic, LinearElastic, Material, moduli
from warpsph.measure import once
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

LENGTH, THICKNESS = 0.2, 0.02
"""Length (x) and thickness (y) of the free part [m]; it is clamped at x = 0."""

DENSITY, YOUNG, POISSON = 1000.0, 2e6, 0.3975
"""Density [kg/m^3], Young's modulus [Pa] and Poisson's ratio."""

MODE = 1.875
"""Wave number times length of the first mode, the lowest root of cos(kL) cosh(kL) = -1, as the paper rounds it."""

CLAMP = 4
"""Columns that are held, a support and more: the outermost ones lack neighbours, and the free part must not see them."""

K, G = moduli(YOUNG, POISSON)
SOLID = Material(
    "soft elastic", DENSITY, LinearElastic(K=K), Elastic(G=G), source="Gray, Monaghan & Swift 2001"
)


def mode(x: np.ndarray) -> np.ndarray:
    """Deflection of the first mode at ``x`` [m], shape [n], over that of the end."""
    return _shape(MODE * x / LENGTH) / _shape(MODE)


def thin_plate_frequency() -> float:
    """Frequency of the first mode in plane strain [Hz], without shear and rotatory inertia: these take off 0.4 %.

    Quadratic finite elements of plane strain give 0.996 of it for small deflections.
    """
    omega2 = YOUNG * THICKNESS**2 * (MODE / LENGTH) ** 4 / (12.0 * DENSITY * (1.0 - POISSON**2))
    return float(np.sqrt(omega2) / (2.0 * np.pi))


def build(
    scheme: str = "tl", particles: int = 10, speed: float = 0.05, periods: float = 3.0, viscosity: float = 0.0
) -> Scene:
    """Build the plate at rest in shape, with the first mode's velocity. The paper's schemes are Eulerian, sav1-as here.

    Args:
        scheme: Scheme; an Eulerian one needs artificial stress, and viscosity for long runs.
        particles: Particles across the thickness.
        speed: Speed of the end at the start over the bulk sound speed.
        periods: How long it runs, in periods of the thin plate.
        viscosity: Linear coefficient of the artificial viscosity; the quadratic one is twice as large.
    """
    if particles < 2:
        raise checks.refuse("particles", particles, "2 or more")
    numerics = Numerics(scheme=scheme, viscosity_alpha=viscosity, viscosity_beta=2.0 * viscosity)
    spacing, until = THICKNESS / particles, checks.positive("periods", periods) / thin_plate_frequency()
    scene = Scene("oscillating_plate", dim=2, spacing=spacing, until=until, numerics=numerics)
    fastest = speed * SOLID.bulk_speed

    def velocity(x: np.ndarray) -> np.ndarray:
        return fastest * np.outer(mode(np.maximum(x[:, 0], 0.0)), (0.0, 1.0))

    shape = Box((-CLAMP * spacing, -0.5 * THICKNESS), (LENGTH, 0.5 * THICKNESS))
    plate = scene.add_body("plate", shape, SOLID, velocity=velocity)
    scene.fix("plate", lambda x: x[:, 0] < 0.0)
    add_vibration(scene, plate.x[:, 0] > LENGTH - spacing)
    return scene


def add_vibration(scene: Scene, end: np.ndarray) -> None:
    """Add the deflection of the end, and what its history says: the rows so far, after a restart those since then.

    Frequency from the changes of sign; amplitude in the last period, and over that in the first.

    Args:
        scene: The scene.
        end: Mask of the particles of the end, shape [n].
    """
    rows: list[tuple[float, float]] = []
    theory = thin_plate_frequency()

    def deflection(state: State) -> float:
        return float(state.x[end, 1].mean())

    @once
    def history(state: State) -> np.ndarray:
        rows[:] = [row for row in rows if row[0] < state.time]
        rows.append((state.time, deflection(state)))
        return np.array(rows).T

    def frequency(state: State) -> float:
        return frequency_of(*history(state))

    def amplitude(state: State) -> float:
        return amplitude_of(*history(state), frequency(state))

    def kept(state: State) -> float:
        times, values = history(state)
        first = (times - times[0]) * frequency(state) <= 1.0
        return amplitude(state) / (amplitude_of(times[first], values[first], frequency(state)) or 1.0)

    scene.add_measure("tip_deflection", deflection, "m")
    scene.add_measure("frequency", frequency, "Hz")
    scene.add_measure("frequency_ratio", lambda state: frequency(state) / theory)
    scene.add_measure("amplitude", amplitude, "m")
    scene.add_measure("amplitude_kept", kept)


def frequency_of(times: np.ndarray, values: np.ndarray) -> float:
    """Mean frequency [Hz] of an oscillation about zero, from its first change of sign to its last; 0 before the second.

    Args:
        times: Times [s], shape [n].
        values: Values, shape [n].
    """
    before = np.flatnonzero((values[:-1] <= 0.0) != (values[1:] <= 0.0))
    share = values[before] / (values[before] - values[before + 1])
    zeros = times[before] + share * (times[before + 1] - times[before])
    return float(0.5 * (len(zeros) - 1) / (zeros[-1] - zeros[0])) if len(zeros) > 1 else 0.0


def amplitude_of(times: np.ndarray, values: np.ndarray, frequency: float) -> float:
    """Amplitude of the sine of a frequency [Hz] that fits the last period best; 0 without a frequency.

    Args:
        times: Times [s], shape [n].
        values: Values, shape [n].
        frequency: Frequency [Hz].
    """
    if frequency == 0.0:
        return 0.0
    last = times >= times[-1] - 1.0 / frequency
    phase = 2.0 * np.pi * frequency * times[last]
    waves = np.stack([np.cos(phase), np.sin(phase)], axis=1)
    return float(np.hypot(*np.linalg.lstsq(waves, values[last], rcond=None)[0]))


def _shape(kx: np.ndarray | float) -> np.ndarray:
    """Deflection of the first mode at a wave number times a length, in no unit."""
    return (np.cos(MODE) + np.cosh(MODE)) * (np.cosh(kx) - np.cos(kx)) + (np.sin(MODE) - np.sinh(MODE)) * (
        np.sinh(kx) - np.sin(kx)
    )


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
