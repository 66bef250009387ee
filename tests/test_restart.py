"""Going on with a run: from any batch of steps, from the older checkpoint, elsewhere, or not at all, and then it says why."""

import json
import os
import shutil

import h5py
import numpy as np
import pytest
from test_repeat import SCENE
from tools import collision

from warpsph import __version__, info
from warpsph.errors import InputError
from warpsph.library import load
from warpsph.quality.torture import restart
from warpsph.quality.torture.restart import Stopper, differences
from warpsph.quality.torture.trial import Means
from warpsph.run import resume
from warpsph.run import run as run_scene
from warpsph.running import origin
from warpsph.solver import Solver
from warpsph.storage import checkpoint, history, snapshot
from warpsph.storage.folder import NEWEST, PREVIOUS

ARRAYS = {"x": np.arange(3.0)}


def test_stopped_anywhere_it_ends_in_the_same_bits(tmp_path):
    """The short version of the trial: also with checkpoints that are damaged."""
    found = restart.run(Means(tmp_path, True, print))
    assert not found.failed
    assert [row[4].startswith("yes") for row in found.rows] == [True] * 7
    assert all(int(row[3]) >= 5 for row in found.rows[:3])


def start(out, **options):
    """Run the scene of two balls into a folder."""
    out.parent.mkdir(exist_ok=True)
    (out.parent / "balls.py").write_text(SCENE)
    build = load(out.parent / "balls.py").build
    return run_scene(build(), out, source=SCENE, parameters={"spacing": 1e-3}, frames=False, **options)


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """A run that has ended, not to be changed."""
    out = tmp_path_factory.mktemp("ended") / "out"
    start(out)
    return out


@pytest.fixture(scope="module")
def halfway(tmp_path_factory):
    """A run that was stopped in mid-interval, not to be changed."""
    out = tmp_path_factory.mktemp("halfway") / "out"
    with pytest.raises(KeyboardInterrupt):
        start(out, progress=Stopper(18))
    return out


@pytest.fixture
def stopped(halfway, tmp_path):
    """The same, to be gone on with."""
    return shutil.copytree(halfway, tmp_path / "out")


def edit(path, **facts):
    """Change facts of a checkpoint."""
    arrays, found = checkpoint.load(path)
    checkpoint.save(path, arrays, found | facts)


def test_a_checkpoint_says_where_it_is_from(halfway):
    facts = checkpoint.facts(halfway / NEWEST)
    assert facts["version"] == __version__ and facts["scheme"] == "mon-mixed-as"
    assert (facts["scene"], facts["dim"], facts["particles"]) == ("balls", 2, 138)
    assert (
        facts["scene_sha256"] == checkpoint.digest(halfway / "scene.py") and len(facts["scene_sha256"]) == 64
    )
    assert 0.0 < facts["time"] < facts["until"] == 6e-6 and facts["parameters"] == {"spacing": 1e-3}
    with h5py.File(halfway / NEWEST) as file:
        assert set(checkpoint.HEADER) <= set(file.attrs)
        assert file.attrs["time"] == facts["time"] and file.attrs["step"] == facts["step"] > 0
    told = info.describe(halfway / NEWEST)
    assert "scheme          mon-mixed-as" in told and facts["scene_sha256"] in told
    lines = info.describe(halfway).splitlines()[-2:]
    assert [line.split(":")[0] for line in lines] == [NEWEST, PREVIOUS]
    assert f"step {facts['step']}" in lines[0]


def test_all_that_a_run_keeps_is_checked(halfway):
    found = checkpoint.load_newest(halfway)
    checked = origin.checked(found)
    assert checked.info.keys() <= found.info.keys() and checked.arrays is found.arrays
    assert all(checked.info[name] == found.info[name] for name in checked.info)


def test_the_newest_two_are_kept(tmp_path):
    for step in range(4):
        checkpoint.save_newest(tmp_path, ARRAYS, {"time": 1.0 * step})
    assert sorted(path.name for path in tmp_path.iterdir()) == [NEWEST, PREVIOUS]
    assert checkpoint.load(tmp_path / NEWEST)[1] == {"time": 3.0}
    assert checkpoint.load(tmp_path / PREVIOUS)[1] == {"time": 2.0}
    assert checkpoint.load_newest(tmp_path).info == {"time": 3.0}


@pytest.mark.parametrize("renames", [0, 1, 2])
def test_killed_between_any_two_renames_one_is_whole(renames, tmp_path, monkeypatch):
    """And the next one does not push it out: it only becomes the previous one when it is the newest."""
    for step in range(2):
        checkpoint.save_newest(tmp_path, ARRAYS, {"time": 1.0 * step})
    replace, done = os.replace, []

    def killed(source, target):
        if len(done) == renames:
            raise MemoryError
        done.append(target)
        replace(source, target)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", killed)
        if renames < 2:
            with pytest.raises(MemoryError):
                checkpoint.save_newest(tmp_path, ARRAYS, {"time": 2.0})
        else:
            checkpoint.save_newest(tmp_path, ARRAYS, {"time": 2.0})
    assert checkpoint.load_newest(tmp_path).info == {"time": [1.0, 1.0, 2.0][renames]}
    checkpoint.save_newest(tmp_path, ARRAYS, {"time": 3.0})
    times = [checkpoint.load(tmp_path / name)[1]["time"] for name in (NEWEST, PREVIOUS)]
    assert times == [[3.0, 1.0], [3.0, 1.0], [3.0, 2.0]][renames]


def test_a_scene_that_was_changed_is_refused(stopped):
    before = {path: path.read_bytes() for path in stopped.rglob("*") if path.is_file()}
    (stopped / "scene.py").write_text(SCENE.replace("1000.0", "1001.0"))
    with pytest.raises(InputError, match=r"scene.py was changed since the checkpoint; put the old text back"):
        resume(stopped, frames=False)
    (stopped / "scene.py").write_text(SCENE)
    assert before == {path: path.read_bytes() for path in stopped.rglob("*") if path.is_file()}


def test_another_version_goes_on_and_says_so(stopped, ended):
    edit(stopped / NEWEST, version="0.0.9")
    listener = Stopper(0)
    summary = resume(stopped, frames=False, progress=listener)
    _, line = listener.said  # the first one tells the memory
    assert line.startswith("computed by warpsph 0.0.9 with Warp ") and "perhaps no longer bit for bit" in line
    assert summary["warnings"] == [line]
    assert not differences(ended, stopped)


def test_another_precision_goes_on_and_says_so(stopped, ended):
    """Now and whenever it is gone on with again; what comes out is as good as in that precision from the start."""
    listener = Stopper(4)
    with pytest.raises(KeyboardInterrupt):
        resume(stopped, precision="float32", frames=False, progress=listener)
    _, line = listener.said  # the first one tells the memory
    assert "in float64 up to t = " in line and "in float32 from there on: no longer bit for bit" in line
    again = Stopper(0)
    summary = resume(stopped, frames=False, progress=again)
    assert summary["precision"] == "float32" and summary["warnings"] == [line] and len(again.said) == 1
    one, two = (snapshot.read(snapshot.find(out)[-1]) for out in (ended, stopped))
    assert one.time == two.time and one.x.dtype == np.float64 and two.x.dtype == np.float32
    np.testing.assert_allclose(two.x, one.x, atol=1e-5)
    before, after = (json.loads((out / "summary.json").read_text()) for out in (ended, stopped))
    assert after["steps"] == before["steps"]


def test_a_later_end_changes_nothing_up_to_the_old_one(stopped, ended):
    summary = resume(stopped, until=8e-6, frames=False)
    assert summary["time"] == 8e-6
    pairs = zip(snapshot.find(ended), snapshot.find(stopped), strict=False)
    for one, two in pairs:
        first, second = snapshot.read(one), snapshot.read(two)
        assert first.time == second.time
        for name, values in first.fields.items():
            assert values.tobytes() == second.fields[name].tobytes(), (one.name, name)
    times = [snapshot.time(path) for path in snapshot.find(stopped)]
    assert times == [0.0, 1.5e-6, 3e-6, 4.5e-6, 6e-6, 7.5e-6, 8e-6]
    old = (ended / "history.csv").read_text()
    assert (stopped / "history.csv").read_text().startswith(old)
    early = shutil.copytree(stopped, stopped.with_name("early"))
    assert resume(stopped, until=10e-6, frames=False)["time"] == 10e-6
    (early / NEWEST).unlink()
    assert resume(early, until=10e-6, frames=False)["time"] == 10e-6
    assert not differences(stopped, early), "from before the end it had in between"
    times = [snapshot.time(path) for path in snapshot.find(stopped)][-3:]
    assert times == [8e-6, 9e-6, 10e-6], "outputs are where they were due"


def test_a_damaged_snapshot_is_named_before_anything_is_changed(stopped, ended):
    damaged = snapshot.find(stopped)[1]
    damaged.write_bytes(damaged.read_bytes()[:-1])
    before = {path: path.read_bytes() for path in stopped.rglob("*") if path.is_file()}
    with pytest.raises(InputError, match=f"{damaged} is damaged .*; move it away to go on without it"):
        resume(stopped, frames=False)
    assert before == {path: path.read_bytes() for path in stopped.rglob("*") if path.is_file()}
    damaged.unlink()
    summary = resume(stopped, frames=False)
    assert summary["outcome"] == "done" and not summary["warnings"]
    names = [path.name for path in snapshot.find(ended)]
    assert [path.name for path in snapshot.find(stopped)] == [name for name in names if name != damaged.name]


def test_a_run_goes_on_in_a_folder_of_any_name(stopped, tmp_path):
    """What is said names the folder, is kept, and has to be read again."""
    out = stopped.rename(tmp_path / "a\tb")
    (out / NEWEST).write_bytes(b"")
    with pytest.raises(KeyboardInterrupt):
        resume(out, frames=False, progress=Stopper(2))
    (line,) = resume(out, frames=False)["warnings"]
    assert f"a\\tb/{NEWEST} is damaged" in line and line.isprintable()


def test_wall_times_and_steps_add_up(stopped, ended):
    before = checkpoint.facts(stopped / NEWEST)["job"]
    summary = resume(stopped, frames=False)
    assert summary["steps"] == json.loads((ended / "summary.json").read_text())["steps"]
    assert summary["step_wall_s"] > before["step_wall"] > 0.0
    assert summary["wall_s"] > before["wall"] > before["step_wall"]


def test_asked_to_stop_in_the_last_batch_it_has_ended(ended, tmp_path):
    class AtTheEnd(Stopper):
        def update(self, **now):
            self._left = 1 if now["time"] == 6e-6 else 2
            super().update()

    assert start(tmp_path / "out", progress=AtTheEnd(2))["time"] == 6e-6
    assert not differences(ended, tmp_path / "out")


def test_history_rows_of_what_is_done_again_are_there_once(stopped, ended):
    """Rows that were written after the checkpoint, before a kill."""
    rows = history.read(stopped / "history.csv")[2]["time"]
    lines = (ended / "history.csv").read_text().splitlines(keepends=True)
    (stopped / "history.csv").write_text("".join(lines[: len(rows) + 5]))
    resume(stopped, frames=False)
    assert (stopped / "history.csv").read_text() == "".join(lines)


def test_a_history_that_lost_rows_is_said(stopped, ended):
    """The system went down: the checkpoint was on the disk, the last rows were not."""
    lines = (stopped / "history.csv").read_text().splitlines(keepends=True)
    (stopped / "history.csv").write_text("".join(lines[:-3]))
    listener = Stopper(0)
    summary = resume(stopped, frames=False, progress=listener)
    assert summary["warnings"] == listener.said[1:]
    assert "history.csv has lost its rows after t = " in listener.said[1]
    whole = (ended / "history.csv").read_text().splitlines(keepends=True)
    assert (stopped / "history.csv").read_text() == "".join([*whole[: len(lines) - 3], *whole[len(lines) :]])


def test_large_runs_read_the_clock_more_often(monkeypatch):
    """A few seconds pass at most until a run sees that it is to stop; what comes out is the same."""
    made = collision(speed=400.0)
    monkeypatch.setattr("warpsph.solver.BATCH_PARTICLES", {False: 3 * len(made) + 1, True: 0})
    steps, solver = [0], Solver(made.finalize())
    solver.advance(1e-6, lambda now: steps.append(now.steps))
    assert max(np.diff(steps)) == 3
