"""The particle behind a trouble, and what is wrong with it, once a device has said that there is one."""

from dataclasses import dataclass

import numpy as np

from warpsph.clock import Reading
from warpsph.errors import RunError
from warpsph.kernels.deformation import SMALLEST_J
from warpsph.kernels.kernel_type import LAGRANGIAN
from warpsph.kernels.timestep import (
    ACCELERATION_CFL,
    CONTACT_CFL,
    INSIDE_OUT,
    NON_FINITE,
    VISCOUS_SHARE,
)
from warpsph.messages import stops
from warpsph.particles import Particles
from warpsph.scene import SceneData
from warpsph.schemes.scheme import Scheme

STATE = {
    "x": "position", "v": "velocity", "rho": "density", "e": "energy", "cl": "sound speed", "p": "pressure",
    "tau": "stress", "ep": "plastic strain", "T": "temperature", "D": "damage", "F": "deformation gradient",
}  # fmt: skip
"""Fields without which a particle cannot go on, with what a user calls them."""


@dataclass(frozen=True)
class Culprit:
    """A particle in trouble.

    Attributes:
        particle: Its id.
        body: Name of its body.
        material: Name of its material.
        position: Where it is [m].
        time: When [s].
        step: Steps taken until then.
    """

    particle: int
    body: str
    material: str
    position: tuple[float, float, float]
    time: float
    step: int

    def __str__(self) -> str:
        where = ", ".join(f"{c:.6g}" for c in self.position)
        return f"particle {self.particle} of body {self.body!r} (material {self.material!r}) at ({where}) m"


def name_culprit(particles: Particles, data: SceneData, index: int, now: Reading) -> Culprit:
    """The particle at a place in memory."""

    def own(name: str) -> np.ndarray:
        return getattr(particles, name)[index : index + 1].numpy()[0]

    return Culprit(
        particle=int(own("id")), body=data.bodies[own("body")], material=data.materials[own("mat")].name,
        position=tuple(own("x").tolist()), time=now.time, step=now.steps,
    )  # fmt: skip


def broken_fields(particles: Particles, index: int) -> list[str]:
    """What of a particle's state is not finite, in words."""
    return [
        title
        for name, title in STATE.items()
        if hasattr(particles, name)
        and not np.isfinite(getattr(particles, name)[index : index + 1].numpy()).all()
    ]


def explain(now: Reading, particles: Particles, data: SceneData, scheme: Scheme) -> RunError:
    """What the device's verdict on the next step comes from: the particle, and the cause."""
    p = particles.arrays()
    if now.status == INSIDE_OUT:
        i = int(np.argmax((p["inverted"] > 0) & (p["kernel_type"] == LAGRANGIAN)))
        return stops.turned_over(name_culprit(particles, data, i, now), SMALLEST_J)
    rows = len(p["id"])
    bad = np.any([~np.isfinite(p[name]).reshape(rows, -1).all(1) for name in STATE if name in p], axis=0)
    if now.status == NON_FINITE and np.any(bad):
        i = int(np.argmax(bad))
        culprit = name_culprit(particles, data, i, now)
        return stops.not_finite(
            culprit, broken_fields(particles, i), float(p["rho"][i]), int(p["clipped"][i])
        )
    limit = _limits(p, data, scheme)
    i = int(np.argmin(limit))
    culprit = name_culprit(particles, data, i, now)
    with np.errstate(all="ignore"):  # a state beyond all numbers
        acceleration, speed = (float(np.linalg.norm(p[name][i])) for name in ("dvdt", "v"))
    return stops.collapsed(culprit, float(limit[i]), float(p["cl"][i]), acceleration, speed)


def _limits(p: dict[str, np.ndarray], data: SceneData, scheme: Scheme) -> np.ndarray:
    """The largest step [s] of each particle, shape [n], as `kernels.timestep` finds it."""
    with np.errstate(all="ignore"):
        wave = p["cl"] + VISCOUS_SHARE * p.get("av_switch", 1.0) * (
            scheme.viscosity_alpha * p["cs"] + scheme.viscosity_beta * p["mu"]
        )
        acceleration = np.linalg.norm(p["dvdt"], axis=1)
        # who is far from most makes the box of velocities large
        apart = np.linalg.norm(p["v"] - np.median(p["v"], axis=0), axis=1)
        limits = [
            data.numerics.cfl * data.h / wave,
            ACCELERATION_CFL * np.sqrt(data.h / np.maximum(acceleration, 1e-300)),
            scheme.leap * data.h / np.maximum(apart, 1e-300),
        ]
        if "contact_rate" in p:
            limits.append(CONTACT_CFL / np.sqrt(np.maximum(p["contact_rate"], 1e-300)))
    return np.min(limits, axis=0)
