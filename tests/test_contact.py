"""Contact in whole scenes: bodies that part, bounce, push each other on, and are kept from entering each other."""

import numpy as np
import pytest
from tools import ELASTIC, REALS, SPACING, by_id, collision, run, scene

from warpsph.config import Contact
from warpsph.kernels.parts import PARTS
from warpsph.running.balance import Balance, energy
from warpsph.shapes import Box
from warpsph.solver import Solver

CONTACT = Contact(stiffness=0.25)
SCHEMES = ["tl", "tl-plain", "sav1", "sav1-mixed-as", "adaptle", "adaptle-mixed-as"]


def bars(dim=1, count=2, gap=2.5, speed=20.0, length=8, **numerics):
    """Elastic bars in a row; the first one flies towards the others."""
    made, at = scene(dim, **({"contact": CONTACT} | numerics)), 0.0
    for k in range(count):
        low, high = [at * SPACING] + [0.0] * (dim - 1), [(at + length) * SPACING] + [4 * SPACING] * (dim - 1)
        made.add_body(f"{k}", Box(low, high), ELASTIC, velocity=[speed * (k == 0)] + [0.0] * (dim - 1))
        at += length + gap
    return made


def momenta(solver):
    """Momentum of every body along x [N s]."""
    m, v, body = by_id(solver, "m"), by_id(solver, "v"), solver.data.body
    return np.array([m[body == k] @ v[body == k, 0] for k in range(body.max() + 1)])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_parted_bodies_know_nothing_of_each_other(scheme):
    """Beyond the support, and also within it on the way apart in the plain SPH sums: no force at all."""
    solver = run(bars(2, gap=4.0, speed=-20.0, scheme=scheme), 2e-6)
    np.testing.assert_array_equal(by_id(solver, "dvdt"), 0.0)
    np.testing.assert_array_equal(by_id(solver, "v")[:, 0], np.where(solver.data.body == 0, -20.0, 0.0))
    assert solver.tally()["interpenetration"] == 0.0
    assert solver.ledger()["contact_work"] == 0.0


@pytest.mark.parametrize("scheme", ["tl", "sav1", "adaptle"])
def test_contact_is_the_only_force_between_bodies(scheme):
    """Side by side at a spacing and moving past each other: pushed apart along the normal, not dragged along."""
    made = scene(2, scheme=scheme, contact=CONTACT)
    for k, speed in enumerate((30.0, 0.0)):
        low = 6.0 * k * SPACING
        made.add_body(
            f"{k}", Box((0.0, low), (20 * SPACING, low + 6 * SPACING)), ELASTIC, velocity=(speed, 0.0)
        )
    solver = run(made, 5e-7)
    body, v, x = solver.data.body, by_id(solver, "v"), solver.data.x[:, 0] / SPACING
    m, inner = by_id(solver, "m"), (x > 6.0) & (x < 14.0)
    up = [m[body == k] @ v[body == k, 1] for k in range(2)]
    assert up[1] > 0.0 > up[0]
    assert abs(v[inner & (body == 1), 0]).max() < 0.1 * abs(v[inner & (body == 1), 1]).max()


@pytest.mark.parametrize("scheme", ["tl", "sav1-mixed", "adaptle-mixed"])
def test_elastic_bars_exchange_their_velocities(scheme):
    """Two alike in one dimension, without viscosity: the first stops, and contact has given back what it took."""
    made = bars(scheme=scheme, viscosity_alpha=0.0, viscosity_beta=0.0, smoothing_ratio=1.3)
    data = made.finalize()
    solver = Solver(data)
    balance, worked = Balance(data, solver.ledger()), []
    start = momenta(solver)

    def look(_):
        worked.append(solver.ledger()["contact_work"])

    solver.advance(2.5e-4, look)
    now = solver.ledger()
    balance.update(now)
    first, second = momenta(solver) / start[0]
    assert first == pytest.approx(0.0, abs=0.1) and second == pytest.approx(1.0, abs=0.1)
    kinetic = 0.5 * now["momentum_x"] ** 2 / data.m[data.body == 1].sum()
    assert now["kinetic_energy"] > 0.9 * balance.start["kinetic_energy"]
    assert kinetic == pytest.approx(balance.start["kinetic_energy"])
    assert max(worked) > 0.005 * balance.start["kinetic_energy"]
    assert abs(now["contact_work"]) < 1e-3 * max(worked)
    assert balance.energy_error < 1e-12 and balance.momentum_error < 1e-12


def test_a_bounce_costs_little_with_viscosity():
    """In the plane, with the scheme's own viscosity: a slow ball returns most of the kinetic energy."""
    made = collision(radius=4.5, speed=10.0, material=ELASTIC, scheme="tl", contact=CONTACT)
    data = made.finalize()
    solver = Solver(data)
    start = solver.ledger()
    solver.advance(3e-4)
    now = solver.ledger()
    assert momenta(solver)[1] > 0.5 * start["momentum_x"]
    assert now["kinetic_energy"] > 0.8 * start["kinetic_energy"]
    assert abs(now["contact_work"]) < 1e-3 * start["kinetic_energy"]
    assert energy(now) == pytest.approx(energy(start), rel=1e-13)


@pytest.mark.parametrize("scheme", ["tl", "sav1"])
def test_three_bodies_hand_a_push_on(scheme):
    """Newton's cradle: the last one flies off; momentum goes through the one between."""
    made = bars(count=3, scheme=scheme, viscosity_alpha=0.0, viscosity_beta=0.0)
    data = made.finalize()
    solver = Solver(data)
    balance = Balance(data, solver.ledger())
    start = momenta(solver)
    solver.advance(4.5e-4)
    balance.update(solver.ledger())
    found = momenta(solver) / start[0]
    assert found[2] > 0.85 and np.abs(found[:2]).max() < 0.15
    assert balance.energy_error < 1e-12 and balance.momentum_error < 1e-12


@pytest.mark.parametrize("scheme", ["tl", "sav1", "adaptle"])
def test_bodies_do_not_enter_each_other(scheme):
    """Blocks at 2 km/s: k = 0.25 holds them a spacing apart, a contact fifty times as soft lets them in, and says so."""
    depths, gaps = [], []
    for k in (0.25, 0.005):
        made = bars(2, gap=1.2, speed=2000.0, length=12, scheme=scheme, contact=Contact(stiffness=k))
        solver = run(made, 3e-6)
        x, body = by_id(solver, "x")[:, 0] / SPACING, solver.data.body
        depths.append(solver.tally()["interpenetration"])
        gaps.append(x[body == 1].min() - x[body == 0].max())
    assert depths[0] == 0.0 and gaps[0] > 1.0
    assert depths[1] > 0.1 and gaps[1] < 0.9


def test_stiffness_and_modulus_are_two_ways_to_say_it():
    bulk = ELASTIC.density * ELASTIC.bulk_speed**2
    one, two = (
        run(collision(speed=300.0, material=ELASTIC, scheme="tl", contact=contact), 3e-6)
        for contact in (CONTACT, Contact(modulus=0.25 * bulk / SPACING**2))
    )
    np.testing.assert_allclose(by_id(one, "v"), by_id(two, "v"), atol=1e-9 * 300.0)
    assert one.ledger()["contact_work"] == pytest.approx(two.ledger()["contact_work"], rel=1e-9) != 0.0


def test_a_stiff_contact_shortens_the_step():
    steps = []
    for k in (0.25, 25000.0):
        solver = run(bars(2, speed=600.0, scheme="tl", contact=Contact(stiffness=k)), 4e-6)
        steps.append(solver.reading.dt_min)
    assert steps[1] < 0.8 * steps[0]


@pytest.mark.parametrize("precision", REALS)
def test_a_body_is_pressed_against_a_symmetry_plane_and_another(precision):
    """A body between a ram and its mirror image; images of its own body are no contact."""
    made = scene(2, scheme="tl", contact=CONTACT)
    made.add_body("block", Box((0.0, 0.0), (6 * SPACING, 6 * SPACING)), "aluminium")
    ram = Box((7.5 * SPACING, 0.0), (12 * SPACING, 6 * SPACING))
    made.add_body("ram", ram, "aluminium", velocity=(-300.0, 0.0))
    made.add_symmetry_plane("x", 0.0)
    data = made.finalize()
    solver = Solver(data, precision=precision)
    balance = Balance(data, solver.ledger())
    solver.advance(4e-6)
    balance.update(solver.ledger())
    assert by_id(solver, "x")[:, 0].min() > 0.3 * SPACING
    assert np.abs(by_id(solver, "v")[data.body == 0, 0]).mean() > 10.0
    assert balance.energy_error < (1e-13 if precision == "float64" else 1e-5)


def test_the_parts_of_the_energy_are_in_the_ledger():
    """Kinetic energy turns into viscous heat, stored contact energy, and elastic or plastic work: none is negative here."""
    solver = Solver(collision(speed=600.0, scheme="adaptle-as", contact=CONTACT, hourglass=10.0).finalize())
    solver.advance(3e-6)
    now = solver.ledger()
    assert all(now[name] != 0.0 for name in PARTS if name != "artificial_stress_work")
    assert now["viscous_work"] > 0.0 and now["contact_work"] > 0.0
    assert sum(abs(now[name]) for name in PARTS) < now["internal_energy"]
