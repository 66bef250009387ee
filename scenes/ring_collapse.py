"""Beryllium ring collapses until plastic work has used up its motion (Howell & Ball; Connolly et al. 2013, section 4.2)."""

from functools import cache, partial
from typing import Literal

import numpy as np

from warpsph.config import LimiterName, Numerics, RiemannName
from warpsph.measure import once
from warpsph.scene import Scene
from warpsph.state import State

INNER, OUTER = 0.08, 0.10
"""Radii of the ring [m]."""

SPEED = 417.1
"""Speed towards the axis at the inner radius [m/s]; v(r) = -SPEED INNER/r leaves the density as it is."""

DENSITY, YIELD = 1845.0, 330e6
"""Density [kg/m^3] and yield stress [Pa] of the beryllium: all that the rigid-plastic solution knows of it."""

UNTIL = 130e-6
"""End time [s], just after the plastic flow has ceased."""

MATERIALS = {"printed": "beryllium-printed", "literature": "beryllium"}
"""Materials by whose shear modulus they have: 15.1 or 151 GPa."""

SPOKES = 46 / 511
"""Rings over particles in a ring, where all rings have the same number: 23,506 are 46 rings of 511."""

INSTANTS = 4000
"""Instants in the table of the exact motion: exact to a few parts in 10^8."""


def work(inner: np.ndarray) -> np.ndarray:
    """Plastic work [J/m] of a rigid-plastic, incompressible ring when its inner radius is ``inner`` [m].

    In plane strain r^2 = R^2 - c, so that a particle's plastic strain is ln(R^2/r^2)/sqrt(3); its sum over the ring,
    with Y, has a closed form: 2 pi R ln R^2 is the derivative of pi (R^2 ln R^2 - R^2).
    """
    c = INNER**2 - inner**2
    before, after = _x_ln_x(OUTER**2) - _x_ln_x(INNER**2), _x_ln_x(OUTER**2 - c) - _x_ln_x(inner**2)
    return np.pi * YIELD / np.sqrt(3.0) * (before - after)


def kinetic_energy() -> float:
    """Kinetic energy at the start [J/m]: the integral of rho/2 v(r)^2 2 pi r over the ring."""
    return np.pi * DENSITY * (SPEED * INNER) ** 2 * np.log(OUTER / INNER)


def outer_radius(inner: np.ndarray) -> np.ndarray:
    """Outer radius [m] that leaves the area as it is."""
    return np.sqrt(inner**2 + OUTER**2 - INNER**2)


def stopping_radius() -> float:
    """Inner radius [m] at which the plastic work is all of the energy."""
    low, high = 1e-6 * INNER, INNER
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if work(middle) > kinetic_energy() else (low, middle)
    return low


@cache
def motion() -> tuple[np.ndarray, np.ndarray]:
    """Exact motion until the ring stops: times [s] and inner radii [m], each of shape [INSTANTS + 1].

    With q = a da/dt the kinetic energy is pi rho q^2 ln(b/a), and it is what plastic work has left; so t is the integral
    of a/|q| da. Near the stop |q| is the root of the distance to it, which the substitution a = stop + s^2 takes away.
    """
    stop = stopping_radius()
    width = np.sqrt(INNER - stop) / INSTANTS
    s = width * (np.arange(INSTANTS) + 0.5)
    a = stop + s**2
    q = np.sqrt((kinetic_energy() - work(a)) / (np.pi * DENSITY * np.log(outer_radius(a) / a)))
    until_stop = np.append(0.0, np.cumsum(a / q * 2.0 * s * width))
    radii = stop + (width * np.arange(INSTANTS + 1)) ** 2
    return (until_stop[-1] - until_stop)[::-1], radii[::-1]


def exact(time: float) -> tuple[float, float]:
    """Inner and outer radius [m] at a time [s]; after the stop those of the stop."""
    inner = float(np.interp(time, *motion()))
    return inner, float(outer_radius(inner))


def build(
    scheme: str = "ts2-mixed",
    particles: int = 8172,
    lattice: Literal["rings", "spokes"] = "rings",
    shear_modulus: Literal["printed", "literature"] = "printed",
    riemann: RiemannName = "two-shock",
    limiter: LimiterName = "minmod",
    limiter_beta: float = 1.5,
    limit_jump: bool = False,
) -> Scene:
    """Build the ring in motion. The paper's finer set is 23506 particles as spokes.

    Args:
        scheme: Scheme; the paper's are av, ts1 and ts2. The correction keeps the surfaces, where plain gradients fail.
        particles: Number of particles, about: as many as full rings have.
        lattice: Rings with as many particles as fit, a spacing apart; or spokes, with the same number in every ring,
            every other ring turned by half a particle.
        shear_modulus: As the paper prints it, 15.1 GPa, or the literature's, 151 GPa.
        riemann: Riemann solver of the Godunov schemes.
        limiter: Slope limiter of the second-order ones.
        limiter_beta: Sweby's beta, 1 to 2.
        limit_jump: Slopes are bounded by the pair's own difference too.
    """
    numerics = Numerics(
        scheme=scheme, smoothing_ratio=1.2, riemann=riemann, limiter=limiter,
        limiter_beta=limiter_beta, limit_jump=limit_jump,
    )  # fmt: skip
    counts = ring_sizes(particles, lattice)
    spacing = float(np.sqrt(np.pi * (OUTER**2 - INNER**2) / counts.sum()))
    scene = Scene("ring_collapse", dim=2, spacing=spacing, until=UNTIL, snapshots=13, numerics=numerics)
    x, volume = circles(counts, 0.5 if lattice == "spokes" else 0.0)
    scene.add_body("ring", x, MATERIALS[shear_modulus], velocity=converging, volume=volume)
    add_radii(scene, counts)
    add_symmetry(scene, counts)
    return scene


def ring_sizes(particles: int, lattice: str) -> np.ndarray:
    """Number of particles in each ring, from the inside out, shape [rings]."""
    circumference = np.pi * (OUTER + INNER)  # of the mean ring
    if lattice == "spokes":
        rings = max(round((particles * SPOKES) ** 0.5), 3)
        return np.full(rings, round(rings / SPOKES))
    rings = max(round((particles * (OUTER - INNER) / circumference) ** 0.5), 3)
    return np.round(2.0 * np.pi * middles(rings) * rings / (OUTER - INNER)).astype(int)


def middles(rings: int) -> np.ndarray:
    """Radii [m] of rings in the middles of equal shares of the wall, shape [rings]."""
    return INNER + (OUTER - INNER) / rings * (np.arange(rings) + 0.5)


def circles(counts: np.ndarray, turn: float) -> tuple[np.ndarray, np.ndarray]:
    """Particles ring by ring, the innermost first: positions [m], shape [n, 2], and volumes [m^2], shape [n].

    Args:
        counts: Number of particles in each ring.
        turn: Share of a particle's angle that every other ring is turned by.
    """
    radii = middles(len(counts))
    number = np.concatenate([np.arange(k) + turn * (ring % 2) for ring, k in enumerate(counts)])
    angle = 2.0 * np.pi * number / np.repeat(counts, counts)
    x = np.repeat(radii, counts)[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    area = 2.0 * np.pi * radii * (OUTER - INNER) / len(counts)
    return x, np.repeat(area / counts, counts)


def converging(x: np.ndarray) -> np.ndarray:
    """Velocity at the start [m/s], shape [n, 3]: no change of area (Connolly et al. 2013, Eq. 38)."""
    return -SPEED * INNER * x / (x**2).sum(axis=1, keepdims=True)


def add_radii(scene: Scene, counts: np.ndarray) -> None:
    """Add the radii of both surfaces, half a spacing beyond the particles, and how far they ever are from the exact ones."""
    mean = once(lambda state: ring_means(radius(state), counts))

    def inner(state: State) -> float:
        first, second = mean(state)[:2]
        return float(first - 0.5 * (second - first))

    def outer(state: State) -> float:
        last, before = mean(state)[:-3:-1]
        return float(last + 0.5 * (last - before))

    def deviation(state: State, surface: int) -> float:
        return abs((inner, outer)[surface](state) / exact(state.time)[surface] - 1.0)

    for k, (name, function) in enumerate((("inner", inner), ("outer", outer))):
        scene.add_measure(f"{name}_radius", function, "m")
        scene.add_measure(f"{name}_deviation", partial(deviation, surface=k), "1", peak=True)


def add_symmetry(scene: Scene, counts: np.ndarray) -> None:
    """Add how far the particles of an initial ring spread, in radius and along the circumference."""
    angles = np.arctan2(scene.bodies["ring"].x[:, 1], scene.bodies["ring"].x[:, 0])
    spread = once(lambda state: ring_deviations(radius(state), counts))

    def shift(state: State) -> float:
        r = radius(state)
        turned = np.arctan2(state.x[:, 1], state.x[:, 0]) - angles
        return float(ring_deviations(r * ((turned + np.pi) % (2.0 * np.pi) - np.pi), counts).max())

    scene.add_measure("inner_spread", lambda state: float(spread(state)[0]), "m")
    scene.add_measure("outer_spread", lambda state: float(spread(state)[-1]), "m")
    scene.add_measure("ring_spread_max", lambda state: float(spread(state).max()), "m")
    scene.add_measure("ring_shift_max", shift, "m")


def radius(state: State) -> np.ndarray:
    """Distance of every particle from the axis [m], shape [n]."""
    return np.linalg.norm(np.asarray(state.x, dtype=np.float64), axis=1)


def ring_means(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Mean of every initial ring, shape [rings], of values in the order of `circles`, shape [n]."""
    return np.add.reduceat(values, np.cumsum(counts) - counts) / counts


def ring_deviations(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Standard deviation within every initial ring, shape [rings], of values in the order of `circles`, shape [n]."""
    difference = values - np.repeat(ring_means(values, counts), counts)
    return np.sqrt(ring_means(difference**2, counts))


def _x_ln_x(x: np.ndarray) -> np.ndarray:
    return x * np.log(x)


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
