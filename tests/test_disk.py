"""A disk that takes no more stops a run in good order; what is only shown is never worth a run."""

import errno
import io
import os
import resource
import shutil
import subprocess
import sys
import types

import numpy as np
import pytest
import warp as wp
from tools import collision

from warpsph import cli
from warpsph.device import compilation
from warpsph.drawing import movie
from warpsph.errors import DiskError, InputError, RunError
from warpsph.progress import Progress
from warpsph.quality.torture import disk, faults
from warpsph.quality.torture.trial import Means
from warpsph.run import run as run_scene
from warpsph.running import footprint, streams
from warpsph.solver import Solver
from warpsph.storage import atomic, checkpoint, folder, history, snapshot


def full(what="", path=""):
    """Fail as a full disk does."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def test_the_trial_holds(tmp_path):
    """Its quick version: a call of each stage refused, and a real limit in a process of its own."""
    found = disk.run(Means(tmp_path, quick=True, say=lambda line: None))
    assert found.failed == []
    assert {row[0].partition(", ")[2] for row in found.rows[:-1]} == {*disk.STAGES.values(), "folders"} - {
        "frames"
    }


@pytest.mark.parametrize("how", [atomic.write, lambda path, content: history.History(path, [("time", "s")])])
def test_the_message_names_file_cause_and_remedy(tmp_path, how):
    path = tmp_path / "a.csv"
    path.write_bytes(b"old")
    with faults.watched(lambda what, _: what == "write" and full()), pytest.raises(DiskError) as stopped:
        how(path, b"new")
    text = str(stopped.value)
    assert text.startswith(f"{path} could not be written: No space left on device (")
    assert " free" in text and text.endswith("); free some space") and "\n" not in text
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.csv"] and path.read_bytes() == b"old"


def test_a_pipe_in_the_place_of_a_new_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / ".a.part")
    atomic.write(tmp_path / "a", b"content")
    assert (tmp_path / "a").read_bytes() == b"content" and len(list(tmp_path.iterdir())) == 1


def test_a_row_is_there_whole_or_not_at_all(tmp_path):
    """The system takes the first bytes of a row, and no more."""
    path, limits = tmp_path / "history.csv", resource.getrlimit(resource.RLIMIT_FSIZE)
    with history.History(path, [("time", "s"), ("step", "1")]) as table:
        table.write([0.5, 12])
        whole = path.read_bytes()
        resource.setrlimit(resource.RLIMIT_FSIZE, (len(whole) + 3, limits[1]))
        try:
            with pytest.raises(DiskError, match=r"history.csv could not be written: File too large"):
                table.write([0.75, 13])
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        assert path.read_bytes() == whole
        table.write([0.75, 13])
        path.unlink()
        for call in (lambda: table.write([1.0, 14]), table.sync):
            with pytest.raises(DiskError, match=r"history.csv could not be written: No such file"):
                call()


def test_hdf5_that_stumbles_over_a_failed_disk_does_not_hide_it(tmp_path, monkeypatch):
    import h5py

    def stumble(*_, **__):
        raise RuntimeError("unable to read")

    monkeypatch.setattr(h5py.Group, "create_dataset", stumble)
    with (
        faults.watched(lambda what, _: what == "write" and full()),
        pytest.raises(DiskError, match="No space left"),
    ):
        checkpoint.save(tmp_path / "c.h5", {"x": np.zeros(3)}, {})


def test_a_particle_and_a_disk_that_fail_at_once_are_both_named(tmp_path, monkeypatch):
    advance = Solver.advance

    def spoiled(self, t_stop, on_batch=None):
        if self.reading.time > 0.0:
            v = self.particles.v.numpy().copy()
            v[9] = np.nan
            self.particles.v.assign(v)
        advance(self, t_stop, on_batch)

    monkeypatch.setattr(Solver, "advance", spoiled)
    made, out = collision(speed=1000.0), tmp_path / "out"
    made.until, made.snapshots = 1e-6, 2
    with (
        faults.watched(lambda what, path: "0002" in path.name and full()),
        pytest.raises(RunError) as stopped,
    ):
        run_scene(made, out, frames=False)
    text = str(stopped.value)
    assert not isinstance(stopped.value, DiskError)
    assert (
        "velocity not finite; " in text
        and "; besides, " in text
        and "test_0002.vtkhdf could not be written: No space" in text
    )
    assert text.endswith(f"; last snapshot: {out}/snapshots/test_0001.vtkhdf")


@pytest.mark.parametrize("scheme", ["sav1", "adaptle"])
def test_the_size_of_an_output_is_known_before(tmp_path, scheme):
    solver = Solver(collision(radius=25.5, scheme=scheme).finalize())
    snapshot.write(tmp_path / "s.vtkhdf", solver.state())
    checkpoint.save(tmp_path / "c.h5", solver.save()[0], {})
    sizes = {"s.vtkhdf": footprint.snapshot_size(solver.particles), "c.h5": footprint.checkpoint_size(solver)}
    for name, size in sizes.items():
        assert 1.0 <= (tmp_path / name).stat().st_size / size < 1.1


def test_a_run_that_cannot_fit_is_refused_and_one_that_may_not_is_warned_of(tmp_path, monkeypatch):
    made, out, said = collision(speed=1000.0), tmp_path / "out", io.StringIO()
    made.until, made.snapshots = 1e-7, 2
    free = 60_000
    monkeypatch.setattr(shutil, "disk_usage", lambda path: types.SimpleNamespace(total=1e9, free=free))
    monkeypatch.setattr(compilation, "PER_MODULE", 0)
    with pytest.raises(
        InputError, match=r"out has no room: the first output takes about \d+.* kB, 60 kB are free"
    ):
        run_scene(made, out, frames=False)
    assert not out.exists()
    free = 150_000
    run_scene(made, out, frames=False, progress=Progress(said))
    assert "warning: the whole run takes about" in said.getvalue() and "150 kB are free" in said.getvalue()
    free = 60_000
    run_scene(made, out, frames=False, force=True)  # what is there makes room


def test_a_folder_that_a_full_disk_refuses_is_no_bad_input(tmp_path):
    with faults.watched(lambda what, path: what == "mkdir" and full(what, path)):
        with pytest.raises(DiskError, match=r"out could not be written: No space left"):
            folder.prepare(tmp_path / "out", force=False)


def test_kernels_are_not_compiled_into_a_full_disk(monkeypatch):
    """The compiler would end the process; those that are there are no matter."""
    made = collision().finalize()
    kernels = Solver(made)._kernels()
    monkeypatch.setattr(shutil, "disk_usage", lambda path: types.SimpleNamespace(total=1e9, free=1000))
    Solver(made)
    monkeypatch.setattr(wp.config, "kernel_cache_dir", "no_such_cache")
    with pytest.raises(
        DiskError, match=r"kernel cache no_such_cache has no room: .* MB, 1 kB are free; .*WARP_CACHE_PATH"
    ):
        compilation.compile_modules(kernels, wp.get_device("cpu"))


def test_a_film_that_does_not_fit_is_not_there(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    noise, limits = np.random.default_rng(0), resource.getrlimit(resource.RLIMIT_FSIZE)
    path = tmp_path / "film.mp4"
    path.write_bytes(b"old")
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, limits[1]))
    try:
        with pytest.raises(DiskError, match=r"film.mp4 could not be written: File too large"):
            movie.write(path, (noise.integers(0, 255, (64, 64, 3), dtype=np.uint8) for _ in range(20)), 20)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.mp4"] and path.read_bytes() == b"old"


class Broken(io.StringIO):
    """A stream that takes nothing."""

    def __init__(self, error):
        super().__init__()
        self.error, self.tries = error, 0

    def write(self, text):
        self.tries += 1
        raise self.error

    def flush(self):
        raise self.error


@pytest.mark.parametrize(
    "error", [BrokenPipeError(32, "Broken pipe"), OSError(28, "No space left"), ValueError("closed")]
)
def test_progress_that_nobody_can_read_is_dropped(error):
    stream = Broken(error)
    report = Progress(stream)
    report.start(1.0)
    report.update(time=1.0, step=3, dt=0.1, energy_error=0.0, rate=1.0)
    report.message("a line")
    report.stop()
    assert stream.tries, "it has tried to say something, and gone on"


@pytest.mark.parametrize(
    ("error", "code"), [(BrokenPipeError(32, "Broken pipe"), 0), (OSError(28, "No space left"), 4)]
)
def test_results_that_cannot_be_printed(monkeypatch, capsys, error, code):
    """A reader that has had enough is no error; a full disk is."""
    monkeypatch.setattr(sys, "stdout", Broken(error))
    with pytest.raises(SystemExit) as ended:
        cli.main(["materials"])
    assert ended.value.code == code
    said = capsys.readouterr().err
    words = "warpsph: standard output could not be written: No space left"
    assert said.startswith(words) if code else said == ""


def test_a_closed_stream_is_filled_before_a_file_takes_its_number(tmp_path):
    kept = os.dup(0)
    try:
        os.close(0)
        streams.fill()
        with (tmp_path / "a").open("w") as file:
            assert file.fileno() > 2
    finally:
        os.dup2(kept, 0)
        os.close(kept)


def test_a_process_without_streams_has_some_that_take_what_libraries_say():
    script = (
        "import os, sys, warnings; from warpsph.running import streams; streams.fill(); "
        "warnings.showwarning = lambda m, *_: sys.stderr.write(str(m)); warnings.warn('x'); print('y'); "
        "sys.exit(7 if sys.stdout and sys.stderr else 1)"
    )
    done = subprocess.run(["bash", "-c", f'{sys.executable} -c "{script}" >&- 2>&-'], check=False)
    assert done.returncode == 7
