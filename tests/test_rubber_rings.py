"""The rubber rings: their measures on pictures of known answer, and a coarse bounce."""

import numpy as np
import pytest

from warpsph import library
from warpsph.running.balance import Balance
from warpsph.scenes import rubber_rings as rings
from warpsph.solver import Solver

COARSE = 2.5e-3
"""Spacing of four particles across a ring [m]."""


def built(**parameters):
    return library.load("rubber_rings").build(spacing=COARSE, **parameters)


def measured(made, state):
    return {name: measure.function(state) for name, measure in made.measures.items()}


@pytest.fixture(scope="module")
def start():
    """The scene, and its state before the first step."""
    made = built()
    return made, Solver(made.finalize()).state()


def changed(state, **fields):
    """The same state with other fields."""
    return type(state)(**(vars(state) | {"fields": state.fields | fields}))


def test_the_material_is_that_of_the_paper():
    """G = 0.22 rho c0^2: Poisson's ratio 0.3975."""
    K, G = rings.RUBBER.eos.K, rings.RUBBER.strength.G
    assert (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G)) == pytest.approx(0.3975, abs=1e-4)
    assert rings.RUBBER.bulk_speed == pytest.approx(rings.SOUND)


def test_at_the_start_the_rings_are_whole_and_approach(start):
    made, state = start
    found = measured(made, state)
    assert found["gap"] == pytest.approx(2.0 * COARSE)
    assert found["restitution"] == pytest.approx(-1.0)
    assert (found["pieces"], found["largest_piece"]) == (2.0, 1.0)
    assert found["stretch_max"] == pytest.approx(1.0)
    assert state.m.sum() == pytest.approx(2.0 * rings.DENSITY * np.pi * (0.04**2 - 0.03**2), rel=0.02)


def test_a_piece_that_is_cut_out_is_counted(start):
    made, state = start
    x = state.x.copy()
    piece = state.of("left") & (x[:, 0] < -rings.OUTER - COARSE) & (x[:, 1] > 0.0)
    x[piece] += [-0.01, 0.01, 0.0]
    found = measured(made, changed(state, x=x))
    assert found["pieces"] == 3.0
    assert found["largest_piece"] == pytest.approx(1.0 - piece.sum() / state.of("left").sum())
    assert found["stretch_max"] > 4.0


def test_one_cut_leaves_one_piece_but_shows_in_the_stretch(start):
    """A ring bent open, as a whole, where neighbours are at 3 spacings."""
    made, state = start
    x = state.x.copy()
    opened = state.of("right") & (x[:, 1] > 0.0)
    angle = 2.0 * COARSE / rings.OUTER
    centre = np.array([rings.OUTER + COARSE, 0.0])
    far = opened & (x[:, 0] > centre[0])
    x[far, 1] += rings.OUTER * angle * (x[far, 0] - centre[0]) / rings.OUTER
    found = measured(made, changed(state, x=x))
    assert found["pieces"] == 2.0
    assert found["stretch_max"] > 2.0


def test_rings_that_have_passed_a_speed_on(start):
    made, state = start
    v = -0.5 * state.v
    assert measured(made, changed(state, v=v))["restitution"] == pytest.approx(0.5)


def test_rings_bounce_whole():
    made = built()
    solver = Solver(made.finalize())
    balance = Balance(solver.data, solver.ledger())
    solver.advance(made.until)
    found = measured(made, solver.state())
    assert (found["pieces"], found["largest_piece"]) == (2.0, 1.0)
    assert found["gap"] > 0.0 and 0.0 < found["restitution"] < 1.0
    assert found["stretch_max"] < 2.0
    balance.update(solver.ledger())
    assert balance.energy_error < 1e-12 and balance.momentum_error < 1e-12


def test_rings_are_mirror_images():
    """Left and right ring are each other's image in x = 0, up to round-off and the order of sums."""
    made = built()
    solver = Solver(made.finalize())
    solver.advance(0.1 * made.until)
    x = solver.state().x
    left, right = x[solver.state().of("left")], x[solver.state().of("right")]
    mirrored = left * [-1.0, 1.0, 1.0]
    distance = np.linalg.norm(mirrored[:, None] - right[None], axis=2).min(axis=1)
    assert distance.max() < 1e-6 * COARSE
