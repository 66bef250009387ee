"""Neighbour rows: complete after any motion, whatever the skin."""

import numpy as np
import pytest
from tools import DOUBLE, ELASTIC, REALS, SPACING, body, by_id, collision, jittered, run, scene

from warpsph.kernels.mirror import INDEX_BITS
from warpsph.kernels.spec import COLUMNS
from warpsph.memory.policy import GENEROUS, THRIFTY
from warpsph.search import cells
from warpsph.solver import Solver

MARGIN = 1e-5
"""Pairs within this share of the rows' reach from it may count or not, as round-off has it."""


def listed(solver):
    """Every entry as (id, id of the neighbour, reflections)."""
    rows, ids = solver.neighbours, solver.particles.id.numpy()
    start, count, entries = rows.start.numpy(), rows.n_neigh.numpy(), rows.neigh.numpy()
    columns = solver.particles.spec.columns
    places = np.concatenate([s + columns * np.arange(c) for s, c in zip(start, count, strict=False)])
    assert len(places) == len(np.unique(places)), "two rows share a place"
    found = [
        (ids[i], ids[entry & ((1 << INDEX_BITS) - 1)], entry >> INDEX_BITS)
        for i, entry in zip(np.repeat(np.arange(len(ids)), count), entries[places], strict=True)
    ]
    assert len(found) == len(set(found)), "a neighbour is listed twice"
    return set(found)


def expected(solver, reach):
    """The same by brute force, for every combination of reflections."""
    x, planes, found = by_id(solver, "x"), solver.data.planes, set()
    for mask in range(8):
        if any(mask >> axis & 1 and axis not in dict(planes) for axis in range(3)):
            continue
        image = x.copy()
        for axis, at in planes:
            if mask >> axis & 1:
                image[:, axis] = 2.0 * at - image[:, axis]
        distance = np.linalg.norm(x[:, None] - image, axis=2)
        pairs = zip(*np.nonzero(distance < reach), strict=True)
        found |= {(i, j, mask) for i, j in pairs if i != j or mask}
    return found


def assert_complete(solver):
    rows, radius = listed(solver), solver.neighbours.radius
    assert expected(solver, radius * (1.0 - MARGIN)) <= rows <= expected(solver, radius * (1.0 + MARGIN))


@pytest.mark.parametrize("scheme", ["sav1-mixed-as", "mon-mixed-as", "ts2-mixed", "pm"])
def test_where_particles_are_in_memory_changes_nothing_but_rounding(scheme, monkeypatch):
    """Nothing that one step leaves to the next is forgotten when they are sorted."""
    made, found = collision(scheme=scheme, speed=1000.0, skin=0.1), []
    for every in (2, 10**9):
        monkeypatch.setattr("warpsph.search.neighbours.SORT_EVERY", every)
        found.append(run(made, 3e-6))
    assert found[0].neighbours.builds > 15
    for name, scale in (("x", SPACING), ("v", 1000.0), ("e", 5e5)):
        error = np.abs(by_id(found[0], name) - by_id(found[1], name)).max()
        assert error < 1e-10 * scale, name


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize("precision", [*REALS, "mixed"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_rows_hold_every_pair(dim, precision, policy):
    n = {1: 60, 2: 12, 3: 6}[dim]
    solver = body(dim, jittered(dim, n, 0.4), precision=precision, policy=policy)
    assert_complete(solver)
    moved = by_id(solver, "x")[solver.particles.id.numpy()]
    moved[:, :dim] *= np.random.default_rng(1).uniform(0.5, 2.0, size=(len(moved), dim))
    solver.particles.x.assign(moved)
    for _ in range(7):  # re-sorted in memory at some of them
        solver.relist()
    assert_complete(solver)


@pytest.mark.parametrize("dim", DOUBLE)
def test_rows_where_cells_repeat_within_the_scene(monkeypatch, dim):
    monkeypatch.setattr(cells, "PER_PARTICLE", 0)
    monkeypatch.setattr(cells, "FEWEST_CELLS", 256)
    solver = body(dim, jittered(dim, {1: 300, 2: 40, 3: 9}[dim]))
    solver.particles.x.assign(3.0 * solver.particles.x.numpy())
    solver.relist()
    turns = (
        np.ptp(by_id(solver, "x"), axis=0)
        * solver.neighbours.cells.cell_scale
        / solver.neighbours.cells.period
    )
    assert (turns[:dim] > 1.0).all()
    assert_complete(solver)


@pytest.mark.parametrize("shift", [-1e4, 1e12])
@pytest.mark.parametrize("dim", DOUBLE)
def test_rows_far_from_the_origin(dim, shift):
    """Also where coordinates in cells are too large for an integer: all particles then are in one cell."""
    x = jittered(dim, {1: 60, 2: 12, 3: 6}[dim]) + shift * SPACING * (np.arange(3) < dim)
    assert_complete(body(dim, x))


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_rows_grow_where_particles_clump(dim, policy):
    solver = body(dim, jittered(dim, {1: 60, 2: 12, 3: 6}[dim]), policy=policy)
    before = len(listed(solver))
    solver.particles.x.assign(0.4 * solver.particles.x.numpy())
    solver.relist()
    assert len(listed(solver)) > 2 * before
    assert_complete(solver)


def test_rows_of_a_warp_stand_side_by_side():
    """The k-th entries of 32 particles are next to each other, and the next 32 have rows of their own."""
    rows = body(2, jittered(2, 12), policy=THRIFTY).neighbours
    start, count, n = rows.start.numpy(), rows.n_neigh.numpy(), 12 * 12
    group = np.arange(n) // COLUMNS
    np.testing.assert_array_equal(start[:n] - start[group * COLUMNS], np.arange(n) % COLUMNS)
    ends = np.append(start[COLUMNS:n:COLUMNS], start[n])
    room = (ends - start[:n:COLUMNS]) // COLUMNS
    longest = np.maximum.reduceat(count, np.arange(0, n, COLUMNS))
    np.testing.assert_array_equal(room, longest + longest // THRIFTY.divisor + THRIFTY.spare)
    assert rows.neigh.size >= start[n]


@pytest.mark.parametrize("axes", ["x", "xy", "xyz"])
def test_rows_hold_mirror_images(axes):
    dim = max(2, len(axes))
    made = scene(dim)
    x = jittered(dim, 5)
    made.add_body("body", x - x.min(axis=0) + 0.4 * SPACING * (np.arange(3) < dim), ELASTIC)
    for axis in axes:
        made.add_symmetry_plane(axis, 0.0)
    solver = Solver(made.finalize())
    assert {mask for _, _, mask in listed(solver)} == set(range(2 ** len(axes)))
    assert_complete(solver)


def test_mean_neighbours_counts_those_in_the_support():
    solver = body(1, jittered(1, 20, 0.0), smoothing_ratio=1.2)  # support 2.4 spacings: two on either side
    assert solver.mean_neighbours() == pytest.approx((16 * 4 + 2 * 2 + 2 * 3) / 20)
    assert_complete(solver)


@pytest.mark.parametrize("skin", [0.4, 2.0])
def test_the_skin_changes_nothing(skin):
    time = 4e-6
    with_skin, without = (run(collision(speed=1000.0, skin=s), time) for s in (skin, 0.0))
    steps = without.reading.steps
    assert steps == with_skin.reading.steps > 25
    assert without.neighbours.builds >= steps > 4 * with_skin.neighbours.builds
    for name, scale in (("x", SPACING), ("v", 1000.0), ("p", 1e9), ("e", 1e6)):
        np.testing.assert_allclose(by_id(with_skin, name), by_id(without, name), atol=1e-10 * scale)


def meeting(skin):
    """Blocks that meet across a void, and one particle, much faster, that comes from far away."""
    made = scene(2, skin=skin)
    grid = np.stack(np.meshgrid(np.arange(8.0), np.arange(8.0)), axis=-1).reshape(-1, 2)
    for name, shift, velocity in (
        ("left", (-40.0, 0.0), (3000.0, 0.0)),
        ("right", (40.0, 0.0), (-3000.0, 0.0)),
        ("jet", (3.5, 400.0), (0.0, -30000.0)),
    ):
        points = SPACING * ((grid if name != "jet" else np.zeros((1, 2))) + shift)
        made.add_body(name, points, "aluminium", velocity=velocity)
    return made


def test_nothing_arrives_unnoticed():
    """The jet crosses several skins between two looks of the host, and hits the blocks just when they meet."""
    time = 16e-6
    late, always = (run(meeting(skin), time) for skin in (2.0, 0.0))
    assert late.neighbours.builds < 0.5 * late.reading.steps
    v = by_id(always, "v")
    assert abs(v[-1, 1]) < 25000.0 and (np.abs(v[:64, 0]) < 2500.0).sum() > 20, "they have met"
    np.testing.assert_allclose(by_id(late, "v"), v, atol=1e-7)
    np.testing.assert_allclose(by_id(late, "x"), by_id(always, "x"), atol=1e-9 * SPACING)


def test_no_image_arrives_unnoticed():
    """A block flies at a plane: no particle comes nearer to another, but each does to the images."""
    states = []
    for skin in (2.0, 0.0):
        made = scene(2, skin=skin)
        made.add_body(
            "block",
            jittered(2, 8) + SPACING * np.array([0.0, 30.0, 0.0]),
            "aluminium",
            velocity=(0.0, -2000.0),
        )
        made.add_symmetry_plane("y", 0.0)
        states.append(run(made, 20e-6))
    late, always = states
    assert late.neighbours.builds < 0.5 * late.reading.steps
    v = by_id(always, "v")
    assert (v[:, 1] > -1000.0).sum() > 10, "it has hit its image"
    np.testing.assert_allclose(by_id(late, "v"), v, atol=1e-6)
