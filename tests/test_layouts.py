"""Trials of data layouts: all of them give the same forces, and rows have their places."""

import numpy as np
import pytest

from warpsph.device.launch import Launcher
from warpsph.kernels.layouts import LISTS, Layout
from warpsph.quality.layouts import (
    Bench,
    Block,
    Counts,
    Trial,
    cells,
    place_rows,
    predict,
    run_trials,
    trials,
)

BLOCK = Block(7)


def forces(layout, precision="float64"):
    return Bench(Launcher("cpu", 1), BLOCK, Trial(precision, layout)).forces()


@pytest.fixture(scope="module")
def expected():
    return forces(Layout("rows", 9))


@pytest.mark.parametrize(
    "layout", [Layout(name, 6) for name in LISTS] + [Layout("columns", 6, short=True)], ids=lambda s: s.tag
)
def test_every_layout_gives_the_same_forces(expected, layout):
    """To rounding; in the same order they are the same bits but for the stress's product."""
    for found, known in zip(forces(layout), expected, strict=True):
        np.testing.assert_allclose(found, known, atol=1e-12 * np.abs(known).max(), rtol=0)


@pytest.mark.parametrize(
    "layout", [Layout("cells", 9), Layout("columns", 9), Layout("rows", 9, short=True)], ids=lambda s: s.tag
)
def test_the_same_order_gives_the_same_bits(expected, layout):
    for found, known in zip(forces(layout), expected, strict=True):
        np.testing.assert_array_equal(found, known)


def test_wide_positions_keep_their_digits_far_from_the_origin():
    far = Block(5)
    far.x, far.low = far.x + 1.0, far.low + 1.0  # a thousand spacings away

    def found(precision, **layout):
        return Bench(Launcher("cpu", 1), far, Trial(precision, Layout("rows", 6, **layout))).forces()[0]

    known = found("float64")
    narrow, wide = (
        np.abs(found("float32", wide=flag) - known).max() / np.abs(known).max() for flag in (False, True)
    )
    assert wide < 2e-6 and narrow > 20.0 * wide


def test_momentum_is_conserved(expected):
    """Every pair is seen from both sides."""
    total = expected[0].sum(axis=0)
    np.testing.assert_allclose(total, 0.0, atol=1e-11 * np.abs(expected[0]).sum())


def test_inside_a_particle_has_about_60_neighbours():
    bench = Bench(Launcher("cpu", 1), Block(11), Trial("float64", Layout("rows")))
    bench._search(2.0)
    counts, x = bench.arrays.n_neigh.numpy(), bench._block.x
    middle = np.abs(x - 5e-3).max(axis=1) < 2e-3
    assert counts[middle].mean() == pytest.approx(60, abs=3)


@pytest.mark.parametrize("group", [1, 4])
def test_no_two_entries_share_a_place(group):
    counts = np.array([3, 0, 5, 1, 2, 2])
    start, total = place_rows(counts, group)
    places = np.concatenate([s + group * np.arange(c) for s, c in zip(start, counts, strict=True)])
    assert len(np.unique(places)) == counts.sum() and places.max() < total


def test_sixteen_bits_that_do_not_hold_are_refused(monkeypatch):
    monkeypatch.setattr("warpsph.quality.layouts.np.iinfo", lambda _: type("Small", (), {"max": 10}))
    bench = Bench(Launcher("cpu", 1), BLOCK, Trial("float64", Layout("rows", short=True)))
    assert "more than 16 bits hold" in bench.why_not


def test_a_row_of_the_table():
    seen = []
    rows = run_trials("cpu", 200, [Trial("float64", Layout("columns", 6))], threads=1, on_row=seen.append)
    assert seen == rows and rows[0]["n"] == 216 and rows[0]["ns_per_particle"] > 0.0
    assert cells(rows[0])[:2] == ["float64", "columns_s6"]
    assert run_trials("cpu", 200, list(trials()), deadline=0.0) == []


def test_the_prediction_knows_what_costs():
    """Fewer numbers to gather cannot be slower, nor can double precision be faster."""
    counts = Counts(57.0, 99.0)

    def speed(precision, **layout):
        return predict(Trial(precision, Layout(**layout)), counts)["pairs_per_s"]

    for lists in LISTS:
        assert speed("float32", lists=lists, stress=6) >= speed("float32", lists=lists, stress=9)
        assert speed("float32", lists=lists) > speed("float64", lists=lists)
    assert speed("float32", lists="columns") >= speed("float32", lists="rows")
