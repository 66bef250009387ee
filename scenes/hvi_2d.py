"""Aluminium disc hits aluminium plate at 3.1 km/s in two dimensions (Young et al., AdapTLE, section 3.2)."""

from functools import partial
from typing import Literal

import numpy as np

from warpsph.config import Contact, Conversion, CouplingName, LimiterName, Numerics, RiemannName
from warpsph.lattices import CoreAndRings, Rings
from warpsph.measure import extent, groups, once, widest_gap
from warpsph.scene import Scene
from warpsph.shapes import Box, Disc
from warpsph.state import State

RADIUS, THICKNESS, HEIGHT = 5e-3, 2e-3, 50.1e-3
"""Disc radius, plate thickness and plate height [m]."""

SMOOTHING_RATIO = 1.4
"""h over the spacing."""

SCHEMES = {"sav1-contact": "sav1-as", "adaptle": "adaptle-as"}
"""Schemes that the paper combines with contact: theirs by the name here. Others are called what they are."""

CONTACT_STIFFNESS = 2e18 * 1e-4**2 / 79.06e9
"""k = Kc dx^2/K of the paper, 0.253: its Kc of 2e12 is read as Pa/mm^2, for in Pa/m^2 it would bear nothing."""

CONVERSION_STRAIN = 0.85
"""Equivalent strain from which on the paper's particles are Eulerian."""

INSIDE = 0.8
"""Share of the radius within which tension is looked for: single particles torn off the rim are no measure of it."""


def build(
    scheme: str = "sav1",
    spacing: float = 1e-4,
    speed: float = 3100.0,
    lattice: Literal["core-and-rings", "rings"] | None = None,
    plane: Literal["strain", "stress"] = "strain",
    contact_stiffness: float = CONTACT_STIFFNESS,
    conversion_strain: float = CONVERSION_STRAIN,
    coupling: CouplingName = "conservative",
    riemann: RiemannName = "acoustic",
    limiter: LimiterName = "minmod",
) -> Scene:
    """Build disc and plate, so far apart that their supports are about to overlap: t = 0 of the measures.

    Args:
        scheme: Viscosity sav1, sav2, av, bal or mon (-as adds artificial stress, -mixed the correction, -mixed-as
            both), or a Godunov scheme, con, ts1 or ts2: disc and plate are as one body. With contact between them:
            sav1-contact, which is sav1-as, and adaptle, where particles are Total Lagrangian until they convert.
        spacing: Particle spacing [m]; the paper's is 1e-4.
        speed: Speed of the disc [m/s].
        lattice: Arrangement of the disc's particles: 7830 or, as concentric rings, 8012 at the paper's spacing;
            default rings with adaptle, else core-and-rings.
        plane: Plane strain or plane stress.
        contact_stiffness: Stiffness k of the contact of sav1-contact and adaptle; the paper's is 0.253.
        conversion_strain: Equivalent strain from which on particles of adaptle are Eulerian.
        coupling: Coupling of Eulerian and Total Lagrangian particles of adaptle.
        riemann: Riemann solver of the Godunov schemes.
        limiter: Slope limiter of ts2.
    """
    adaptive = scheme.startswith("adaptle")
    numerics = Numerics(
        scheme=SCHEMES.get(scheme, scheme), smoothing_ratio=SMOOTHING_RATIO, plane=plane,
        contact=Contact(stiffness=contact_stiffness) if adaptive or scheme in SCHEMES else None,
        conversion=Conversion(strain=conversion_strain) if adaptive else None,
        coupling=coupling, inverted="convert" if adaptive else "stop", riemann=riemann, limiter=limiter,
    )  # fmt: skip
    scene = Scene("hvi_2d", dim=2, spacing=spacing, until=8e-6, snapshots=20, numerics=numerics)
    gap = 2.0 * SMOOTHING_RATIO * spacing - 0.5 * spacing
    centre = (-RADIUS - gap, 0.0)
    pattern = lattice or ("rings" if adaptive else "core-and-rings")
    filling = CoreAndRings() if pattern == "core-and-rings" else Rings("edges")
    disc = scene.add_body(
        "projectile", Disc(RADIUS, centre), "aluminium", lattice=filling, velocity=(speed, 0.0)
    )
    scene.add_body("plate", Box((0.0, -0.5 * HEIGHT), (THICKNESS, 0.5 * HEIGHT)), "aluminium")
    add_pressures(scene, np.linalg.norm(disc.x[:, :2] - centre, axis=1))
    add_lengths(scene, disc.x[:, 0] < centre[0])
    scene.add_measure("projectile_lagrangian", lagrangian, "1")
    return scene


def add_pressures(scene: Scene, distance: np.ndarray) -> None:
    """Add what the disc has seen: extremes at its centre, the peak of an average beside it, and the tension inside.

    Args:
        scene: The scene.
        distance: Distance of the disc's particles from its centre at the start [m]; the disc is the first body.
    """
    nearest = int(np.argmin(distance))
    beside = np.flatnonzero(distance <= 3.0 * scene.spacing * (1.0 + 1e-9))
    scene.add_measure("peak_pressure", lambda state: float(state.p_high[nearest]), "Pa")
    scene.add_measure("peak_pressure_mean", lambda state: float(state.p[beside].mean()), "Pa", peak=True)
    scene.add_measure("peak_tension", lambda state: float(0.0 - state.p_low[nearest]), "Pa")
    inside = np.flatnonzero(distance <= INSIDE * RADIUS)
    scene.add_measure("projectile_tension", lambda state: float(0.0 - state.p_low[inside].min()), "Pa")
    scene.add_measure("tension_time", partial(record_time, particles=inside), "s", peak=True)


def record_time(state: State, particles: np.ndarray) -> float:
    """Time [s] if the highest tension that any of the particles has ever been under is there now, else 0.

    The latest such time is when the tension peaked, to one row of the history.
    """
    pressure = state.p[particles].min()
    return state.time if pressure < 0.0 and pressure <= state.p_low[particles].min() else 0.0


def add_lengths(scene: Scene, rear: np.ndarray) -> None:
    """Add lengths, all between the centres of particles; x = 0 is the face of the plate that is hit.

    Args:
        scene: The scene.
        rear: Which of the disc's particles start in its rear half, shape [particles of the disc].
    """
    bulk = once(largest_piece)
    axis = max(0.1 * RADIUS, scene.spacing)

    def extension(state: State) -> float:
        return extent(state.x[bulk(state) & (np.abs(state.x[:, 1]) <= axis), 0])

    def span(state: State) -> float:
        return extent(state.x[bulk(state), 0])

    def loose(state: State) -> np.ndarray:
        return ~bulk(state)[state.of("projectile")]

    def travel(state: State) -> float:
        return float(state.x[bulk(state), 0].max(initial=-np.inf))

    scene.add_measure("crater_diameter", crater, "m")
    scene.add_measure("cavity_diameter", cavity, "m")
    scene.add_measure("projectile_extension", extension, "m")
    scene.add_measure("projectile_span", span, "m")
    scene.add_measure("projectile_spalled", lambda state: float(loose(state).sum()), "1")
    scene.add_measure("back_spalled", lambda state: float((loose(state) & rear).sum()), "1")
    scene.add_measure("projectile_travel", travel, "m")


def largest_piece(state: State) -> np.ndarray:
    """Mask of the projectile's bulk, shape [n]: its largest piece connected within one support."""
    of = np.flatnonzero(state.of("projectile"))
    bulk = np.zeros(len(state.x), dtype=bool)
    bulk[of[groups(state.x[of], 2.0 * state.h) == 0]] = True
    return bulk


def lagrangian(state: State) -> float:
    """Share of the projectile's particles that are Total Lagrangian."""
    return float((state.kernel_type[state.of("projectile")] == 1).mean())


def crater(state: State) -> float:
    """Narrowest opening of the plate between its lips [m]; 0 while both sides are within one support.

    The lips are what lies within half a thickness of the plate's faces and is connected with its outer halves.
    """
    support = 2.0 * state.h
    x = state.x[state.of("plate")]
    x = x[np.abs(x[:, 0] - 0.5 * THICKNESS) < THICKNESS]
    piece = groups(x, support)
    outer = np.abs(x[:, 1]) > 0.25 * HEIGHT
    return widest_gap(x[np.isin(piece, piece[outer]), 1], support)


def cavity(state: State) -> float:
    """Widest opening across the bubble that the plate forms around the projectile [m], in slices of one support."""
    support = 2.0 * state.h
    x = state.x[state.of("plate")]
    x = x[x[:, 0] > 0.0]
    return widest_gap(x[:, 1], support, np.floor(x[:, 0] / support))


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
