"""Neighbour rows of scenes with Lagrangian particles: where they are needed, complete, and nowhere else."""

import numpy as np
import pytest
from test_neighbours import expected, listed
from tools import ELASTIC, REALS, SPACING, by_id, collision, jittered, scene

from warpsph.config import Contact, Conversion
from warpsph.kernels.kernel_type import ERODED, EULERIAN
from warpsph.kernels.timestep import RUNNING
from warpsph.solver import Solver

CONTACT = Contact(stiffness=0.25)


def usable(solver):
    """Whether the next step would be taken with the rows as they are."""
    solver._clock.stop_at(1.0)
    return solver._plan().status == RUNNING


def assert_enough(solver):
    """Every pair within the support that any sum looks at: one member is Eulerian, or they are of two bodies."""
    kind, body = by_id(solver, "kernel_type"), solver.data.body
    near = {
        (a, b, mask)
        for a, b, mask in expected(solver, 2.0 * solver.data.h)
        if (kind[a] == EULERIAN or kind[b] == EULERIAN or body[a] != body[b])
        and kind[a] != ERODED
        and kind[b] != ERODED
    }
    assert near <= listed(solver)
    return near


def mixed(dim, n, **numerics):
    """A body with an Eulerian corner."""
    made = scene(dim, scheme="adaptle", **numerics)
    made.add_body("body", jittered(dim, n), ELASTIC)
    made.make_eulerian("body", lambda x: (x[:, :dim] < 3.5 * SPACING).all(axis=1))
    return made


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize(("dim", "n"), [(1, 400), (2, 30), (3, 13)])
def test_rows_around_an_eulerian_region(dim, n, precision):
    """Its pairs are all there, and the Lagrangian rest far from it has none."""
    solver = Solver(mixed(dim, n).finalize(), precision=precision)
    assert assert_enough(solver)
    count = solver.neighbours.n_neigh.numpy()[np.argsort(solver.particles.id.numpy())]
    eulerian = by_id(solver, "kernel_type") == EULERIAN
    assert (count[eulerian] > 0).all() and (count > 0).mean() < 0.65
    far = (solver.data.x[:, :dim] > (n - 1.8) * SPACING).all(axis=1)
    assert far.any() and not count[far].any()


@pytest.mark.parametrize("dim", [2, 3])
def test_rows_where_bodies_come_near(dim):
    """Two Lagrangian bodies approach: their rows are there before they touch, near the gap only, in every step."""
    made = collision(dim, radius={2: 8, 3: 5}[dim], speed=500.0, scheme="tl", contact=CONTACT)
    solver = Solver(made.finalize())
    met = 0
    for k in range(1, 8):
        solver.advance(k * 4e-7)
        if usable(solver):
            met = max(met, len(assert_enough(solver)))
    assert met > 10
    assert not solver.neighbours.n_neigh.numpy()[solver.neighbours.role.numpy() == 0].any()
    assert (solver.neighbours.role.numpy() == 0).mean() > 0.1


def test_rows_hold_mirror_images():
    made = mixed(2, 14)
    for axis in "xy":
        made.add_symmetry_plane(axis, -0.7 * SPACING)
    solver = Solver(made.finalize())
    assert any(mask for _, _, mask in assert_enough(solver))


def test_rows_follow_what_converts():
    """A body that converts from one end on while it moves and spins."""
    spin = np.array([0.0, 0.0, 2e4])
    made = scene(2, scheme="adaptle", conversion=Conversion(strain=0.02))
    made.add_body(
        "body", jittered(2, 20), ELASTIC,
        velocity=lambda x: np.cross(spin, x) + np.where(x[:, :1] < 4.0 * SPACING, -1e5, 0.0) * x * [1.0, 0.0, 0.0],
    )  # fmt: skip
    solver, shares = Solver(made.finalize()), []
    for k in range(1, 9):
        solver.advance(k * 5e-7)
        if usable(solver):
            assert_enough(solver)
        shares.append(solver.tally()["converted_share"])
    assert 0.0 < shares[-1] < 1.0


def test_lagrangian_particles_are_sorted_once():
    """Reference neighbours are named by their place in memory: many rebuilds, always the same order."""
    made = collision(radius=6, speed=500.0, scheme="tl", contact=CONTACT, skin=0.05)
    solver = Solver(made.finalize())
    order = solver.particles.id.numpy().copy()
    for _ in range(45):
        solver.relist()
    solver.advance(2e-6)
    assert solver.neighbours.builds > 45
    np.testing.assert_array_equal(solver.particles.id.numpy(), order)


def test_a_lagrangian_body_wears_nothing_far_from_what_is_listed():
    """The far end of a long body is squeezed by spacings while its Eulerian end stays: no row grows old."""
    made = scene(2, scheme="adaptle")
    far = 40.0 * SPACING
    made.add_body(
        "body", jittered(2, 50), ELASTIC,
        velocity=lambda x: np.where(x[:, :1] > far, -100.0 * (x[:, :1] - far) / SPACING, 0.0) * [1.0, 0.0, 0.0],
    )  # fmt: skip
    made.fix("body")
    made.make_eulerian("body", lambda x: x[:, 0] < 3.5 * SPACING)
    solver = Solver(made.finalize())
    solver.advance(3e-6)
    assert np.abs(by_id(solver, "x") - solver.data.x).max() > 2.0 * SPACING
    assert solver.neighbours.builds == 1 and solver.reading.wear < 0.2
