"""What must not change: energy, momentum and angular momentum against their values at the start."""

from collections.abc import Sequence

import numpy as np

from warpsph.scene import SceneData

AXES = ("x", "y", "z")

ROUND_OFF = 1e-9
"""A body's momentum below this share of sqrt(2 M E0) is none."""


class Balance:
    """The ledger of a run against its first entry.

    Work and impulses of constraints are booked as external. A symmetry plane takes up momentum along its normal
    and angular momentum about axes in it: those components are left out.

    Attributes:
        start: The first ledger.
        energy_error: Largest |E/E0 - 1| so far, E without the work of constraints.
        momentum_error: Largest change of momentum so far over the largest body momentum at the start (over
            sqrt(2 M E0), M the total mass, where that is none: at rest, or moving symmetrically about a point).
        kinetic: Largest kinetic energy so far [J]: the scale where all starts at rest with E0 = 0.
        angular_momentum_error: Largest change of angular momentum so far over the same times the scene's half diagonal.
    """

    def __init__(self, data: SceneData, start: dict[str, float]):
        self.start = start
        self.energy_error = self.momentum_error = self.angular_momentum_error = self.kinetic = 0.0
        normals = [axis for axis, _ in data.planes]
        self._momentum = [axis for axis in range(3) if axis not in normals]
        self._angular = [axis for axis in range(3) if all(axis == normal for normal in normals)]
        self._scale, self._mass = _momentum_scale(data, energy(start)), float(np.sum(data.m))
        self._arm = 0.5 * float(np.linalg.norm(np.ptp(data.x, axis=0))) or data.spacing

    def update(self, now: dict[str, float]) -> None:
        """Compare a ledger with the first one."""
        self.kinetic = max(self.kinetic, now["kinetic_energy"])
        scale = abs(energy(self.start)) or self.kinetic or 1.0
        change = energy(now) - now["work"] - energy(self.start)
        self.energy_error = max(self.energy_error, abs(change) / scale)
        linear = self._change(now, "momentum", "impulse", self._momentum)
        angular = self._change(now, "angular_momentum", "twist", self._angular)
        scale = self._scale or float(np.sqrt(2.0 * self._mass * self.kinetic)) or 1.0
        self.momentum_error = max(self.momentum_error, linear / scale)
        self.angular_momentum_error = max(self.angular_momentum_error, angular / (scale * self._arm))

    def _change(self, now: dict[str, float], name: str, given: str, axes: Sequence[int]) -> float:
        parts = [
            now[f"{name}_{AXES[a]}"] - now[f"{given}_{AXES[a]}"] - self.start[f"{name}_{AXES[a]}"]
            for a in axes
        ]
        return float(np.linalg.norm(parts))

    def save(self) -> dict:
        """Give plain values that `restore` takes up again."""
        return {
            "start": self.start,
            "energy_error": self.energy_error,
            "momentum_error": self.momentum_error,
            "angular_momentum_error": self.angular_momentum_error,
            "kinetic": self.kinetic,
        }

    def restore(self, saved: dict) -> None:
        """Go on from what `save` gave."""
        for name in self.save():
            setattr(self, name, saved[name])


def energy(ledger: dict[str, float]) -> float:
    """Total energy of a ledger [J]."""
    return ledger["kinetic_energy"] + ledger["internal_energy"]


def _momentum_scale(data: SceneData, total_energy: float) -> float:
    momenta = [
        np.linalg.norm(np.sum((data.m[:, None] * data.v)[data.body == b], axis=0))
        for b in range(len(data.bodies))
    ]
    largest, scale = float(max(momenta)), float(np.sqrt(2.0 * np.sum(data.m) * abs(total_energy)))
    return largest if largest > ROUND_OFF * scale else scale
