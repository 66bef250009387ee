"""How deep bodies in contact have entered each other, from the share of a smoothing kernel that the other one fills."""

import functools

import numpy as np

_POINTS = 2000
"""Points of the table over the kernel's support."""

_SUPPORT = 3.0
"""Radius in h that holds every kernel."""


def _plus(a: np.ndarray) -> np.ndarray:
    return np.maximum(a, 0.0)


_SHAPES = {
    "cubic_spline": lambda q, dim: 0.25 * _plus(2.0 - q) ** 3 - _plus(1.0 - q) ** 3,
    "quintic_spline": lambda q, dim: (
        _plus(3.0 - q) ** 5 - 6.0 * _plus(2.0 - q) ** 5 + 15.0 * _plus(1.0 - q) ** 5
    ),
    "wendland_c2": lambda q, dim: (
        _plus(1.0 - 0.5 * q) ** 3 * (1.5 * q + 1.0)
        if dim == 1
        else _plus(1.0 - 0.5 * q) ** 4 * (2.0 * q + 1.0)
    ),
    "wendland_c4": lambda q, dim: (
        _plus(1.0 - 0.5 * q) ** 5 * (2.0 * q**2 + 2.5 * q + 1.0)
        if dim == 1
        else _plus(1.0 - 0.5 * q) ** 6 * (35.0 / 12.0 * q**2 + 3.0 * q + 1.0)
    ),
    "gaussian": lambda q, dim: np.where(q < 3.0, np.exp(-(q**2)), 0.0),
}
"""Kernels of method section 1 over q = r/h, not normalised, as `warpsph.kernels.smoothing` has them."""

_CAPS = {
    1: lambda q, z: np.ones_like(q),
    2: lambda q, z: 2.0 * q * np.arccos(z / q),
    3: lambda q, z: 2.0 * np.pi * q * (q - z),
}
"""Length, area ... of the part of a sphere of radius q that lies beyond a plane at distance z <= q."""


@functools.cache
def _profile(kernel: str, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Share of the kernel that a half-space fills [1] over its depth [h], both rising, shape [2 points + 1]."""
    step = _SUPPORT / _POINTS
    depth = step * np.arange(_POINTS + 1)
    q = depth[:-1] + 0.5 * step
    weight = _SHAPES[kernel](q, dim)
    beyond = np.array([np.sum((weight * _CAPS[dim](np.maximum(q, z), z))[q > z]) for z in depth])
    beyond *= 0.5 / beyond[0]  # a plane through the centre halves the kernel
    return np.concatenate((-depth[:0:-1], depth)), np.concatenate((beyond[:0:-1], 1.0 - beyond))


def cover_at(depth: float, kernel: str, dim: int, h: float, spacing: float) -> float:
    """Share of a particle's kernel that another body fills at an interpenetration, the inverse of `interpenetration`.

    Args:
        depth: Interpenetration, in spacings.
        kernel: Name of the smoothing kernel.
        dim: Space dimension.
        h: Smoothing length [m].
        spacing: Particle spacing [m].

    Returns:
        Share [1]; infinite where the whole kernel is deeper in than that.
    """
    depths, share = _profile(kernel, dim)
    return float(np.interp((depth - 0.5) * spacing / h, depths, share, right=np.inf))


def interpenetration(cover: float, kernel: str, dim: int, h: float, spacing: float) -> float:
    """Depth to which a particle has entered another body.

    The depth is that at which a half-space fills the same share of its kernel. A body's surface is half a spacing
    outside of its outermost particles: two that touch are at depth -1/2.

    Args:
        cover: Share of the particle's kernel that the other body fills, Σ V_b W_ab [1].
        kernel: Name of the smoothing kernel.
        dim: Space dimension.
        h: Smoothing length [m].
        spacing: Particle spacing [m].

    Returns:
        Interpenetration of the two bodies in spacings, 0 where they only touch.
    """
    depth, share = _profile(kernel, dim)
    return max(0.0, float(np.interp(cover, share, depth)) * h / spacing + 0.5)
