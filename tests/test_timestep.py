"""The time step: each of its limits where that one decides."""

import math

import numpy as np
import pytest
from tools import SPACING, scene

from warpsph.shapes import Box
from warpsph.solver import Solver


def first_step(made):
    """Length of the first step [s]."""
    solver = Solver(made.finalize())
    solver.advance(math.inf, lambda now: True)
    return solver.reading.dt_max


def gas(speed, energy):
    """Ideal gas that flows together from both sides at ``speed`` [m/s]."""
    made = scene(1)
    made.add_body(
        "gas",
        Box(-10 * SPACING, 10 * SPACING),
        "air",
        velocity=lambda x: -speed * np.sign(x) * [1.0, 0.0, 0.0],
        internal_energy=energy,
    )
    return made


def test_sound_limits_a_gas_at_rest():
    h, c = 1.2 * SPACING, math.sqrt(1.4 * 0.4 * 1000.0)
    assert first_step(gas(0.0, 1000.0)) <= 0.5 * h / (1.6 * c) * (1 + 1e-12)


def test_approach_limits_the_first_step_of_a_cold_gas():
    """The gas has no sound speed to speak of; without a limit its two halves would pass through each other."""
    dt = first_step(gas(100.0, 1e-12))
    assert 0.0 < 2.0 * 100.0 * dt < SPACING


def test_courant_number_scales_the_step():
    steps = []
    for cfl in (0.5, 0.25):
        made = scene(1, cfl=cfl)
        made.add_body("bar", Box(0.0, 10 * SPACING), "aluminium")
        steps.append(first_step(made))
    assert steps[0] == pytest.approx(2.0 * steps[1], rel=1e-12)
