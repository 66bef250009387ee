"""What a particle's row holds decides which loops it takes part in, and nothing about the sums."""

import numpy as np
import pytest
from test_neighbours import listed
from tools import ELASTIC, REALS, SPACING, by_id, collision, forces, jittered, overwrite, scene

from warpsph.config import Contact, Conversion
from warpsph.kernels.company import ALONE, MIXED, PLAIN
from warpsph.kernels.kernel_type import EULERIAN
from warpsph.search.rows import Rows
from warpsph.solver import Solver

CONTACT = Contact(stiffness=0.25)


def converting(**numerics):
    """Two balls that convert where they meet."""
    numerics = {"scheme": "adaptle-mixed-as", "conversion": Conversion(strain=0.05)} | numerics
    return Solver(collision(2, radius=7, speed=900.0, **numerics).finalize())


def in_order(solver, array):
    return array.numpy()[np.argsort(solver.particles.id.numpy())]


def expected(solver):
    """The company of every particle, from the entries of its row."""
    eulerian, body = by_id(solver, "kernel_type") == EULERIAN, solver.data.body
    separate = solver.data.numerics.contact is not None
    whole, entries = np.zeros(len(body), int), np.zeros(len(body), int)
    for a, b, _ in listed(solver):
        same = body[a] == body[b]
        whole[a] += (eulerian[b] and same) if separate else (eulerian[b] or not same)
        entries[a] += 1
    return np.where(eulerian, np.where(whole == entries, PLAIN, MIXED), np.where(whole > 0, MIXED, ALONE))


@pytest.mark.parametrize("contact", [None, CONTACT])
def test_company_is_that_of_the_row(contact):
    """At the start, after steps in which particles convert without new rows, and after a rebuild."""
    solver, shares = converting(contact=contact), []
    for k in range(1, 9):
        np.testing.assert_array_equal(in_order(solver, solver._work.company), expected(solver))
        solver.advance(k * 3e-7)
        shares.append(solver.tally()["converted_share"])
    solver.relist()
    np.testing.assert_array_equal(in_order(solver, solver._work.company), expected(solver))
    assert 0.0 < shares[-1] < 1.0
    assert {ALONE, MIXED} <= set(solver._work.company.numpy())


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("scheme", ["adaptle", "adaptle-mixed-as"])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_loops_give_what_looking_at_every_pair_gives(dim, scheme, precision):
    """Who is taken for mixed has the same forces, to rounding."""
    made, n = scene(dim, scheme=scheme), {2: 30, 3: 13}[dim]
    made.add_body("block", jittered(dim, n), ELASTIC)
    made.make_eulerian("block", lambda x: x[:, 0] > (0.5 * n - 0.75) * SPACING)
    solver, rng = Solver(made.finalize(), precision=precision), np.random.default_rng(3)
    sig = 1e9 * rng.normal(size=(solver.particles.n, 3, 3))
    overwrite(
        solver,
        sig=sig + sig.swapaxes(1, 2),
        v=rng.uniform(-100.0, 100.0, size=(solver.particles.n, 3)) * (np.arange(3) < dim),
    )
    assert set(solver._work.company.numpy()) == {ALONE, PLAIN, MIXED}
    found = forces(solver)
    solver._work.company.fill_(MIXED)
    eps = {"float64": 2.2e-16, "float32": 1.2e-7}[precision]
    for one, two in zip(found, forces(solver), strict=True):
        np.testing.assert_allclose(one, two, rtol=0.0, atol=50.0 * eps * np.abs(two).max())


def test_strangers_are_counted():
    solver = converting(contact=CONTACT)
    solver.advance(1e-6)
    solver.relist()
    body, count = solver.data.body, np.zeros(len(solver.data.body), int)
    for a, b, _ in listed(solver):
        count[a] += body[a] != body[b]
    np.testing.assert_array_equal(in_order(solver, solver._work.n_strangers), count)
    assert count.any() and not count.all()


def test_new_rows_have_room_before_the_search(monkeypatch):
    """A region that grows: rows appear at every rebuild, and each is searched for once."""
    searches, run = [], Rows._run
    monkeypatch.setattr(Rows, "_run", lambda self, *args: (searches.append(self), run(self, *args)))
    solver = converting(contact=CONTACT)
    rows, builds = solver.neighbours.search, solver.neighbours.builds
    listed_before = solver.neighbours.n_neigh.numpy() > 0
    searches.clear()
    solver.advance(3e-6)
    assert (~listed_before & (solver.neighbours.n_neigh.numpy() > 0)).any()
    assert len([rows for one in searches if one is rows]) == solver.neighbours.builds - builds > 2
