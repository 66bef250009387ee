"""A plate hits its like at 603 m/s in one dimension (Connolly et al. 2013, section 4.1), against the exact solution."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from warpsph import checks, materials
from warpsph.config import LimiterName, Numerics, RiemannName
from warpsph.materials import IsothermalMieGrueneisen, Material
from warpsph.measure import once
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.state import State

LENGTH = 1e-2
"""Thickness of both plates together [m]; they touch in its middle at the start."""

SPEED = 602.81
"""Speed of the flyer [m/s]."""

UNTIL = 0.5e-6
"""When the fields are compared [s]."""

INSIDE = 0.05 * LENGTH, 0.95 * LENGTH
"""Where they are [m]: away from the free ends, which the waves have not reached."""

CORE = 0.8
"""Share of the distance between the plastic shocks, in the middle, over which plateaus are taken."""

MATERIALS = {"printed": "flyer", "full": "flyer-full"}
"""Material by equation of state: the isothermal form as printed (Eq. 36), or with the Hugoniot Us = c0 + S1 up."""

FIELDS: dict[str, Callable[[State], np.ndarray]] = {
    "rho": lambda state: state.rho,
    "v": lambda state: state.v[:, 0],
    "p": lambda state: state.p,
    "tau": lambda state: state.tau[:, 0, 0],
}
"""The fields that are compared, of a picture of all particles, shape [n]."""


@dataclass(frozen=True)
class Front:
    """A shock that runs into the plate at rest, and the state behind it.

    Attributes:
        speed: Its speed [m/s].
        rho: Density behind it [kg/m^3].
        v: Velocity behind it [m/s], in the direction of the shock.
        p: Pressure behind it [Pa].
        tau: Longitudinal deviatoric stress behind it [Pa], tension positive.
    """

    speed: float
    rho: float
    v: float
    p: float
    tau: float


def fronts(material: Material, speed: float = SPEED) -> tuple[Front, Front]:
    """Elastic precursor and plastic shock in a plate whose face is driven at half the speed of impact.

    In uniaxial strain τxx = -4/3 G ln(ρ/ρ0) until |τxx| = 2Y/3; both branches of -σxx = p - τxx are convex in 1/ρ, so
    that each carries a shock: (ρ U)² Δ(1/ρ) = Δσxx and Δv = -Δσxx/(ρ U), ρ U the mass that crosses the front.

    Args:
        material: An elastic, perfectly plastic material whose pressure does not depend on the energy.
        speed: Speed of impact [m/s]: fast enough to yield, and so slow that the precursor stays ahead.

    Raises:
        InputError: If the speed leaves one front only.
    """
    rho0, tau = material.density, -2.0 / 3.0 * material.strength.Y
    elastic = rho0 * math.exp(material.strength.Y / (2.0 * material.strength.G))

    def shock(ahead: Front, rho: float) -> Front:
        p = pressure(material, rho)
        flux = math.sqrt((p - tau - ahead.p + ahead.tau) / (1.0 / ahead.rho - 1.0 / rho))
        v = ahead.v + flux * (1.0 / ahead.rho - 1.0 / rho)
        return Front(ahead.v + flux / ahead.rho, rho, v, p, tau)

    precursor = shock(Front(0.0, rho0, 0.0, 0.0, 0.0), elastic)
    low, high = elastic * (1.0 + 1e-12), 1.5 * rho0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if shock(precursor, middle).v < 0.5 * speed else (low, middle)
    plastic = shock(precursor, middle)
    if not (0.5 * speed > precursor.v and plastic.speed < precursor.speed):
        raise checks.refuse("speed of impact", speed, "one that sends a plastic shock behind the precursor")
    return precursor, plastic


def pressure(material: Material, rho: float) -> float:
    """Pressure at a density [Pa]: Connolly et al. 2013, Eq. 36 as printed, or Eq. 37 without Grüneisen's parameter."""
    zeta, eos = rho / material.density - 1.0, material.eos
    D = 1.0 - (eos.S1 - 1.0) * zeta
    reference = material.density * eos.c0**2 * zeta
    return reference / D if isinstance(eos, IsothermalMieGrueneisen) else reference * (1.0 + zeta) / D**2


def exact(material: Material, x: np.ndarray, time: float) -> dict[str, np.ndarray]:
    """Exact fields, far from the free ends.

    Args:
        material: Material of both plates.
        x: Positions [m], shape [n].
        time: Time since the impact [s].

    Returns:
        Density, velocity, pressure and longitudinal deviatoric stress in SI units, each of shape [n], by the keys of
        `FIELDS`.
    """
    from_contact = x - 0.5 * LENGTH - 0.5 * SPEED * time
    side = np.sign(from_contact)
    fields = {
        name: np.full_like(x, value)
        for name, value in zip(FIELDS, (material.density, 0.0, 0.0, 0.0), strict=True)
    }
    for front in fronts(material):  # seen from the contact, either half is the mirror image of the other
        behind = np.abs(from_contact) < (front.speed - 0.5 * SPEED) * time
        for name in FIELDS:
            fields[name][behind] = getattr(front, name)
    fields["v"] = 0.5 * SPEED + side * (fields["v"] - 0.5 * SPEED)
    return fields


def build(
    scheme: str = "ts2",
    particles: int = 100,
    eos: Literal["printed", "full"] = "printed",
    riemann: RiemannName = "acoustic",
    limiter: LimiterName = "minmod",
    limiter_beta: float = 1.5,
    limit_jump: bool = False,
) -> Scene:
    """Build both plates as one lattice, of which the left half moves; the ends are free.

    Args:
        scheme: Scheme: av, pm, ts1, ts2, or any other.
        particles: Particles in both plates together; even.
        eos: Equation of state as printed, or the full one with a linear relation of shock and particle velocity.
        riemann: Riemann solver of the Godunov schemes.
        limiter: Slope limiter of the second-order ones. The paper's is superbee: behind the overshoot that it allows at
            the plastic shock the material unloads, and the deviatoric stress stays too low.
        limiter_beta: Sweby's parameter, 1 (minmod) to 2 (superbee); matters to the limiter sweby.
        limit_jump: Bound slopes by the pair's own difference too.
    """
    if particles < 20 or particles % 2:
        raise checks.refuse("particles", particles, "an even number, at least 20")
    numerics = Numerics(
        scheme=scheme, riemann=riemann, limiter=limiter, limiter_beta=limiter_beta, limit_jump=limit_jump
    )
    material = materials.get(MATERIALS[eos])
    scene = Scene(
        "flyer_plate", dim=1, spacing=LENGTH / particles, until=UNTIL, snapshots=5, numerics=numerics
    )
    scene.add_body("flyer", Box(0.0, 0.5 * LENGTH), material, velocity=(SPEED,))
    scene.add_body("target", Box(0.5 * LENGTH, LENGTH), material)
    add_errors(scene, material)
    add_plateaus(scene, material)
    return scene


def add_errors(scene: Scene, material: Material) -> None:
    """Add each field's mean absolute error over its exact jump across all waves."""
    _, star = fronts(material)
    jumps = {"rho": star.rho - material.density, "v": SPEED, "p": star.p, "tau": abs(star.tau)}
    compared = once(lambda state: exact(material, state.x[:, 0], state.time))

    def error(name: str) -> Callable[[State], float]:
        def l1(state: State) -> float:
            x = state.x[:, 0]
            inside = (x > INSIDE[0]) & (x < INSIDE[1])
            return float(np.abs(FIELDS[name](state) - compared(state)[name])[inside].mean() / jumps[name])

        return l1

    for name in FIELDS:
        scene.add_measure(f"l1_{name}", error(name))


def add_plateaus(scene: Scene, material: Material) -> None:
    """Add medians between the plastic shocks, and how far the pressure overshoots, over its exact value there.

    `overshoot_front` leaves out the half of that region around the contact, where the start from a jump leaves its mark.
    """
    _, star = fronts(material)

    def within(state: State, share: float) -> np.ndarray:
        """Mask of the particles within a share of the plastic shocks' distance from the contact."""
        contact = 0.5 * (LENGTH + SPEED * state.time)
        return np.abs(state.x[:, 0] - contact) <= share * (star.speed - 0.5 * SPEED) * state.time

    def median(name: str) -> Callable[[State], float]:
        def plateau(state: State) -> float:
            core = within(state, CORE)
            return float(np.median(FIELDS[name](state)[core])) if core.any() else 0.0

        return plateau

    def overshoot(outside: float) -> Callable[[State], float]:
        return lambda state: float(state.p[~within(state, outside)].max() / star.p - 1.0)

    scene.add_measure("star_pressure", median("p"), "Pa")
    scene.add_measure("star_stress", median("tau"), "Pa")
    scene.add_measure("overshoot_p", overshoot(-1.0))
    scene.add_measure("overshoot_front", overshoot(0.5))


if __name__ == "__main__":
    from warpsph.cli import run_file

    run_file(__file__)
