"""The launches of a step, replayed from a captured graph: the same bits as one by one, on a CPU as on a GPU."""

import numpy as np
import pytest
import warp as wp
from tools import by_id, collision, run

from warpsph.device.blocks import FOLDS, Blocks
from warpsph.device.launch import Command, Launcher
from warpsph.device.program import Program
from warpsph.device.score import Score
from warpsph.kernels.spec import Spec
from warpsph.kernels.team import make_team
from warpsph.solver import Solver

SCHEMES = ("sav1-mixed-as", "ts2", "adaptle-as")


@wp.kernel(module="unique", enable_backward=False)
def turned_around(offset: wp.int32, n: wp.int32, source: wp.array[wp.int32], target: wp.array[wp.int32]):
    i = wp.tid() + offset
    target[i] = 2 * target[i] + source[n - 1 - i] % 1000 + i


def solver(scheme, captured, threads=1):
    made = Solver(collision(2, scheme=scheme).finalize(), threads=threads)
    made.program.captured = captured
    return made


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_replayed_graph_gives_the_same_bits(scheme, threads, monkeypatch):
    """Over several rebuilds of the rows, and past t_stop, where void steps are replayed."""
    for size in ("SMALLEST_SLICE", "SMALLEST_LIGHT_SLICE"):
        monkeypatch.setattr(f"warpsph.device.launch.{size}", 8)  # many slices
    one_by_one, replayed = solver(scheme, False), solver(scheme, True, threads)
    for made in (one_by_one, replayed):
        made.advance(1e-6)
        made.advance(2e-6)
    assert replayed.program._scores and replayed.program.captured
    assert replayed.reading == one_by_one.reading
    assert replayed.neighbours.builds == one_by_one.neighbours.builds
    after = replayed.particles.arrays()
    for name, values in one_by_one.particles.arrays().items():
        np.testing.assert_array_equal(after[name], values, err_msg=name)


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("n", [1, 2, 3000])
def test_every_slice_is_run_once_and_after_all_of_the_launch_before(n, threads, monkeypatch):
    """Each launch reads at i what the one before has written at n - 1 - i, mostly by another thread."""
    monkeypatch.setattr("warpsph.device.launch.SMALLEST_LIGHT_SLICE", 1)
    launcher, count = Launcher("cpu", threads), 50
    a, b = (wp.array(np.arange(n) % 7, dtype=wp.int32, device="cpu") for _ in range(2))
    there = launcher.bind(turned_around, n, source=a, target=b, n=n)
    back = launcher.bind(turned_around, n, source=b, target=a, n=n)
    played = Score(launcher, make_team(Spec(1, wp.float64)), [there, back])
    np.testing.assert_array_equal(a.numpy(), np.arange(n) % 7)  # nothing is run by recording it
    expected, other, i = np.int32(np.arange(n) % 7), np.int32(np.arange(n) % 7), np.arange(n, dtype=np.int32)
    for _ in range(2 * count):
        other, expected = expected, 2 * other + np.fmod(expected[::-1], 1000) + i
    played.play(count - 1)
    played.play(1)
    np.testing.assert_array_equal(a.numpy(), expected)
    np.testing.assert_array_equal(b.numpy(), other)


def test_a_replay_that_fails_in_one_thread_ends_in_all(monkeypatch):
    made = solver("sav1", True, threads=3)
    made.prepare()
    launch, calls = wp.capture_launch, []

    def failing(graph):
        calls.append(graph)
        if len(calls) == 2:
            raise RuntimeError("no")
        launch(graph)

    monkeypatch.setattr(wp, "capture_launch", failing)
    with pytest.raises(RuntimeError, match="no"):
        made.program.run(3)


def test_rows_that_moved_in_memory_are_captured_again():
    made = solver("sav1", True)
    made.prepare()
    first = dict(made.program._scores)
    made.advance(1e-7)
    assert made.program._scores == first
    made._bound = -1  # as after a build in which the rows outgrew their storage
    made.advance(2e-7)
    assert made.program._scores and not set(made.program._scores.values()) & set(first.values())


class Broken(wp.ScopedCapture):
    """A device that refuses."""

    def __exit__(self, *failure):
        super().__exit__(*failure)
        raise RuntimeError("operation not permitted when stream is capturing")


def test_a_device_without_graphs_launches_one_by_one(monkeypatch, recwarn):
    monkeypatch.setattr(wp, "ScopedCapture", Broken)
    made, plain = solver("sav1", True), solver("sav1", False)
    made.advance(1e-6)
    plain.advance(1e-6)
    assert not made.program.captured
    told = [str(warning.message) for warning in recwarn]
    assert len(told) == 1 and "no graph on cpu" in told[0]
    np.testing.assert_array_equal(made.particles.x.numpy(), plain.particles.x.numpy())


def test_the_first_run_after_binding_is_no_replay():
    """Every count is an execution: the capture itself runs nothing."""
    runs = []

    class Piece:
        def launch(self):
            runs.append(wp.get_device("cpu").is_capturing)

    launcher = solver("sav1", False).launcher
    program = Program(launcher, Spec(2, wp.float64))
    program.bind([Command(launcher, [Piece()], True)], [])
    program.run(1)
    assert runs == [False, True]  # one execution, one recording


@pytest.mark.parametrize("scheme", ["sav1", "adaptle-as"])
def test_dealt_out_as_on_a_gpu_the_step_is_the_same(monkeypatch, scheme):
    """Minima and maxima know no order: the reductions that a GPU needs, in stages, give the same bits."""
    here = run(collision(3, scheme=scheme), 2e-6)
    monkeypatch.setattr("warpsph.solver.Blocks", lambda n, cuda, most=None: Blocks(n, True, 300))
    monkeypatch.setattr("warpsph.search.tiles.HANDS_CPU", 5)
    dealt = run(collision(3, scheme=scheme), 2e-6)
    blocks = dealt._step_blocks
    assert len(blocks.folds) == len(FOLDS) and blocks.folds[-1] == FOLDS[-1] < blocks.count
    assert dealt.neighbours.tiles.hands == 5
    assert dealt.reading == here.reading
    np.testing.assert_array_equal(by_id(dealt, "x"), by_id(here, "x"))
    for name, value in here.ledger().items():
        assert dealt.ledger()[name] == pytest.approx(value, rel=1e-12, abs=1e-12), name


@pytest.mark.parametrize("cuda", [False, True])
@pytest.mark.parametrize(("n", "most"), [(1, 4), (3, 4), (4, 4), (5, 4), (1000, 33), (70000, None)])
def test_every_particle_is_dealt_to_one_block(n, most, cuda):
    dealt = Blocks(n, cuda, most)
    b, k = np.meshgrid(np.arange(dealt.count), np.arange(dealt.chunk), indexing="ij")
    i = b * dealt.across + k * dealt.along
    np.testing.assert_array_equal(np.sort(i[i < n]), np.arange(n))
    assert (i < n).any(axis=1).all()  # no block is empty
