"""Sod's shock tube in one dimension against the exact solution."""

from pathlib import Path

import numpy as np
import pytest
from tools import by_id

from warpsph import library
from warpsph.running.balance import energy
from warpsph.scenes import sod
from warpsph.solver import Solver

REFERENCE = Path(__file__).parent / "data" / "sod_exact.csv"
"""Exact solution at t = 0.2 s with the diaphragm at x = 0.5 m, by an independent program."""


def test_the_exact_solution_is_exact():
    table = np.genfromtxt(REFERENCE, delimiter=",", names=True)
    found = sod.exact((table["x"] - 0.5) / 0.2)
    for values, name in zip(found, ("rho", "u", "p"), strict=True):
        away = np.abs(np.gradient(table[name])) < 0.02  # off the jumps, where the tables' rounding decides
        assert away.sum() > 70
        np.testing.assert_allclose(values[away], table[name][away], atol=1e-5)


def errors(particles, **parameters):
    """L1 errors of density, velocity and pressure, and the solver at the end."""
    solver = Solver(library.load("sod").build(particles=particles, **parameters).finalize())
    solver.advance(solver.data.until)
    state = solver.state()
    return np.array([measure.function(state) for measure in solver.data.measures.values()]), solver


@pytest.mark.parametrize(
    ("scheme", "bounds", "gain"),
    [("sav1", (0.009, 0.021, 0.011), 1.3), ("sav1-mixed", (0.0055, 0.014, 0.007), 1.6)],
)
def test_the_errors_are_small_and_fall_with_resolution(scheme, bounds, gain):
    """A shock and a contact allow first order at best; plain gradients converge slower, with h over spacing kept."""
    coarse, middle, fine = (errors(n, scheme=scheme)[0] for n in (100, 200, 400))
    assert (fine < bounds).all(), fine
    assert (middle < coarse / gain).all() and (fine < middle / gain).all(), (coarse, middle, fine)


def test_the_waves_are_where_they_should_be():
    _, solver = errors(400)
    x, rho, v, p = (by_id(solver, name) for name in ("x", "rho", "v", "p"))
    x = x[:, 0]
    behind = (x > 0.22) & (x < 0.32)  # between contact and shock
    assert np.median(p[behind]) == pytest.approx(0.30313, rel=0.01)
    assert np.median(v[behind, 0]) == pytest.approx(0.92745, rel=0.01)
    assert np.median(rho[behind]) == pytest.approx(0.26557, rel=0.02)
    front = x[v[:, 0] > 0.46].max()
    assert front == pytest.approx(1.75216 * 0.2, abs=0.01)
    walls = np.abs(solver.data.x[:, 0]) > 0.5
    np.testing.assert_array_equal(v[walls], 0.0)


def test_the_strip_in_two_dimensions_is_the_tube():
    """Errors of the rows near the plane of symmetry are those in 1D, and nothing moves across the tube there."""
    for scheme in ("sav1", "ts2"):
        tube, strip = errors(100, scheme=scheme)[0], errors(100, scheme=scheme, dim=2)
        np.testing.assert_allclose(strip[0], tube, rtol=0.3)
        state = strip[1].state()
        inner = state.x[:, 1] < 0.5 * sod.ROWS * state.spacing
        assert np.abs(state.v[inner, 1]).max() < 0.02


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize(
    ("scheme", "bounds"),
    [
        ("av", (0.017, 0.05, 0.02)),
        ("pm", (0.03, 0.07, 0.03)),
        ("ts1", (0.045, 0.09, 0.042)),
        ("ts2", (0.012, 0.04, 0.013)),
        ("ts2-mixed", (0.013, 0.033, 0.015)),
    ],
)
def test_the_schemes_of_second_order_are_ahead_in_a_coarse_tube(scheme, bounds, precision):
    """Bounds guard what is reached: v* in the continuity equation costs the schemes of first order their density."""
    solver = Solver(library.load("sod").build(particles=100, scheme=scheme).finalize(), precision=precision)
    before = energy(solver.ledger())
    solver.advance(solver.data.until)
    state = solver.state()
    found = [measure.function(state) for measure in solver.data.measures.values()]
    assert (np.array(found) < bounds).all(), found
    assert energy(solver.ledger()) == pytest.approx(before, rel=1e-12 if precision == "float64" else 1e-5)
