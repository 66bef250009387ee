"""The launcher: binds by name, refuses what does not fit, and cuts launches into slices that cover them."""

import os
import signal
import threading
import time

import numpy as np
import pytest
import warp as wp
from tools import DOUBLE, PLASTIC

from warpsph.device import score
from warpsph.device.cores import count_cores
from warpsph.device.launch import SMALLEST_LIGHT_SLICE, WORTH_WAKING, Launcher
from warpsph.device.subnormals import can_flush
from warpsph.device.team import Team
from warpsph.errors import InputError
from warpsph.kernels.constitutive import make_constitutive
from warpsph.kernels.spec import Spec
from warpsph.kernels.team import LEFT, make_team
from warpsph.materials import pack

SINGLE = {dim: Spec(dim, wp.float32) for dim in DOUBLE}


@wp.kernel(module="unique", enable_backward=False)
def scale(offset: wp.int32, factor: wp.float64, source: wp.array[wp.float64], target: wp.array[wp.float64]):
    i = wp.tid() + offset
    target[i] = factor * source[i]


@wp.kernel(module="unique", enable_backward=False)
def count(
    offset: wp.int32,
    grid: wp.uint64,
    reach: wp.float32,
    x: wp.array[wp.vec3d],
    number: wp.array[wp.int32],
):
    i = wp.tid() + offset
    n = wp.int32(0)
    for _j in wp.hash_grid_query(grid, x[i], wp.float64(reach)):
        n += 1
    number[i] = n


class Holder:
    """Anything with attributes supplies arguments."""

    def __init__(self, **values):
        vars(self).update(values)


def numbers(n, dtype=wp.float64):
    return wp.array(np.arange(n), dtype=dtype, device="cpu")


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("n", [1, SMALLEST_LIGHT_SLICE, 4 * SMALLEST_LIGHT_SLICE + 3])
def test_every_index_is_done_once(threads, n):
    target = wp.zeros(n, dtype=wp.float64, device="cpu")
    Launcher("cpu", threads).launch(scale, n, Holder(source=numbers(n), target=target), factor=2.0)
    np.testing.assert_array_equal(target.numpy(), 2.0 * np.arange(n))


def test_the_first_source_wins_and_names_win_over_sources():
    target = wp.zeros(3, dtype=wp.float64, device="cpu")
    first, second = Holder(factor=3.0, target=target), Holder(factor=4.0, source=numbers(3))
    launcher = Launcher("cpu", 1)
    launcher.launch(scale, 3, first, second)
    np.testing.assert_array_equal(target.numpy(), [0.0, 3.0, 6.0])
    launcher.launch(scale, 3, first, second, factor=5.0)
    np.testing.assert_array_equal(target.numpy(), [0.0, 5.0, 10.0])


def test_a_command_reads_its_arrays_when_it_runs():
    source, target = numbers(3), wp.zeros(3, dtype=wp.float64, device="cpu")
    command = Launcher("cpu", 1).bind(scale, 3, source=source, target=target, factor=1.0)
    source.fill_(7.0)
    command()
    np.testing.assert_array_equal(target.numpy(), 7.0)


def test_a_missing_argument_is_refused():
    with pytest.raises(TypeError, match="'source'"):
        Launcher("cpu", 1).bind(scale, 3, target=numbers(3), factor=1.0)


@pytest.mark.parametrize("dtype", [wp.float32, wp.vec3d, wp.int32])
def test_an_array_of_another_type_is_refused(dtype):
    source = wp.zeros(3, dtype=dtype, device="cpu")
    with pytest.raises(TypeError, match="'source'"):
        Launcher("cpu", 1).bind(scale, 3, source=source, target=numbers(3), factor=1.0)


def test_a_hash_grid_of_another_precision_than_the_positions_is_refused():
    x = wp.zeros(4, dtype=wp.vec3d, device="cpu")
    number = wp.zeros(4, dtype=wp.int32, device="cpu")
    with wp.ScopedDevice("cpu"):
        wrong, right = (wp.HashGrid(4, 4, 4, dtype=dtype) for dtype in (wp.float32, wp.float64))
    right.build(x, 1.0)
    with pytest.raises(TypeError, match="'grid'"):
        Launcher("cpu", 1).bind(count, 4, x=x, number=number, reach=1.0, grid=wrong)
    Launcher("cpu", 1).launch(count, 4, x=x, number=number, reach=1.0, grid=right)
    np.testing.assert_array_equal(number.numpy(), 4)


def test_a_material_table_of_another_precision_is_refused():
    kernel, n = make_constitutive(DOUBLE[3], False, False), 2
    kinds = {
        "dvdx": DOUBLE[3].mat,
        "tau": DOUBLE[3].sym,
        "sig": DOUBLE[3].sym,
        "mat": wp.int32,
        "clipped": wp.int32,
        "F": DOUBLE[3].mat,
        "kernel_type": wp.int32,
        "fate": wp.int32,
    }
    names = [arg.label for arg in kernel.adj.args][1:]
    arrays = {name: wp.zeros(n, dtype=kinds.get(name, wp.float64), device="cpu") for name in names}
    Launcher("cpu", 1).bind(kernel, n, **(arrays | {"materials": pack([PLASTIC], DOUBLE[3], "cpu")}))
    with pytest.raises(TypeError, match="'materials'"):
        Launcher("cpu", 1).bind(kernel, n, **(arrays | {"materials": pack([PLASTIC], SINGLE[3], "cpu")}))


@pytest.mark.parametrize("threads", [0, -1])
def test_too_few_threads_are_refused(threads):
    with pytest.raises(InputError, match=f"threads = {threads}"):
        Launcher("cpu", threads)


@pytest.mark.parametrize("device", ["cuda:99", "gpu", ""])
def test_an_unknown_device_is_refused(device):
    with pytest.raises(InputError, match=r"is unknown.*; allowed: cpu"):
        Launcher(device)


def test_a_launcher_of_one_thread_starts_none():
    before = threading.active_count()
    n = 4 * SMALLEST_LIGHT_SLICE
    Launcher("cpu", 1).launch(scale, n, source=numbers(n), target=numbers(n), factor=1.0)
    assert threading.active_count() == before


def test_an_interrupted_launch_ends_before_the_next_begins():
    """What a helper had begun is done when the interruption is raised, and no later launch takes its end for its own."""
    team, done = Team(2), []

    def slow():
        time.sleep(0.05)
        done.append("slow")

    def interrupted():
        if threading.current_thread() is threading.main_thread():
            raise KeyboardInterrupt
        slow()

    with pytest.raises(KeyboardInterrupt):
        team.share([interrupted] * 8)
    finished = len(done)
    time.sleep(0.1)
    assert len(done) == finished
    team.share([slow, slow])
    assert len(done) == finished + 2


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no timers that signal")
def test_threads_are_waited_for_however_often_the_wait_is_interrupted():
    team, calls, done = Team(3), [], []

    def interrupt(*_):
        calls.append("signal")
        raise KeyboardInterrupt

    def slow():
        time.sleep(0.3)
        done.append("slow")

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1, 0.05)
        with pytest.raises(KeyboardInterrupt):
            team.together([lambda: None, slow, slow], lambda: None)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert len(calls) > 1 and done == ["slow", "slow"]


def test_work_is_recorded_whole_by_the_thread_that_records():
    """A helper would run its slices there and then, and no replay would have them."""
    n = WORTH_WAKING
    launcher, source, target = Launcher("cpu", 3), numbers(n), wp.zeros(n, dtype=wp.float64, device="cpu")
    launch = launcher.bind(scale, n, source=source, target=target, factor=3.0)
    replay = score.recorded(launcher.device, launch)
    assert replay is not launch and not target.numpy().any()
    replay()
    np.testing.assert_array_equal(target.numpy(), 3.0 * source.numpy())


def test_pieces_of_work_may_launch_what_threads_share():
    """As they do where nothing can be recorded: nobody waits for a thread that waits for it."""
    n = WORTH_WAKING
    launcher, source = Launcher("cpu", 2), numbers(n)
    targets = [wp.zeros(n, dtype=wp.float64, device="cpu") for _ in range(2)]
    launcher.share([launcher.bind(scale, n, source=source, target=t, factor=3.0) for t in targets])
    for target in targets:
        np.testing.assert_array_equal(target.numpy(), 3.0 * source.numpy())


def test_a_launch_that_fails_in_any_thread_says_so():
    def fail():
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        Team(3).share([fail] * 6)


@pytest.mark.skipif(not can_flush(), reason="this machine or its C library keeps subnormal numbers")
@pytest.mark.parametrize("threads", [1, 3])
def test_subnormal_numbers_are_zero_in_kernels_and_nowhere_else(threads):
    """Read and written as zero, by each thread; the calling thread's arithmetic is its own again after the launch."""
    n, small, least = 3 * SMALLEST_LIGHT_SLICE, 1e-310, np.finfo(float).tiny
    source = np.full(n, small)
    source[::2] = least
    target = wp.full(n, 1.0, dtype=wp.float64, device="cpu")
    launcher = Launcher("cpu", threads)
    launcher.launch(scale, n, factor=2.0, source=wp.array(source, device="cpu"), target=target)
    np.testing.assert_array_equal(target.numpy()[::2], 2.0 * least)
    np.testing.assert_array_equal(target.numpy()[1::2], 0.0)
    launcher.launch(scale, n, factor=0.5, source=wp.array(source, device="cpu"), target=target)
    assert not target.numpy().any()
    assert (0.5 * source).all()


@pytest.mark.parametrize(
    ("main", "fault"), [(True, KeyboardInterrupt), (True, ValueError), (False, ValueError)]
)
def test_threads_do_not_wait_for_one_that_does_not_come(main, fault):
    """Interrupted or failed: the others are told, end, and what was the matter is raised."""
    left, ended = threading.Event(), []

    def fail():
        raise fault("no")

    def wait():
        ended.append(left.wait(10.0))

    with pytest.raises(fault):
        Team(3).together([fail, wait, wait] if main else [wait, fail, wait], left.set)
    assert ended == [True, True]


def test_a_meeting_ends_when_all_have_come_or_one_has_left():
    meet, give_way = make_team(DOUBLE[1]).meet, score._give_way()
    meeting = wp.zeros(2, dtype=wp.int64, device="cpu")
    alone = [wp.full(1, -1, dtype=wp.int32, device="cpu") for _ in range(2)]
    comings = [wp.launch(meet, 1, [0, 2, give_way, meeting, a], device="cpu", record_cmd=True) for a in alone]
    helper = threading.Thread(target=comings[1].launch)
    helper.start()
    time.sleep(0.01)
    assert alone[1].numpy()[0] == -1 and helper.is_alive()
    comings[0].launch()
    helper.join()
    assert [int(a.numpy()[0]) for a in alone] == [0, 0]
    meeting.numpy()[LEFT] = 1
    comings[0].launch()
    assert alone[0].numpy()[0] == 1


@pytest.mark.parametrize(
    ("groups", "files", "cores"),
    [
        ("0::/job/step", {"job/cpu.max": "150000 100000", "job/step/cpu.max": "max 100000"}, 2),
        ("0::/job", {"job/cpu.max": "20000 100000"}, 1),
        ("4:cpu,cpuacct:/job", {"cpu/job/cpu.cfs_quota_us": "200000\n", "cpu/job/cpu.cfs_period_us": "100000\n"}, 2),
        ("4:cpu:/job", {"cpu/job/cpu.cfs_quota_us": "-1", "cpu/job/cpu.cfs_period_us": "100000"}, 8),
        ("", {}, 8),
    ],
)  # fmt: skip
def test_a_container_s_share_of_time_limits_the_threads(monkeypatch, tmp_path, groups, files, cores):
    """Rounded up; the narrowest of all groups above the process counts."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    texts = {"proc/self/cgroup": groups} | {f"sys/fs/cgroup/{name}": text for name, text in files.items()}
    for name, text in texts.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    assert count_cores(tmp_path) == cores
