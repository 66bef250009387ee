"""Output in the background: in order, bounded, and no error is lost."""

import functools
import json
import resource
import signal
import threading
import time

import numpy as np
import pytest
from states import impact
from tools import collision

from warpsph.errors import DiskError, RunError
from warpsph.progress import Progress
from warpsph.run import run as run_scene
from warpsph.solver import Solver
from warpsph.storage import checkpoint, snapshot
from warpsph.storage.writer import PENDING, Writer

SOON = 10.0
"""Longest wait [s] for what takes no time."""


class Slow:
    """Jobs that take until they are let go; notes what begins and ends."""

    def __init__(self):
        self.go, self.notes = threading.Semaphore(0), []

    def take(self, name):
        self.notes.append(("copied", name))

        def write():
            assert self.go.acquire(timeout=SOON)
            self.notes.append(("written", name))

        return write


def test_outputs_are_written_in_order_and_none_is_left():
    written = []
    with Writer() as writer:
        for k in range(50):
            writer.submit(lambda k=k: functools.partial(written.append, k))
    assert written == list(range(50))


def test_what_is_copied_is_bounded():
    """The third output is not even copied before the first one is written."""
    slow, writer = Slow(), Writer()
    caller = threading.Thread(
        target=lambda: [writer.submit(lambda k=k: slow.take(k)) for k in range(PENDING + 1)]
    )
    caller.start()
    caller.join(0.2)
    assert caller.is_alive()
    assert slow.notes == [("copied", k) for k in range(PENDING)]
    slow.go.release()
    caller.join(SOON)
    assert not caller.is_alive()
    assert slow.notes[PENDING:] == [("written", 0), ("copied", PENDING)]
    slow.go.release(PENDING)
    writer.close()
    assert slow.notes[-PENDING:] == [("written", k) for k in range(1, PENDING + 1)]


def fail(error):
    raise error


def test_the_first_error_is_kept_and_ends_the_writing():
    written, error, writer = [], RunError("disk full"), Writer()
    writer.submit(lambda: functools.partial(written.append, 1))
    writer.submit(lambda: functools.partial(fail, error))
    with pytest.raises(RunError) as first:
        for _ in range(PENDING + 1):
            writer.submit(lambda: functools.partial(written.append, 2))
    for call in (writer.check, writer.close, lambda: writer.submit(lambda: pytest.fail("copied in vain"))):
        with pytest.raises(RunError) as again:
            call()
        assert again.value is first.value is error
    assert written == [1]


def test_an_exception_on_its_way_waits_for_the_writing_and_goes_on():
    slow = Slow()
    slow.go.release()
    with pytest.raises(KeyboardInterrupt), Writer() as writer:
        writer.submit(lambda: slow.take(0))
        writer.submit(lambda: functools.partial(fail, RunError("disk full")))
        raise KeyboardInterrupt
    assert slow.notes == [("copied", 0), ("written", 0)]


def test_a_copy_that_fails_takes_no_room():
    writer = Writer()
    for _ in range(2 * PENDING):
        with pytest.raises(MemoryError):
            writer.submit(lambda: fail(MemoryError()))
    writer.close()


def balls():
    """Two balls, with six snapshots on their way."""
    made = collision(speed=1000.0)
    made.until, made.snapshots = 3e-6, 6
    made.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    return made


def failing_at(number, error, monkeypatch):
    """Let a snapshot fail as on a full disk."""
    write = snapshot.write

    def broken(path, state):
        if path.stem.endswith(f"_{number:04d}"):
            raise error
        write(path, state)

    monkeypatch.setattr(snapshot, "write", broken)


@pytest.mark.parametrize(("number", "last"), [(2, "test_0001.vtkhdf"), (0, "none"), (6, "test_0005.vtkhdf")])
def test_an_output_that_fails_stops_the_run(tmp_path, monkeypatch, number, last):
    """The message has the cause and the last snapshot, which is there with its checkpoint; none comes after it."""
    failing_at(number, DiskError("snapshot could not be written: No space left on device"), monkeypatch)
    with pytest.raises(DiskError, match=f"No space left on device; last snapshot: .*{last}"):
        run_scene(balls(), tmp_path / "out", frames=False)
    found = snapshot.find(tmp_path / "out")
    assert len(found) == number
    if number:
        assert checkpoint.load(tmp_path / "out/checkpoint.h5")[1]["time"] == snapshot.time(found[-1])


def test_any_other_error_of_the_thread_is_not_swallowed(tmp_path, monkeypatch):
    failing_at(1, ZeroDivisionError("a mistake"), monkeypatch)
    with pytest.raises(ZeroDivisionError, match="a mistake"):
        run_scene(balls(), tmp_path / "out", frames=False)


def test_everything_is_on_the_disk_when_the_run_stops(tmp_path, monkeypatch):
    """A particle goes astray while the writer is far behind."""
    write, advance, calls = snapshot.write, Solver.advance, []

    def late(path, state):
        time.sleep(0.1)
        write(path, state)

    def spoiled(self, t_stop, on_batch=None):
        calls.append(t_stop)
        if len(calls) == 5:
            v = self.particles.v.numpy().copy()
            v[0] = np.nan
            self.particles.v.assign(v)
        advance(self, t_stop, on_batch)

    monkeypatch.setattr(snapshot, "write", late)
    monkeypatch.setattr(Solver, "advance", spoiled)
    out = tmp_path / "out"
    with pytest.raises(RunError, match=r"velocity not finite; .*; last snapshot: .*test_0004.vtkhdf"):
        run_scene(balls(), out, frames=False)
    times = [snapshot.time(path) for path in snapshot.find(out)]
    np.testing.assert_allclose(times, [0.0, 0.5e-6, 1e-6, 1.5e-6, 1.5e-6], rtol=1e-12)
    assert checkpoint.load(out / "checkpoint.h5")[1]["time"] == times[3]


class Interrupt(Progress):
    """Presses Ctrl-C once, at a time."""

    def update(self, **values):
        if values["time"] > 1.2e-6 and not vars(self).setdefault("pressed", False):
            self.pressed = True
            signal.raise_signal(signal.SIGINT)


def test_ctrl_c_waits_for_a_slow_disk(tmp_path, monkeypatch):
    """The last snapshot comes after those that were waiting, and the checkpoint is of its time."""
    write = snapshot.write

    def late(path, state):
        time.sleep(0.1)
        write(path, state)

    monkeypatch.setattr(snapshot, "write", late)
    out = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        run_scene(balls(), out, frames=False, progress=Interrupt())
    times = [snapshot.time(path) for path in snapshot.find(out)]
    assert len(times) == 4 and times == sorted(set(times)) and 1.2e-6 < times[-1] < 1.5e-6
    info = checkpoint.load(out / "checkpoint.h5")[1]
    assert (info["time"], info["job"]["next_snapshot"]) == (times[-1], 3)
    assert not list(out.rglob("*.part"))


def files(out):
    """Snapshots and the history, with content; checkpoints hold wall times."""
    paths = [*snapshot.find(out), *out.glob("snapshots/*.series"), out / "history.csv"]
    return {path.name: path.read_bytes() for path in paths}


def test_a_slow_disk_changes_no_bit(tmp_path, monkeypatch):
    """Steps go on, and rows are rebuilt in memory, while outputs wait; what they hold stays."""
    run_scene(balls(), tmp_path / "fast", frames=False)
    write = snapshot.write

    def late(path, state):
        time.sleep(0.1)
        write(path, state)

    monkeypatch.setattr(snapshot, "write", late)
    run_scene(balls(), tmp_path / "slow", frames=False)
    assert files(tmp_path / "slow") == files(tmp_path / "fast")


@pytest.mark.parametrize("limit", [1_000, 20_000, 40_000])
def test_a_disk_that_fills_up_under_hdf5_is_one_clean_error(tmp_path, limit):
    """A real failure of the system, at the first byte or half-way."""
    path, before = tmp_path / "s_0000.vtkhdf", resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        for _ in range(3):
            with pytest.raises(DiskError, match=r"s_0000.vtkhdf could not be written: File too large"):
                snapshot.write(path, impact())
        with pytest.raises(DiskError, match=r"c.h5 could not be written: File too large"):
            checkpoint.save(tmp_path / "c.h5", {"x": np.zeros((50_000, 3))}, {})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not list(tmp_path.iterdir())
    snapshot.write(path, impact())
    assert snapshot.read(path).step == impact().step


def test_host_memory_is_used_again(tmp_path, monkeypatch):
    """As many copies as outputs are in memory, not as many as there are outputs."""
    rooms, room = [], Solver.room
    monkeypatch.setattr(Solver, "room", lambda self: rooms.append(1) or room(self))
    run_scene(balls(), tmp_path / "out", frames=False)
    assert 1 <= len(rooms) <= PENDING and len(snapshot.find(tmp_path / "out")) == 7


def test_no_snapshot_is_read_back_for_the_index(tmp_path, monkeypatch):
    read, reads = snapshot.time, []
    monkeypatch.setattr(snapshot, "time", lambda path: reads.append(path.name) or read(path))
    run_scene(balls(), tmp_path / "out", frames=False)
    assert not reads and len(snapshot.find(tmp_path / "out")) == 7
    index, names = (
        next(tmp_path.glob("out/snapshots/*.series")),
        [path.name for path in snapshot.find(tmp_path / "out")],
    )
    told = json.loads(index.read_text())["files"]
    assert told == [{"name": name, "time": read(tmp_path / "out/snapshots" / name)} for name in names]


def test_a_glance_sees_what_a_copy_holds_until_the_run_goes_on():
    solver = Solver(collision(speed=1000.0).finalize())
    solver.advance(1e-6)
    copy, glance, saved = solver.state(), solver.glance(), solver.state(solver.save()[0])
    assert set(copy.fields) == set(glance.fields) == set(saved.fields)
    for name, values in copy.fields.items():
        np.testing.assert_array_equal(values, glance.fields[name], err_msg=name)
        np.testing.assert_array_equal(values, saved.fields[name], err_msg=name)
    assert "cs" not in glance.fields
    solver.relist()
    with pytest.raises(RuntimeError, match="'v' is read from a state that is over"):
        glance.fields["v"]
    np.testing.assert_array_equal(saved.v, copy.v)
