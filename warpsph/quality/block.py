"""The block of the benchmark: disordered particles in a shear flow, so that neighbours change as they do in an impact."""

import numpy as np

from warpsph.scene import Scene
from warpsph.shapes import Box

SPACING = 1e-3
"""Particle spacing [m]."""

JITTER = 0.15
"""Largest displacement of a particle from the lattice along each axis, in spacings."""

SEED = 20130611
"""Seed of the displacements."""

SPEED = 300.0
"""Amplitude of each shear flow [m/s]: neighbour rows last some ten steps."""

CONVERGENCE = 0.25
"""Amplitude of the flow that compresses and stretches, over `SPEED`."""

WAVE = 40.0
"""Wavelength of the flow, in spacings: what a particle goes through does not depend on the number of particles."""


def block(dim: int, particles: int) -> Scene:
    """Build a square or a cube of aluminium of about so many particles.

    Args:
        dim: Space dimension, 2 or 3.
        particles: Particles; rounded to a square or a cube number.
    """
    side = round(particles ** (1.0 / dim)) * SPACING
    scene = Scene("block", dim=dim, spacing=SPACING, until=1e-3)
    body = scene.add_body("block", Box((0.0,) * dim, (side,) * dim), "aluminium")
    body.x[:, :dim] += np.random.default_rng(SEED).uniform(-JITTER, JITTER, (len(body), dim)) * SPACING
    body.v[:, :dim] = velocity(body.x[:, :dim])
    return scene


def velocity(x: np.ndarray) -> np.ndarray:
    """Velocity [m/s] of positions [m], both of shape [n, dim].

    v_c = V (sin k x_(c-1) + cos k x_(c+1) - b sin k x_c), coordinates counted around: every plane is sheared, without a
    change of volume, and compressed and stretched in turn along every axis.
    """
    phase = 2.0 * np.pi / (WAVE * SPACING) * x
    shear = np.sin(np.roll(phase, 1, axis=1)) + np.cos(np.roll(phase, -1, axis=1))
    return SPEED * (shear - CONVERGENCE * np.sin(phase))


def half(x: np.ndarray) -> np.ndarray:
    """Mask of the half of the block that is Eulerian in a coupled scheme, shape [n], of positions [m], shape [n, 3]."""
    return x[:, 0] < 0.5 * x[:, 0].max()
