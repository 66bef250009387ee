"""Two runs in one folder exclude each other, and a lock that was left behind keeps nobody out."""

import fcntl
import json
import os
import socket
import subprocess
import sys
import threading

import pytest
from tools import collision

from warpsph.errors import DiskError, InputError
from warpsph.progress import Progress
from warpsph.quality.torture import lock as trial
from warpsph.quality.torture.trial import Means
from warpsph.run import resume
from warpsph.run import run as run_scene
from warpsph.storage import folder, lock, snapshot

OVER = 2**22 + 1
"""A process number that Linux gives to none."""


def ignore(line):
    """Take a line that nobody reads."""


def entry(**changes):
    """What a lock file holds."""
    return json.dumps({"host": socket.gethostname(), "pid": os.getpid(), "since": "yesterday"} | changes)


@pytest.fixture(params=["locks", "no locks"])
def system(request, monkeypatch):
    """File systems with locks and without."""
    if request.param == "no locks":

        def refuse(file, how):
            raise OSError(38, "Function not implemented")

        monkeypatch.setattr(fcntl, "flock", refuse)
    return request.param


def test_a_lock_names_its_holder_and_is_gone_afterwards(system, tmp_path):
    with lock.held(tmp_path, ignore):
        found = json.loads((tmp_path / "run.lock").read_text())
        assert (found["host"], found["pid"]) == (socket.gethostname(), os.getpid())
        with pytest.raises(InputError) as refused, lock.held(tmp_path, ignore):
            pass
    message = str(refused.value)
    assert str(tmp_path) in message and "\n" not in message
    for word in (socket.gethostname(), str(os.getpid()), found["since"]):
        assert word in message
    assert not list(tmp_path.iterdir())
    with lock.held(tmp_path, ignore):
        pass


def test_a_lock_that_was_left_behind_is_taken_over(system, tmp_path):
    (tmp_path / "run.lock").write_text(entry(pid=OVER))
    told = []
    with lock.held(tmp_path, told.append):
        assert json.loads((tmp_path / "run.lock").read_text())["pid"] == os.getpid()
    assert len(told) == 1 and f"process {OVER} on" in told[0] and "taken over" in told[0]


def test_a_lock_ends_with_its_process_however_that_ends(tmp_path):
    code = f"""
import os
from warpsph.storage import lock
with lock.held({str(tmp_path)!r}, print):
    os.kill(os.getpid(), 9)
"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == -9
    told = []
    with lock.held(tmp_path, told.append):
        pass
    assert len(told) == 1


@pytest.mark.parametrize("content", ["", "{", "[]", "\xff", '{"pid": "x"}'])
def test_a_lock_file_that_says_nothing_stops_nobody_where_there_are_locks(tmp_path, content):
    (tmp_path / "run.lock").write_bytes(content.encode("latin-1"))
    with lock.held(tmp_path, ignore):
        assert json.loads((tmp_path / "run.lock").read_text())["pid"] == os.getpid()


def test_what_a_lock_file_says_is_bounded_and_printable(tmp_path):
    path, told = tmp_path / "run.lock", []
    path.write_text(entry(pid=OVER, since="\x1b[2J"))
    with lock.held(tmp_path, told.append):
        pass
    assert len(told) == 1 and told[0].isprintable() and "since \\x1b[2J" in told[0]
    path.write_text("[" * lock.LONGEST)
    assert not lock.holder(tmp_path)
    path.write_text(entry(since="x" * lock.LONGEST))
    assert not lock.holder(tmp_path)
    path.unlink()
    os.mkfifo(path)
    assert not lock.holder(tmp_path)
    with pytest.raises((InputError, DiskError), match="could not be written"), lock.held(tmp_path, ignore):
        pass


def test_without_locks_only_the_own_host_knows_who_is_over(tmp_path, monkeypatch):
    monkeypatch.setattr(lock, "_has_locks", lambda folder: False)
    path = tmp_path / "run.lock"
    for content in (entry(pid=OVER, host="elsewhere"), ""):
        path.write_text(content)
        with pytest.raises(InputError, match=f"if it is over, remove {path}"), lock.held(tmp_path, ignore):
            pass
        assert path.read_text() == content


def test_who_waits_for_a_file_that_is_removed_takes_the_new_one(tmp_path, monkeypatch):
    """The holder leaves between another's opening of the file and its locking."""
    flock, path = fcntl.flock, tmp_path / "run.lock"
    path.touch()

    def late(file, how):
        if path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat()):
            monkeypatch.setattr(fcntl, "flock", flock)
            path.unlink()
        flock(file, how)

    monkeypatch.setattr(fcntl, "flock", late)
    with lock.held(tmp_path, ignore):
        assert path.read_text(), "the file that is there is the one that is locked"


def test_who_is_refused_waits_for_the_name_of_the_holder(tmp_path):
    """The holder has locked the file, which still names one that is over, and is about to write its own name."""
    path = tmp_path / "run.lock"
    path.write_text(entry(pid=OVER))
    with path.open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        late = threading.Timer(0.1, path.write_text, [entry(since="just now")])
        late.start()
        with (
            pytest.raises(InputError, match=f"process {os.getpid()} .* since just now"),
            lock.held(tmp_path, ignore),
        ):
            pass
        late.join()


def test_folders_made_in_vain_are_taken_away(tmp_path):
    with pytest.raises(ZeroDivisionError), lock.held(tmp_path / "a" / "b", ignore):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
    with pytest.raises(InputError, match="device 'cuda:99'"):
        run_scene(collision(), tmp_path / "out", device="cuda:99")
    assert not list(tmp_path.iterdir())
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be written"), lock.held(tmp_path / "file" / "b", ignore):
        pass


def test_a_folder_with_a_lock_and_nothing_else_is_empty(tmp_path):
    (tmp_path / "run.lock").write_text(entry(pid=OVER))
    folder.check(tmp_path, force=False)
    (tmp_path / "mine.txt").touch()
    with pytest.raises(InputError, match="not empty"):
        folder.check(tmp_path, force=False)
    with lock.held(tmp_path, ignore), pytest.raises(InputError, match=f"in use by process {os.getpid()}"):
        folder.check(tmp_path, force=False)


def test_what_a_kill_left_half_written_is_cleared_away(tmp_path):
    (tmp_path / "snapshots").mkdir()
    for name in (".checkpoint.h5.part", "snapshots/.a_0001.vtkhdf.part", ".hidden", "a.part"):
        (tmp_path / name).touch()
    folder.tidy(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [".hidden", "a.part", "snapshots"]
    assert not list((tmp_path / "snapshots").iterdir())


class Intruder(Progress):
    """Starts other runs in the folder of one that is going on."""

    def __init__(self, out):
        super().__init__()
        self.out, self.refusals = out, []

    def update(self, **_):
        if self.refusals:
            return
        for force in (False, True):
            with pytest.raises(InputError) as refused:
                run_scene(collision(), self.out, force=force)
            self.refusals.append(str(refused.value))
        with pytest.raises(InputError) as refused:
            resume(self.out)
        self.refusals.append(str(refused.value))


def test_a_folder_in_use_is_refused_and_left_alone(tmp_path):
    out = tmp_path / "out"
    progress = Intruder(out)
    made = collision(speed=1000.0)
    made.until, made.snapshots = 1e-6, 2
    run_scene(made, out, frames=False, source="scene", progress=progress)
    assert (out / "scene.py").read_text() == "scene"
    assert len(progress.refusals) == 3
    assert all(f"in use by process {os.getpid()} on" in line for line in progress.refusals)
    assert len(snapshot.find(out)) == 3 and not (out / "run.lock").exists()


def test_the_short_trial_holds(tmp_path):
    found = trial.run(Means(tmp_path, True, ignore))
    assert not found.failed and [row[1:] for row in found.rows] == [("1", "1")]
