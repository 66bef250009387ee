"""Groups, extents and gaps; and that a measure's peak survives an interruption."""

import numpy as np
import pytest
from states import impact

from warpsph.measure import extent, groups, once, widest_gap
from warpsph.scene import Scene
from warpsph.shapes import Box


def points(*x):
    return np.array([(value, 0.0, 0.0) for value in x])


def brute_force(x, distance):
    """Sets of indices, by walking from neighbour to neighbour."""
    near = np.linalg.norm(x[:, None] - x, axis=2) <= distance
    left, found = set(range(len(x))), []
    while left:
        todo, piece = [left.pop()], set()
        while todo:
            i = todo.pop()
            piece.add(i)
            new = left & set(np.flatnonzero(near[i]))
            left -= new
            todo += new
        found.append(frozenset(piece))
    return found


def test_groups_are_numbered_by_falling_size():
    assert groups(points(9.0, 0.0, 1.0, 5.0, 2.0, 5.5, 20.0), 1.5).tolist() == [2, 0, 0, 1, 0, 1, 3]


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("real", [np.float64, np.float32])
def test_groups_against_brute_force(dim, real):
    x = np.zeros((300, 3), dtype=real)
    x[:, :dim] = np.random.default_rng(dim).random((300, dim))
    distance = 0.6 / 300 ** (1 / dim)
    label = groups(x, distance)
    sets = brute_force(x, distance)
    assert len(sets) > 10
    assert {frozenset(np.flatnonzero(label == k)) for k in range(label.max() + 1)} == set(sets)
    assert np.all(np.diff(np.bincount(label)) <= 0)


def test_groups_leave_out_points_that_are_nowhere():
    assert groups(points(0.0, np.nan, 0.1, np.inf), 1.0).tolist() == [0, -1, 0, -1]
    assert groups(points(np.nan), 1.0).tolist() == [-1]
    assert groups(np.zeros((0, 3)), 1.0).shape == (0,)


def test_extent():
    assert extent(np.array([2.0, -1.0, 0.5])) == 3.0
    assert np.isnan(extent(np.array([])))


def test_widest_gap():
    assert widest_gap(np.array([0.0, 5.0, 1.0, 6.0]), closed=1.5) == 4.0
    assert widest_gap(np.array([0.0, 2.0, 1.0]), closed=1.5) == 0.0
    assert widest_gap(np.array([]), closed=1.5) == widest_gap(np.array([3.0]), closed=1.5) == 0.0


def test_widest_gap_of_each_slice():
    y = np.array([0.0, 10.0, 4.0, 7.0])
    assert widest_gap(y, closed=1.0, apart=np.array([0, 1, 0, 1])) == 4.0


def test_once_looks_at_each_state_once():
    seen = []
    mean = once(lambda state: seen.append(state.time) or state.time)
    first, second = impact(time=0.0), impact(time=1.0)
    assert [mean(first), mean(first), mean(second), mean(first)] == [0.0, 0.0, 1.0, 0.0]
    assert seen == [0.0, 1.0, 0.0]


def test_peak_of_a_measure_survives_a_restart(tmp_path):
    """The highest value lies before the restart; it is in the summary after it."""
    from warpsph.run import resume, run

    source = (
        "from warpsph.scene import Scene\nfrom warpsph.shapes import Box\n\n\n"
        "def build():\n"
        "    scene = Scene('slide', dim=1, spacing=1e-3, until=1e-6, snapshots=4)\n"
        "    scene.add_body('rod', Box(0.0, 1e-2), 'aluminium', velocity=(-100.0,))\n"
        "    scene.add_measure('front', lambda state: state.x[:, 0].max(), 'm')\n"
        "    scene.add_measure('highest', lambda state: state.x[:, 0].max(), 'm', peak=True)\n"
        "    return scene\n"
    )
    space = {}
    exec(source, space)
    first = run(space["build"](), tmp_path / "run", source=source, frames=False)["measures"]
    assert first["highest"] == pytest.approx(9.5e-3) and first["front"] < 9.45e-3
    second = resume(tmp_path / "run", until=2e-6, frames=False)["measures"]
    assert second["highest"] == first["highest"] and second["front"] < first["front"]


def test_peak_is_off_by_default():
    scene = Scene("rod", dim=1, spacing=1e-3, until=1e-6)
    scene.add_body("rod", Box(0.0, 1e-2), "aluminium")
    scene.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    assert not scene.finalize().measures["front"].peak
