"""How fast bodies close in on each other, and the Courant number that this leaves."""

import itertools

import numpy as np

from .scene import SceneData

SUPERSONIC = 2.0
"""Closing speed over the fastest wave up to which steps need not be shorter: h in a step at a Courant number of 1/2."""


def courant(data: SceneData) -> float:
    """Courant number of a run: the scene's, less where bodies close in faster than at twice the wave speed.

    Steps follow the waves and the neighbours that there are. Before it has any a body would otherwise be deep inside
    another after one step. A gas has no wave speed here, and no say.
    """
    speeds = [m.longitudinal_speed for m in data.materials if m.bulk_speed > 0.0]
    fastest = _closing_speed(data)
    if not speeds or fastest <= SUPERSONIC * max(speeds):
        return data.numerics.cfl
    return data.numerics.cfl * SUPERSONIC * max(speeds) / fastest


def _closing_speed(data: SceneData) -> float:
    """Largest difference between the mean velocities of two bodies, or of one and its mirror image [m/s]."""
    means = [np.mean(data.v[data.body == b], axis=0) for b in range(len(data.bodies))]
    pairs = [float(np.linalg.norm(a - b)) for a, b in itertools.combinations(means, 2)]
    images = [2.0 * abs(float(mean[axis])) for mean in means for axis, _ in data.planes]
    return max(pairs + images, default=0.0)
