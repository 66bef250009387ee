"""Noh's implosion: the exact solution, and schemes of second order against it."""

import numpy as np
import pytest

from warpsph import library
from warpsph.errors import InputError
from warpsph.running import balance
from warpsph.scenes import noh
from warpsph.solver import Solver


@pytest.mark.parametrize(("dim", "density", "pressure"), [(1, 4.0, 4.0 / 3.0), (2, 16.0, 16.0 / 3.0)])
def test_the_exact_solution_is_that_of_noh(dim, density, pressure):
    fields = noh.exact(np.array([0.1, 0.199, 0.201, 0.3]), 0.6, dim)
    np.testing.assert_allclose(fields["rho"][:2], density)
    np.testing.assert_allclose(fields["p"][:2], pressure)
    np.testing.assert_allclose(fields["rho"][3], 3.0 ** (dim - 1))
    np.testing.assert_array_equal(fields["v"], [0.0, 0.0, -1.0, -1.0])
    np.testing.assert_array_equal(fields["p"][2:], 0.0)


@pytest.mark.parametrize("dim", [1, 2])
def test_the_exact_shock_satisfies_the_jump_conditions(dim):
    """Mass, momentum and energy in the frame of the shock, of a gas that is cold ahead of it."""
    speed = noh.shock_speed()
    ahead, behind = (noh.exact(np.array([r * speed * 0.6]), 0.6, dim) for r in (1 + 1e-12, 1 - 1e-12))
    flux = ahead["rho"] * (speed + 1.0)
    assert behind["rho"] * speed == pytest.approx(flux)
    assert behind["p"] == pytest.approx(flux * 1.0)
    e = behind["p"] / ((noh.GAMMA - 1.0) * behind["rho"])
    assert e + behind["p"] / behind["rho"] + 0.5 * speed**2 == pytest.approx(0.5 * (speed + 1.0) ** 2)


def test_too_few_particles_are_refused():
    with pytest.raises(InputError, match="particles = 5"):
        noh.build(particles=5)


def run(precision="float64", **parameters):
    """Measures and relative energy error at the end."""
    solver = Solver(library.load("noh").build(**parameters).finalize(), precision=precision)
    before = balance.energy(solver.ledger())
    solver.advance(solver.data.until)
    state = solver.state()
    found = {name: measure.function(state) for name, measure in solver.data.measures.items()}
    return found, abs(balance.energy(solver.ledger()) / before - 1.0)


def test_a_wall_stops_the_gas():
    found, energy = run(scheme="ts2-mixed")
    assert energy < 1e-12
    assert found["shock_position"] == pytest.approx(0.2, rel=0.02)
    assert found["plateau_density"] == pytest.approx(4.0, rel=0.1)
    assert found["l1_v"] < 0.02
    assert 0.1 < found["wall_deficit"] < 0.4, "wall heating"


def test_an_axis_stops_the_gas():
    found, energy = run(scheme="ts2-mixed", dim=2, particles=30)
    assert energy < 1e-12
    assert found["shock_position"] == pytest.approx(0.2, rel=0.05)
    assert found["plateau_density"] == pytest.approx(16.0, rel=0.15)
    assert found["l1_rho"] < 0.12


def test_second_order_is_better():
    first, second = (run(scheme=scheme)[0] for scheme in ("ts1", "ts2"))
    for name in ("l1_rho", "l1_v", "l1_p", "wall_deficit"):
        assert second[name] < 0.5 * first[name]


def test_single_precision_is_as_good():
    double, single = run(scheme="ts2")[0], run("float32", scheme="ts2")
    assert single[1] < 1e-5
    for name in ("l1_rho", "l1_v", "l1_p"):
        assert single[0][name] == pytest.approx(double[name], abs=2e-3)
