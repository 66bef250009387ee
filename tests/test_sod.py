"""Sod's shock tube in one dimension against the exact solution."""

from pathlib import Path

import numpy as np
import pytest
from tools import by_id

from warpsph import library
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
