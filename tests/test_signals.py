"""Runs that are asked to stop: by SIGINT, by SIGTERM, by their wall time."""

import errno
import json
import os
import signal
import threading
import time

import pytest

from warpsph import library
from warpsph.errors import DiskError, Ended, InputError, RunError
from warpsph.progress import Progress
from warpsph.quality.torture import faults
from warpsph.quality.torture import signals as trial
from warpsph.quality.torture.child import SCENE
from warpsph.quality.torture.trial import Means
from warpsph.run import resume
from warpsph.run import run as run_scene
from warpsph.running import frames, walltime
from warpsph.running.signals import listening
from warpsph.running.walltime import Deadline, parse
from warpsph.solver import Solver
from warpsph.storage import checkpoint, history, snapshot

BOTH = (signal.SIGINT, signal.SIGTERM)


def handlers():
    """What takes the signals now."""
    return [signal.getsignal(number) for number in BOTH]


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("3600", 3600), ("0.5", 0.5), ("45:00", 2700), ("90:05", 5405), ("2:30:00", 9000), ("100:00:01", 360001),
        ("1-12", 129600), ("1-12:30", 131400), ("1-12:00:00", 129600), (" 0-00:00:01 ", 1),
    ],
)  # fmt: skip
def test_a_wall_time_is_read_as_batch_systems_write_it(text, seconds):
    assert parse(text) == seconds


@pytest.mark.parametrize(
    "text",
    ["", "0", "00:00", "-5", "1:60", "1:00:60", "1-24:00:00", "1-1:60", "1h", "nan", "inf", "1e3", "٣"],
)
def test_anything_else_is_refused(text):
    with pytest.raises(InputError, match=r"--walltime = .*allowed: seconds"):
        parse(text)


@pytest.mark.parametrize("value", [-1.0, float("nan")])
def test_a_wall_time_in_python_is_a_number_of_seconds(value, tmp_path):
    with pytest.raises(InputError, match="walltime = "):
        resume(tmp_path, walltime=value)


def test_the_age_of_this_process_is_known():
    before = walltime.age()
    time.sleep(0.05)
    assert 0.0 < before < walltime.age() < 3600.0


def test_a_deadline_leaves_time_for_what_was_slow_lately(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(walltime.time, "monotonic", lambda: now[0])
    deadline, endless = Deadline(100.0), Deadline(None)
    for each in (deadline, endless):
        each.batch(2.0)
        each.output(10.0)
    longest = 1.5 * (2 * 2.0 + 3 * 10.0) + 1.0  # two batches, three outputs, and some more
    for now[0], expected in ((0.0, False), (99.0 - longest, False), (101.0 - longest, True), (200.0, True)):
        assert deadline.is_near() is expected
        assert endless.is_near() is False
    for _ in range(walltime.RECENT):
        deadline.batch(0.1)
        deadline.output(0.1)
    now[0] = 98.0
    assert deadline.is_near() is False


def test_a_signal_ends_at_once_what_has_no_patience():
    before = handlers()
    for number, code, word in ((signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")):
        with pytest.raises(Ended, match=word) as ended, listening():
            signal.raise_signal(number)
        assert ended.value.code == code and isinstance(ended.value, KeyboardInterrupt)
    assert handlers() == before


def test_patience_waits_for_the_second_signal():
    with listening() as stop:
        with stop.patience():
            signal.raise_signal(signal.SIGTERM)
            assert stop.asked.code == 143
            with pytest.raises(Ended):
                signal.raise_signal(signal.SIGTERM)
        with listening() as inner:
            assert inner is stop


def test_on_the_command_line_the_second_signal_waits_for_nothing(monkeypatch):
    codes = []
    monkeypatch.setattr(os, "_exit", codes.append)
    monkeypatch.setattr(os, "write", lambda *_: 0)
    with listening(final=True) as stop, stop.patience():
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(Ended):  # as it has not ended here
            signal.raise_signal(signal.SIGINT)
    assert codes == [130]


def test_a_signal_that_is_to_be_ignored_is(monkeypatch):
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with listening() as stop:
            signal.raise_signal(signal.SIGINT)
            assert stop.asked is None
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


class At(Progress):
    """Does something once the run has reached a time."""

    def __init__(self, time, action):
        super().__init__()
        self.time, self.action = time, action

    def update(self, **values):
        if values["time"] >= self.time and self.action is not None:
            action, self.action = self.action, None
            action()


@pytest.fixture
def start(tmp_path):
    """Start the scene of the trials in a folder; gives the folder."""
    path = tmp_path / "balls.py"
    path.write_text(SCENE)

    def start(time=1.2e-6, action=None, **options):
        scene = library.load(path).build()
        run_scene(
            scene, tmp_path / "out", source=SCENE, progress=At(time, action), **({"frames": False} | options)
        )

    return start


@pytest.fixture
def out(tmp_path):
    """The folder of the run."""
    return tmp_path / "out"


def outcome(out):
    """What the summary says about how it ended."""
    return json.loads((out / "summary.json").read_text())["outcome"]


def warnings(out):
    """What the summary warns of."""
    return json.loads((out / "summary.json").read_text())["warnings"]


@pytest.mark.parametrize(("number", "code", "word"), [(2, 130, "interrupted"), (15, 143, "terminated")])
def test_a_run_stops_with_a_checkpoint_and_goes_on(start, out, number, code, word):
    before = handlers()
    with pytest.raises(Ended) as ended:
        start(action=lambda: signal.raise_signal(number))
    assert ended.value.code == code and handlers() == before
    message = str(ended.value)
    assert message.startswith(f"{word} at t = 1.") and f"`warpsph resume {out}`" in message
    time = checkpoint.load(out / "checkpoint.h5")[1]["time"]
    assert 1.2e-6 <= time < 1.5e-6 and snapshot.time(snapshot.find(out)[-1]) == time
    assert outcome(out) == word and not (out / "run.lock").exists()
    assert resume(out)["outcome"] == outcome(out) == "done"
    assert [round(snapshot.time(path) / 0.5e-6, 9) for path in snapshot.find(out)] == list(range(7))


def test_a_run_that_fails_while_it_is_asked_to_stop_leaves_no_checkpoint_of_the_failure(
    start, out, monkeypatch
):
    advance = Solver.advance

    def spoiled(self, t_stop, on_batch=None):
        advance(self, t_stop, on_batch)
        if self.reading.time > 1.2e-6:
            raise RunError("velocity not finite")

    monkeypatch.setattr(Solver, "advance", spoiled)
    with pytest.raises(RunError, match="velocity not finite"):
        start(action=lambda: signal.raise_signal(signal.SIGTERM))
    assert outcome(out) == "failed"
    assert checkpoint.load(out / "checkpoint.h5")[1]["time"] < 1.2e-6 < snapshot.time(snapshot.find(out)[-1])


@pytest.mark.parametrize("number", [2, 15])
def test_a_run_that_is_asked_to_stop_on_a_full_disk_says_both(start, out, number):
    def full(what, path):
        if "0003" in path.name and what == "write":  # what the request makes it write
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with faults.watched(full), pytest.raises(DiskError) as stopped:
        start(action=lambda: signal.raise_signal(number))
    text = str(stopped.value)
    assert text.startswith(
        f"{'interrupted' if number == 2 else 'terminated'}, but {out}/snapshots/balls_0003.vtkhdf"
    )
    assert "could not be written: No space left" in text and text.endswith(
        f"; then `warpsph resume {out}` goes on"
    )
    assert "last snapshot: " in text and "balls_0002.vtkhdf; " in text and "\n" not in text
    assert outcome(out) == "failed" and [text.partition("; last")[0].partition(", but ")[2]] == warnings(out)
    assert resume(out)["outcome"] == "done" and len(snapshot.find(out)) == 7


def test_a_measure_that_fails_ends_the_run_in_good_order(start, out, monkeypatch):
    monkeypatch.setitem(globals(), "SCENE", SCENE.replace("state.p.max()", "1 / (state.time < 1.2e-6)"))
    (out.parent / "balls.py").write_text(SCENE)
    with pytest.raises(
        RunError, match=r"measure 'peak_pressure' failed at t = 1\.[2-5].* s: ZeroDivisionError: .*scene"
    ) as stopped:
        start()
    last = snapshot.find(out)[-1]
    assert str(stopped.value).endswith(f"; last snapshot: {last}") and snapshot.time(last) > 1.2e-6
    assert outcome(out) == "failed" and "peak_pressure" in warnings(out)[0]


def test_a_run_that_stops_at_an_output_has_written_it_already(start, out):
    with pytest.raises(Ended):
        start(time=1.5e-6, action=lambda: signal.raise_signal(signal.SIGTERM))
    assert [snapshot.time(path) for path in snapshot.find(out)][-1] == 1.5e-6
    assert len(snapshot.find(out)) == 4 and history.read(out / "history.csv")[2]["time"][-1] == 1.5e-6


def test_a_wall_time_that_is_too_short_leaves_the_first_output(start, out):
    with pytest.raises(
        Ended, match=r"wall time is up at t = 0 s of 3 µs, before any step; .* goes on"
    ) as ended:
        start(walltime=0.0)
    assert ended.value.code == 5 and outcome(out) == "wall time is up"
    assert len(snapshot.find(out)) == 1 and checkpoint.load(out / "checkpoint.h5")[1]["time"] == 0.0
    with pytest.raises(Ended):
        resume(out, walltime=0.0)
    assert len(snapshot.find(out)) == 1
    done = resume(out, walltime=600.0)
    files = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert resume(out, walltime=0.0) == resume(out, until=3e-6) == done, "it is done: nothing is left to do"
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == files


@pytest.mark.parametrize("content", [None, "{"])
def test_a_run_that_was_killed_before_its_summary_gets_it(start, out, content):
    start()
    written = json.loads((out / "summary.json").read_text())
    (out / "summary.json").unlink()
    if content is not None:
        (out / "summary.json").write_text(content)
    found = resume(out)
    timings = {"wall_s", "step_wall_s", "ns_per_particle_step", "ns_per_pair"}
    assert {k: v for k, v in found.items() if k not in timings} == {
        k: v for k, v in written.items() if k not in timings
    }


def test_frames_that_were_not_drawn_are_drawn_later(start, out, monkeypatch):
    drawn = []

    def render(folder, on_frame):
        (folder / "frames").mkdir(exist_ok=True)
        for k in range(len(snapshot.find(folder))):
            on_frame()
            if k == 3 and not drawn:
                drawn.append("half")
                signal.raise_signal(signal.SIGTERM)
            (folder / "frames" / f"{k}.png").touch()

    monkeypatch.setattr("warpsph.render.render", render)
    with pytest.raises(
        Ended, match=r"terminated; all steps are done, `warpsph resume .*` draws the frames"
    ) as ended:
        start(frames=True)
    assert ended.value.code == 143 and outcome(out) == "done" and frames.are_missing(out)
    with pytest.raises(Ended, match="wall time is up; all steps are done"):
        resume(out, walltime=0.0)
    resume(out)
    assert not frames.are_missing(out)
    monkeypatch.setattr("warpsph.render.render", None)
    resume(out)


def test_frames_that_cannot_be_drawn_do_not_make_a_run_fail(start, out, monkeypatch):
    def render(folder, on_frame):
        raise InputError("no particle has a finite position")

    monkeypatch.setattr("warpsph.render.render", render)
    start(frames=True)
    assert outcome(out) == "done" and warnings(out) == ["no frames: no particle has a finite position"]
    resume(out)
    assert len(warnings(out)) == 1


def test_other_threads_take_no_signals(start, out):
    before, ends = handlers(), []

    def work():
        try:
            start(walltime=0.0)
        except Ended as ended:
            ends.append((ended.code, handlers() == before))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert ends == [(5, True)]


def test_the_short_trial_holds(tmp_path):
    found = trial.run(Means(tmp_path, True, lambda line: None))
    assert not found.failed
    assert [row[2] for row in found.rows] == ["143", "5"]
