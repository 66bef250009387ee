"""Whether the numbers of a scene fit into the precision of a run: lengths of nanometres or of planets, far from the origin."""

import numpy as np
import warp as wp

from warpsph.contact import contact_constants
from warpsph.kernels.spec import Spec
from warpsph.messages import values
from warpsph.scene import SceneData

MARGIN = 1e4
"""How much larger or smaller than at the start a number may become."""

COARSEST = 0.01
"""Largest rounding of a position, in spacings: the kernel then errs by a few per cent."""


def check_magnitudes(data: SceneData, spec: Spec, precision: str) -> None:
    """Refuse a scene whose numbers overflow, vanish or are rounded away.

    Args:
        data: The finalised scene.
        spec: Scalar types of the run.
        precision: Their name.

    Raises:
        InputError: Naming the number, and what would do.
    """
    limits = np.finfo(wp.dtype_to_numpy(spec.real))
    low, high = MARGIN * float(limits.tiny), float(limits.max) / MARGIN
    for what, sizes in _sizes(data).items():
        for size in (sizes.min(), sizes.max()):
            if not low <= size <= high:
                raise values.beyond_precision(data.spacing, precision, what, float(size), (low, high))
    far = float(np.abs(data.x).max())
    rounding = far * float(np.finfo(wp.dtype_to_numpy(spec.place)).eps)
    if rounding > COARSEST * data.spacing:
        raise values.too_far(far, precision, rounding / data.spacing, COARSEST)


def _sizes(data: SceneData) -> dict[str, np.ndarray]:
    """Numbers that a step works with, by what they are; a cold gas at rest has no speed yet."""
    h, volume = data.h, data.m / data.rho
    speed = np.array([material.longitudinal_speed for material in data.materials])[data.mat]
    speed = np.maximum(speed, np.linalg.norm(data.v, axis=1))
    with np.errstate(over="ignore", under="ignore"):
        sizes = {
            f"h^{data.dim + 2} of the kernel's gradient": np.array([h, 1.0 / h]) ** (data.dim + 2),
            "the volume of a particle": volume,
            "the mass of a particle": data.m,
            "mass times density": data.m * data.rho,
            "the square of a stress": (data.rho * speed**2) ** 2,
            "the square of an acceleration": (speed**2 / h) ** 2,
        }
    if data.numerics.contact is not None:
        modulus, scale = contact_constants(data)
        sizes["the modulus of the contact"] = scale * np.asarray(modulus)
    moving = speed > 0.0
    for what in ("the square of a stress", "the square of an acceleration"):
        sizes[what] = sizes[what][moving] if moving.any() else np.ones(1)
    return sizes
