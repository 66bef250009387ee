"""The comparison: its figures are plausible, a peer takes its turns, and the report lands between the markers."""

import json
import shlex
import sys

import pytest

from warpsph import library
from warpsph.errors import InputError, RunError
from warpsph.quality import compare, lagrangian_costs, report, series
from warpsph.quality.peer import Peer
from warpsph.quality.stopwatch import ROWS

FACTS = {"code": "Other", "version": "1.0", "ns_per_particle_step": 1000.0, "threads": 1, "particles": 42}


def command(code: str) -> str:
    """A command that runs a line of Python."""
    return f"{sys.executable} -c {shlex.quote(code)}"


PEER = command(f"print('chatter'); print({json.dumps(json.dumps(FACTS))})")


@pytest.fixture
def coarse(monkeypatch):
    """The two-dimensional case with few particles and steps."""
    scene = library.load("hvi_2d").build(scheme=compare.SCHEME, spacing=4e-4)
    monkeypatch.setattr(compare, "impact_2d", lambda: scene)
    monkeypatch.setattr(series, "WARM_UP", 3)
    monkeypatch.setattr(series, "STEPS", 6)
    monkeypatch.setattr(compare, "PRECISIONS", ("float64",))
    return scene


@pytest.fixture
def page(tmp_path, monkeypatch):
    """A page of benchmarks in a checkout of its own."""
    (tmp_path / "docs").mkdir()
    path = tmp_path / "docs" / "benchmarks.md"
    path.write_text("before\n<!-- begin cpu -->\nold\n<!-- end cpu -->\nafter\n")
    monkeypatch.setattr(report, "checkout", lambda: tmp_path)
    return path


def test_report_with_a_peer(coarse, page):
    text = compare.compare("cpu", peers=[PEER], repeats=2)
    written = page.read_text()
    assert written.startswith("before\n<!-- begin cpu -->\n- date: ") and written.endswith(
        "<!-- end cpu -->\nafter\n"
    )
    assert "old" not in written
    for name in ("momentum", "velocity_gradient", "constitutive", ROWS, "Other 1.0", "times faster"):
        assert name in text and name in written


def test_figures_are_plausible(coarse):
    data, variant = coarse.finalize(), compare.Variant("cpu", "float64", 1)
    (row,) = compare._in_turn("2D impact", data, [variant], [], 3, lambda text: None)
    assert len(row.ns) == 3 and 10.0 < min(row.ns) < 1e6
    assert series.STEPS <= row.steps and 15.0 < row.neighbours < 25.0
    whole = compare._whole("2D impact", coarse_end(coarse), variant, lambda text: None)
    assert whole.steps > row.steps and len(whole.cells()) == len(compare.HEADER)


def test_whole_time_is_compared_too(coarse, page):
    coarse.until = 4e-7
    text = compare.compare("cpu", peers=[PEER], repeats=1, full=True)
    assert text.count("all 0.4 µs") >= 2 and text.count("Other 1.0") == 2


def test_at_the_step_of_a_peer(coarse):
    data = compare.at_step(coarse.finalize(), 1e-9)
    solver = compare.Variant("cpu", "float64", 1).solver(data)
    solver.advance(1.0, lambda now: True)
    assert solver.reading.dt_max == pytest.approx(1e-9, rel=1e-6)


def coarse_end(scene):
    """The scene's data with a short end time."""
    scene.until = 4e-7
    return scene.finalize()


def test_peer_is_compared_with_as_many_threads():
    rows = [
        compare.Series("2D impact", "w", compare.Variant("cpu", "float64", n), 42, ns=[250.0 * n])
        for n in (1, 2)
    ]
    peer = Peer(PEER)
    peer.measure()
    (only,) = compare._comparison([peer], rows)
    assert only[-1] == "4.00" and len(only) == len(compare.PEER_HEADER)


@pytest.mark.parametrize(
    ("peer", "error", "message"),
    [
        ("no-such-program", InputError, "cannot be run: No such file"),
        ("", InputError, "cannot be run"),
        ("python 'open", InputError, "cannot be run: No closing quotation"),
        (command("print('hello')"), InputError, "printed 'hello' last; allowed: one line of JSON"),
        (command("print({})"), InputError, "printed '{}' last"),
        (command("raise SystemExit('out of paper')"), RunError, "failed with exit code 1: out of paper"),
    ],
)
def test_peer_that_does_not_do(peer, error, message):
    with pytest.raises(error, match=message):
        Peer(peer).measure()


@pytest.mark.parametrize("arguments", [{"repeats": 0}, {"repeats": -1}])
def test_bad_arguments(arguments):
    with pytest.raises(InputError, match="is out of range; allowed: "):
        compare.compare("cpu", **arguments)


def test_report_needs_its_markers(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("<!-- end cpu --> <!-- begin cpu -->")
    with pytest.raises(InputError, match="has no place for the report"):
        report.write_section(page, "cpu", "text")


PLATE = FACTS | {"case": "plate", "neighbours": 50.0, "ranks": 1}


@pytest.fixture
def coarse_plate(monkeypatch):
    """The plate with few particles, and a window soon after the start."""
    monkeypatch.setattr(lagrangian_costs, "SPACING", 3e-3)
    monkeypatch.setattr(lagrangian_costs, "LATER", 2e-6)
    monkeypatch.setattr(lagrangian_costs, "SCHEMES", ("sav1", "tl", "adaptle"))
    monkeypatch.setattr(series, "WARM_UP", 2)
    monkeypatch.setattr(series, "STEPS", 4)
    monkeypatch.setattr(compare, "PRECISIONS", ("float64",))
    monkeypatch.setattr(compare, "count_cores", lambda: 1)


def test_lagrangian_steps_beside_eulerian_ones(coarse_plate, page):
    page.write_text("<!-- begin lagrangian -->\n<!-- end lagrangian -->\n")
    code = f"print({json.dumps(json.dumps({k: v for k, v in PLATE.items() if k != 'threads'}))})"
    text = compare.compare("cpu", peers=[command(code)], lagrangian=True, repeats=1)
    rows = [line.split() for line in text.splitlines() if line.startswith(("sav1 ", "tl ", "adaptle "))]
    assert [row[0] for row in rows] == ["sav1", "tl", "adaptle"] * 2
    assert rows[0][-3:-1] == ["100.0%", "100.0%"] and rows[1][-3] == "0.0%"
    assert "Other 1.0" in page.read_text() and "per pair" in text


def test_full_does_not_go_with_the_plate():
    with pytest.raises(InputError, match="--full does not go with --lagrangian"):
        compare.compare("cpu", lagrangian=True, full=True)


def test_a_peer_of_another_case_is_refused(coarse_plate):
    peer = command(f"print({json.dumps(json.dumps(FACTS | {'case': 'ring'}))})")
    with pytest.raises(InputError, match="names case 'ring'; allowed beside Lagrangian steps: plate, taylor"):
        compare.compare("cpu", peers=[peer], lagrangian=True, repeats=1)
