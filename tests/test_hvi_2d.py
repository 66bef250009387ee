"""The two-dimensional impact: its variants with contact, what it measures, and a coarse run of each."""

import numpy as np
import pytest

from warpsph import library
from warpsph.scenes import hvi_2d as hvi
from warpsph.solver import Solver
from warpsph.state import State

SCENE = library.load("hvi_2d")
SPACING = 4e-4


def numerics(**parameters):
    return SCENE.build(spacing=SPACING, **parameters).numerics


def test_contact_has_the_papers_stiffness_at_any_resolution():
    """Kc = 2e12 read as Pa/mm^2; K = rho c0^2 of the stiffened gas."""
    bulk = 2785.0 * 5328.0**2
    assert numerics(scheme="sav1-contact").contact.stiffness * bulk / 1e-8 == pytest.approx(2e18, rel=1e-4)
    assert numerics(scheme="adaptle", contact_stiffness=0.1).contact.stiffness == 0.1
    assert numerics(scheme="sav1-as").contact is None


def test_names_of_the_paper_stand_for_schemes_of_the_engine():
    contact, adaptive = numerics(scheme="sav1-contact"), numerics(scheme="adaptle", conversion_strain=0.5)
    assert (contact.scheme, contact.conversion) == ("sav1-as", None)
    assert (adaptive.scheme, adaptive.conversion.strain) == ("adaptle-as", 0.5)
    assert adaptive.contact is not None and adaptive.inverted == "convert"


@pytest.mark.parametrize(
    ("parameters", "projectile"),
    [
        ({"scheme": "adaptle"}, 8012),
        ({"scheme": "sav1-contact"}, 7830),
        ({"scheme": "adaptle", "lattice": "core-and-rings"}, 7830),
    ],
)
def test_the_disc_is_rings_where_the_paper_has_them(parameters, projectile):
    assert len(SCENE.build(**parameters).bodies["projectile"]) == projectile


@pytest.fixture(scope="module")
def data():
    return SCENE.build(spacing=SPACING).finalize()


def picture(data, time=0.0, **fields):
    """State of the scene as it starts, but for the fields given."""
    zero = np.zeros(len(data.x))
    start = {"x": data.x, "body": data.body, "p": zero, "p_low": zero, "p_high": zero, "kernel_type": zero}
    return State(time, 0, 2, data.spacing, data.h, data.name, data.bodies, ["aluminium"], start | fields)


def test_only_what_leaves_the_rear_half_has_left_the_back(data):
    disc = data.body == 0
    x = data.x.copy()
    last = np.flatnonzero(disc & (x[:, 0] < x[disc, 0].min() + 1e-9))
    first = np.flatnonzero(disc & (x[:, 0] > x[disc, 0].max() - 1e-9))
    x[last, 0] -= 5e-3
    x[first, 1] += 9e-3
    found = {name: data.measures[name].function(picture(data, x=x)) for name in data.measures}
    assert found["back_spalled"] == len(last)
    assert found["projectile_spalled"] == len(last) + len(first)


def test_tension_peaks_when_it_is_a_record():
    """Of two particles, the lower one counts; a third is not looked at."""
    pressures = np.array([[0.0, 2e9, -1e9, -2e9, -2e9, -2.5e9, 1e9], [0.0, 1e9, 1e9, -3e9, -1e9, 0.0, 1e9]]).T
    seen = [np.append(row, -9e9) for row in pressures]
    lowest = np.minimum.accumulate(seen)
    states = [
        State(float(k), k, 2, 1.0, 1.4, "", [], [], {"p": p, "p_low": low})
        for k, (p, low) in enumerate(zip(seen, lowest, strict=True))
    ]
    found = [hvi.record_time(state, np.array([0, 1])) for state in states]
    assert found == [0.0, 0.0, 2.0, 3.0, 0.0, 0.0, 0.0]


def test_tension_is_that_inside_the_disc(data):
    disc = data.body == 0
    away = np.linalg.norm(data.x[:, :2] - data.x[disc, :2].mean(axis=0), axis=1)
    low = np.where(disc & (away < 0.5 * hvi.RADIUS), -20e9, 0.0)
    low[disc & (away > 0.95 * hvi.RADIUS)] = low[~disc] = -140e9
    assert data.measures["projectile_tension"].function(picture(data, p_low=low)) == 20e9


def test_share_of_the_disc_that_is_lagrangian(data):
    kinds = np.ones(len(data.x), dtype=int)
    disc = np.flatnonzero(data.body == 0)
    kinds[disc[: len(disc) // 4]] = 0
    kinds[disc[-1]] = 2
    share = hvi.lagrangian(picture(data, kernel_type=kinds))
    assert share == pytest.approx(1.0 - (len(disc) // 4 + 1) / len(disc))


@pytest.mark.parametrize("scheme", ["sav1-contact", "adaptle"])
def test_a_coarse_disc_pierces_the_plate(scheme):
    """Half of the way: energy and momentum exact, a hole, a disc that has lost speed to the plate it drives on."""
    solver = Solver(SCENE.build(scheme=scheme, spacing=SPACING).finalize())
    start = solver.ledger()
    solver.advance(4e-6)
    state, ledger = solver.state(), solver.ledger()
    found = {name: measure.function(state) for name, measure in solver.data.measures.items()}
    energy = start["kinetic_energy"]
    assert ledger["kinetic_energy"] + ledger["internal_energy"] == pytest.approx(energy, rel=1e-12)
    assert ledger["momentum_x"] == pytest.approx(start["momentum_x"], rel=1e-12)
    assert 0.3e-2 < found["projectile_travel"] < 1.1e-2
    assert found["cavity_diameter"] > 1e-2
    assert found["peak_pressure"] > 10e9
    disc = state.of("projectile")
    assert np.average(state.v[disc, 0], weights=state.m[disc]) < 0.9 * 3100.0
    nose = state.x[disc, 0].max()
    axis = ~disc & (np.abs(state.x[:, 1]) < 2e-3)
    assert state.x[axis, 0].max() > nose, "the plate is pushed ahead, not passed through"
    if scheme == "adaptle":
        assert 0.2 < found["projectile_lagrangian"] < 1.0
