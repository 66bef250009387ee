"""Device memory: what a particle takes, and that thrift changes no number."""

import numpy as np
import pytest
import warp as wp
from tools import PLASTIC, SPACING, by_id, collision, jittered, run, scene

from warpsph import rows
from warpsph.block import Block
from warpsph.cells import FEWEST_CELLS, PER_PARTICLE, count_cells
from warpsph.config import Contact, Conversion
from warpsph.fields import FIELDS
from warpsph.kernels.cells import ALONG, FEWEST
from warpsph.kernels.ledger import SUMS
from warpsph.memory import GENEROUS, THRIFTY, usage
from warpsph.solver import Solver

MOST = 700
"""Bytes that a particle may take in single precision, with its rows: 57 neighbours within the support."""


def block_of(n, precision="float32"):
    """A jittered cube of n³ particles at rest under the policy of a GPU."""
    made = scene(3, scheme="sav1")
    made.add_body("block", jittered(3, n, amount=0.15), "aluminium")
    return Solver(made.finalize(), precision=precision, policy=THRIFTY)


def test_a_particle_in_space_takes_at_most_700_bytes():
    """Rows are counted as if every particle had the neighbours of the middle: the skin of a small cube has fewer."""
    solver = block_of(24)
    n, found = solver.particles.n, usage(solver)
    entries = found.pop("neighbours.block") / n
    counts, x = solver.neighbours.n_neigh.numpy(), solver.particles.x.numpy()
    middle = np.all(np.abs(x - x.mean(axis=0)) < 8 * SPACING, axis=1)
    fixed = sum(value for name, value in found.items() if value >= n) / n  # not what any run has
    assert fixed + entries * counts[middle].mean() / counts.mean() < MOST
    assert solver.mean_neighbours() > 50


def test_usage_counts_every_field_once():
    solver = block_of(6)
    found, n = usage(solver), solver.particles.n
    assert found["particles.dvdx"] == 36 * n and found["particles.tau"] == 24 * n
    assert sum(name.startswith("particles.") for name in found) == len(solver.particles.fields)
    assert found["neighbours.block"] == 4 * solver.neighbours.block.size >= 4 * solver.neighbours.neigh.size


@pytest.mark.parametrize(
    ("scheme", "options"),
    [
        ("sav1", {}),
        ("bal-mixed-as", {"contact": Contact(stiffness=0.25)}),
        ("ts2-mixed", {}),
        ("ts1", {}),
        ("adaptle-mixed", {"conversion": Conversion(strain=0.05), "contact": Contact(stiffness=0.25)}),
        ("adaptle", {"conversion": Conversion(strain=0.05)}),
    ],
)
def test_loops_of_a_gpu_give_the_same_physics(scheme, options):
    """They handle one pair at a time, leave out what is beyond the support, and add in the order of the row."""
    made = collision(2, speed=900.0, scheme=scheme, **options)
    rich, poor = (run(made, 3e-6, policy=policy) for policy in (GENEROUS, THRIFTY))
    assert rich.neighbours.builds == poor.neighbours.builds > 2
    for name in ("x", "v", "rho", "e", "p", "sig", "kernel_type"):
        a, b = by_id(rich, name), by_id(poor, name)
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-9 * np.abs(a).max(), err_msg=name)
    assert poor.neighbours.neigh.size < rich.neighbours.neigh.size


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize("scheme", ["sav1", "ts2", "tl", "adaptle-mixed"])
def test_rows_in_pieces_are_the_same_rows(monkeypatch, scheme, policy):
    """Where there are more particles than one array has entries for."""
    made = collision(
        2, speed=900.0, scheme=scheme, contact=None if scheme == "ts2" else Contact(stiffness=0.25)
    )
    whole = run(made, 2e-6, policy=policy)
    monkeypatch.setattr(rows, "LENGTH", 40)
    cut = run(made, 2e-6, policy=policy, threads=2)
    assert len(cut.neighbours.neigh.arrays) == -(-cut.particles.n // 40) > 2
    for name, values in whole.particles.arrays().items():
        np.testing.assert_array_equal(values, cut.particles.arrays()[name], err_msg=name)


def test_a_lagrangian_body_alone_keeps_no_work_space():
    made = scene(2, scheme="tl")
    made.add_body("block", jittered(2, 12, amount=0.0), "aluminium", velocity=(10.0, 0.0, 0.0))
    solver = run(made, 1e-7)
    assert usage(solver)["neighbours.block"] < solver.particles.n
    assert usage(solver)["reference.rows"] >= 4 * solver.reference.n_neigh0.numpy().sum()


def test_fields_that_a_run_has_no_use_for_take_nothing():
    free, held = collision(2), collision(2)
    held.fix("right", lambda x: x[:, 0] > 0.0)
    free, held = (run(made, 1e-6) for made in (free, held))
    names = {f.name for f in free.particles.fields}
    assert not names & {"fixed", "impulse", "twist", "work", "thickness", "av_switch"}
    assert {f.name for f in held.particles.fields} - names == {"fixed", "impulse", "twist", "work"}
    assert free.particles.e_parts.dtype._shape_ == (1,)  # viscosity alone
    # and yet everything is reported
    assert not free.state().fixed.any() and held.state().fixed.any()
    assert (
        set(free.state().fields)
        == set(held.state().fields)
        >= {f.name for f in FIELDS if f.output and not f.group}
    )
    assert set(free.ledger()) == set(held.ledger()) >= set(SUMS)
    assert free.ledger()["work"] == free.ledger()["contact_work"] == 0.0 != free.ledger()["viscous_work"]


def test_stress_of_the_state_is_a_whole_tensor():
    made = collision(2, material=PLASTIC)
    solver = run(made, 2e-6)
    tau = solver.state().tau
    assert tau.shape == (solver.particles.n, 3, 3) and solver.particles.tau.numpy().shape[1:] == (6,)
    np.testing.assert_array_equal(tau, tau.swapaxes(1, 2))
    assert np.abs(tau[:, 0, 1]).max() > 0.0 == np.abs(tau[:, 2, :2]).max()


def test_views_of_a_block_do_not_overlap():
    block = Block(wp.get_device("cpu"))
    a, b = block.views((wp.int32, 5), (wp.vec3d, 7))
    a.fill_(1)
    b.fill_(2.0)
    assert (a.numpy() == 1).all() and (b.numpy() == 2.0).all() and b.ptr % 64 == block.lines.ptr % 64
    moved, size = block.generation, block.size
    block.views((wp.int32, 3))
    assert (block.generation, block.size) == (moved, size)
    block.grow(size + 1)
    assert block.generation == moved + 1


@pytest.mark.parametrize("n", [100, 100_000])
@pytest.mark.parametrize("extent", [(1.0, 1.0, 1.0), (0.01, 1.0, 1.0), (5.0, 0.1), (1.0,)])
def test_cells_fit_the_scene_and_the_number_of_particles(n, extent):
    dim, spacing = len(extent), (np.prod(extent) / n) ** (1.0 / len(extent))
    x = np.zeros((n, 3))
    x[1, :dim] = extent
    most = max(PER_PARTICLE * n, FEWEST_CELLS)
    needed = np.array([ALONG, 1, 1])[:dim] * extent / (8.0 * spacing)
    for mirrored in ([], [0]):
        found = count_cells(x, dim, 8.0 * spacing, mirrored)
        assert all(c >= few and c & (c - 1) == 0 for c, few in zip(found[:dim], FEWEST, strict=False))
        assert found[dim:] == (1,) * (3 - dim) and most / 2 < np.prod(found) <= most
        images = [2.0 if axis in mirrored else 1.0 for axis in range(dim)]
        assert all(c >= k * size for c, k, size in zip(found, images, needed, strict=False))


def test_cells_of_a_scene_that_is_nearly_empty():
    """Two particles of millimetres, a hundred kilometres apart in all directions."""
    counts = count_cells(np.array([[0.0, 0.0, 0.0], [1e5, 1e5, 1e5]]), 3, 1e-3)
    assert FEWEST_CELLS // 2 < np.prod(counts) <= FEWEST_CELLS
