"""Johnson-Cook damage in a Total Lagrangian run, and particles that leave all lists when they fail."""

import math

import numpy as np
import pytest
from by_hand import gradients
from test_reference import dense
from tools import SPACING, by_id, jittered, one_step, overwrite, run, scene

from warpsph import materials as lib
from warpsph.config import Contact
from warpsph.errors import InputError
from warpsph.kernels.kernel_type import ERODED, LAGRANGIAN
from warpsph.running.balance import Balance
from warpsph.shapes import Box
from warpsph.solver import Solver

PLATE = lib.get("aluminium-jc")
BRITTLE = lib.Material(
    "brittle", PLATE.density, PLATE.eos, PLATE.strength, PLATE.pressure_cutoff, lib.JohnsonCookDamage(D1=0.05)
)


def failing(dim=2, n=9, failed=(), v=None, precision="float64", **numerics):
    """A body some of whose particles have just failed."""
    made = scene(dim, scheme="tl", **({"erosion": True} | numerics))
    made.add_body("body", jittered(dim, n), PLATE, velocity=(0.0, 0.0, 0.0) if v is None else v)
    solver = Solver(made.finalize(), precision=precision)
    D = np.zeros(solver.particles.n)
    D[list(failed)] = 1.0
    overwrite(solver, D=D)
    return solver


def test_damage_is_one_at_the_analytic_strain():
    """A bar drawn out uniformly: D grows by dεp/ε_f and is 1 where εp = ε_f, 5 % here; there the particles erode."""
    rate, n = 2e4, 12
    made = scene(1, scheme="tl", erosion=True)
    made.add_body("bar", jittered(1, n, 0.0), BRITTLE, velocity=lambda x: rate * x)
    made.fix("bar")
    solver = Solver(made.finalize())
    seen = []

    def look(now):
        seen.append(
            (by_id(solver, "ep").copy(), by_id(solver, "D").copy(), by_id(solver, "kernel_type").copy())
        )

    solver.advance(0.2 / rate, look)
    ep, D, kind = (np.array(part)[:, n // 2] for part in zip(*seen, strict=True))
    whole = D < 1.0
    np.testing.assert_allclose(D[whole], ep[whole] / 0.05, rtol=1e-9, atol=1e-12)
    assert whole.any() and not whole.all()
    np.testing.assert_array_equal(kind == ERODED, ~whole)
    assert ep[~whole][0] == pytest.approx(0.05, abs=0.01)
    assert (ep[~whole] == ep[~whole][0]).all(), "no more flow after that"


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_no_list_holds_an_eroded_particle(dim):
    """No gradient names it, and those of its neighbours are corrected without it."""
    n = {1: 20, 2: 9, 3: 6}[dim]
    gone = [3, n, n**dim // 2] if dim > 1 else [3, n // 2]
    solver = one_step(failing(dim, n, gone))
    there, back = dense(solver)
    left = np.ones(n**dim, dtype=bool)
    left[gone] = False
    assert not there[:, gone].any() and not back[left][:, gone].any()
    X = solver.data.x
    g = gradients(X, by_id(solver, "vol0"), dim, solver.data.h, True, others=left)
    expected = SPACING**dim * g[left]
    expected[:, gone] = 0.0
    assert np.isfinite(there).all()
    np.testing.assert_allclose(there[left], expected, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_an_eroded_particle_flies_on(precision):
    """Without stress, at constant velocity and energy; mass, momentum and energy are kept, the others' F stays finite."""
    rng, n = np.random.default_rng(2), 9
    v = np.zeros((n * n, 3))
    v[:, :2] = rng.uniform(-150.0, 150.0, size=(n * n, 2))
    gone = [12, 13, 40, 41, 80]
    solver = failing(2, n, gone, v, precision)
    solver.advance(1e-9)
    assert (by_id(solver, "kernel_type")[gone] == ERODED).all()
    balance = Balance(solver.data, solver.ledger())
    before = {name: by_id(solver, name)[gone].copy() for name in ("x", "v", "e", "m", "F")}
    t0 = solver.reading.time
    solver.advance(4e-6)
    balance.update(solver.ledger())
    for name in ("v", "e", "m", "F"):
        np.testing.assert_array_equal(by_id(solver, name)[gone], before[name])
    way = (solver.reading.time - t0) * before["v"]
    atol = 1e-15 if precision == "float64" else 1e-8
    np.testing.assert_allclose(by_id(solver, "x")[gone] - before["x"], way, atol=atol)
    for name in ("tau", "sig", "p", "dvdt"):
        assert not by_id(solver, name)[gone].any()
    for name in ("F", "v", "sig", "rho"):
        assert np.isfinite(by_id(solver, name)).all()
    limit = 1e-13 if precision == "float64" else 1e-5
    assert balance.energy_error < limit and balance.momentum_error < limit
    assert solver.tally()["eroded"] == len(gone)


def test_a_particle_all_of_whose_neighbours_are_gone_flies_alone():
    gone = [k for k in range(81) if k != 40]
    solver = failing(2, 9, gone, v=(100.0, 0.0, 0.0))
    solver.advance(1e-6)
    assert by_id(solver, "kernel_type")[40] == LAGRANGIAN
    np.testing.assert_array_equal(by_id(solver, "v")[40], [100.0, 0.0, 0.0])
    np.testing.assert_array_equal(by_id(solver, "F")[40], np.eye(3))


def test_without_erosion_damage_removes_nothing():
    solver = one_step(failing(failed=[5], erosion=False))
    assert (by_id(solver, "kernel_type") == LAGRANGIAN).all() and solver.tally()["eroded"] == 0


def test_a_plate_is_perforated():
    """A ball goes through a thin brittle plate in contact; what is eroded feels no contact any more."""
    made = scene(2, scheme="tl", erosion=True, contact=Contact(stiffness=0.25))
    ball = Box((-9 * SPACING, -3 * SPACING), (-2 * SPACING, 3 * SPACING))
    made.add_body("ball", ball, "steel-jc", velocity=(900.0, 0.0))
    made.add_body("plate", Box((0.0, -12 * SPACING), (3 * SPACING, 12 * SPACING)), BRITTLE)
    made.fix("plate", lambda x: abs(x[:, 1]) > 11 * SPACING)
    data = made.finalize()
    solver = Solver(data)
    balance = Balance(data, solver.ledger())
    solver.advance(2e-5)
    balance.update(solver.ledger())
    kind, body, x = by_id(solver, "kernel_type"), data.body, by_id(solver, "x")
    assert (kind[body == 1] == ERODED).sum() > 5 and (kind[body == 0] == LAGRANGIAN).all()
    assert x[body == 0, 0].max() > 5 * SPACING
    rows = solver.neighbours
    assert not rows.n_neigh.numpy()[solver.particles.kernel_type.numpy() == ERODED].any()
    assert balance.energy_error < 1e-13 and balance.momentum_error < 1e-12
    assert math.isfinite(solver.tally()["interpenetration"])


def test_erosion_needs_a_material_that_fails():
    with pytest.raises(InputError, match=r"erosion = True needs a material that fails.*'aluminium'"):
        made = scene(2, scheme="tl", erosion=True)
        made.add_body("body", jittered(2, 4), "aluminium")
        run(made, 1e-9)
