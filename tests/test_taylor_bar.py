"""Taylor bar: the measures on shapes of known answer, and a coarse bar beside finite elements."""

import numpy as np
import pytest

from warpsph import library
from warpsph.scenes import taylor_bar as taylor
from warpsph.solver import Solver
from warpsph.state import State

FILE = library.load("taylor_bar")


def measured(data, x):
    """Every measure of the bar when its particles are at x [m], shape [n, 3]."""
    names = [material.name for material in data.materials]
    state = State(0.0, 0, 3, data.spacing, data.h, data.name, data.bodies, names, {"x": x, "body": data.body})
    return {name: measure.function(state) for name, measure in data.measures.items()}


@pytest.mark.parametrize("quarter", [True, False])
@pytest.mark.parametrize("across", [12, 18, 24])
def test_the_bar_stands_on_the_wall_and_measures_what_it_should(quarter, across):
    spacing = taylor.DIAMETER / across
    data = FILE.build(spacing=spacing, quarter=quarter).finalize()
    assert {axis for axis, _ in data.planes} == ({0, 1, 2} if quarter else {2})
    assert data.x[:, 2].min() == pytest.approx(0.5 * spacing)
    assert measured(data, data.x) == pytest.approx(
        {"final_length": 25.4e-3, "foot_diameter": 7.62e-3, "diameter_02": 7.62e-3}
    )
    share = 4 if quarter else 1
    volume = share * len(data.x) * data.spacing**3
    assert volume == pytest.approx(25.4e-3 * np.pi * (0.5 * 7.62e-3) ** 2, rel=0.02)


def test_a_spacing_is_made_to_divide_the_length():
    assert FILE.build(spacing=1.2e-3).spacing == pytest.approx(taylor.LENGTH / 21)
    assert FILE.build().spacing == pytest.approx(3.175e-4)


@pytest.mark.parametrize("quarter", [True, False])
def test_measures_of_a_cone(quarter):
    """Shorter, and wider by a linear function of the height: the answers are exact."""
    data = FILE.build(spacing=4.233e-4, quarter=quarter).finalize()
    x = data.x.copy()
    height = 0.7 * x[:, 2]
    wide = 1.5 - 0.5 * height / (0.7 * taylor.LENGTH)
    x[:, 0] *= wide
    x[:, 1] *= wide
    x[:, 2] = height
    found = measured(data, x)
    assert found["final_length"] == pytest.approx(0.7 * taylor.LENGTH)
    lowest = 1.5 - 0.25 * data.spacing / taylor.LENGTH
    assert found["foot_diameter"] == pytest.approx(lowest * taylor.DIAMETER)
    assert found["diameter_02"] == pytest.approx((1.5 - 0.5 * 0.2 / 0.7) * taylor.DIAMETER)


def test_particles_convert_in_the_adaptive_schemes_alone():
    assert FILE.build(scheme="adaptle", conversion_strain=0.5).numerics.conversion.strain == 0.5
    assert FILE.build(scheme="tl").numerics.conversion is None
    assert FILE.build(scheme="sav1").numerics.conversion is None


def bar(until, **parameters):
    """Measures, state and share of the energy that is motion, of 12 particles across after a time [s]."""
    data = FILE.build(spacing=taylor.DIAMETER / 12, **parameters).finalize()
    solver = Solver(data)
    solver.advance(until)
    state, ledger = solver.state(), solver.ledger()
    start = 0.5 * float(np.sum(data.m[:, None] * data.v**2))
    assert ledger["kinetic_energy"] + ledger["internal_energy"] == pytest.approx(start, rel=1e-12)
    return measured(data, state.x), state, ledger["kinetic_energy"] / start


@pytest.mark.parametrize("scheme", ["tl", "ts2-mixed"])
def test_a_coarse_bar_ends_near_the_finite_elements(scheme):
    """Finite elements with the same constants give 17.28, 14.59 and 9.45 mm at rest."""
    found, state, motion = bar(60e-6, scheme=scheme)
    assert found["final_length"] == pytest.approx(17.28e-3, rel=0.02)
    assert found["foot_diameter"] == pytest.approx(14.59e-3, rel=0.06)
    assert found["diameter_02"] == pytest.approx(9.45e-3, rel=0.03)
    assert motion < 0.01, "the bar is at rest"
    assert (state.x > 0.0).all(), "nothing has crossed a plane"


def test_the_foot_of_an_adaptive_bar_converts():
    """Two thirds of the way to rest: no particle has been thrown off, and the bar is longer than unbraked flight leaves."""
    found, state, _ = bar(32e-6, scheme="adaptle")
    converted = state.kernel_type == 0
    assert 0.1 < converted.mean() < 0.4
    assert (state.x < 0.0).any(axis=1).mean() < 0.01, "Eulerian particles can pass their own mirror image"
    assert state.x[converted, 2].max() < 0.2 * taylor.LENGTH
    assert np.abs(state.v).max() < 190.0
    assert 0.0 < found["final_length"] - (taylor.LENGTH - 190.0 * 32e-6) < 0.05 * taylor.LENGTH
