"""The command line: what it passes on, its exit codes, and one clear line for whatever is wrong."""

import json
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import warpsph
from warpsph import cli, info
from warpsph.errors import DiskError, Ended, InputError, RunError
from warpsph.running import walltime
from warpsph.state import State
from warpsph.storage import folder, snapshot

SCENE = '''
"""A drop on a plate."""
from typing import Literal
import warpsph.cli

class Drop:
    def __init__(self, values):
        self.values = values
    def finalize(self):
        pass

def build(*, spacing: float = 1e-4, scheme: Literal["sav1", "bal"] = "sav1", wet: bool = False):
    """Build it.

    Args:
        spacing: Particle spacing [m].
        scheme: What is solved.
        wet: Whether it is wet.
    """
    if spacing < 0:
        raise warpsph.errors.InputError(f"spacing = {spacing} is not allowed; allowed: a positive number")
    return Drop({"spacing": spacing, "scheme": scheme, "wet": wet})

if __name__ == "__main__":
    warpsph.cli.run_file(__file__)
'''.lstrip()

SUMMARY = {
    "scene": "drop",
    "device": "cpu",
    "particles_per_body": {"drop": 3, "plate": 5},
    "time": 8e-6,
    "wall_s": 75.2,
    "step_wall_s": 3.2e-3,
    "energy_error": 1.25e-13,
    "measures": {"peak_pressure": 19.4e9},
    "warnings": ["the pressure was clipped"],
}


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """A scene file in the working folder, by name."""
    monkeypatch.chdir(tmp_path)
    Path("drop.py").write_text(SCENE)
    return "drop.py"


@pytest.fixture
def runner(monkeypatch):
    """Stand-in for `warpsph.run` that keeps what it is called with."""
    fake = types.SimpleNamespace(calls=[], failure=None)

    def note(*args, **options):
        fake.calls.append((args, options))
        if fake.failure:
            raise fake.failure
        return SUMMARY

    fake.run = fake.resume = note
    monkeypatch.setitem(sys.modules, "warpsph.run", fake)
    return fake


@pytest.fixture
def command(capsys):
    """Run a command line; gives exit code, stdout, stderr."""

    def run(*tokens):
        with pytest.raises(SystemExit) as exit:
            cli.main(tokens)
        return exit.value.code, *capsys.readouterr()

    return run


@pytest.fixture
def state():
    """Three particles in two bodies, one with a pressure that is not finite."""
    fields = {
        "id": np.arange(3),
        "body": np.array([0, 1, 1]),
        "mat": np.array([0, 0, 1]),
        "x": np.eye(3),
        "v": np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        "p": np.array([-1e9, 2.5e9, np.nan]),
    }
    return State(3.2e-6, 40, 2, 1e-4, 1.2e-4, "drop", ["drop", "plate"], ["water", "steel"], fields)


def test_a_run_gets_its_options(scene, runner, command):
    options = ["--until", "1e-6", "--threads", "2", "--precision", "float32", "--no-frames", "--out", "here"]
    code, out, _ = command("run", scene, *options, "--spacing", "2e-4", "--wet")
    assert code == 0
    (built, folder), passed = runner.calls[0]
    assert folder == Path("here")
    assert built.values == {"spacing": 2e-4, "scheme": "sav1", "wet": True}
    assert passed["parameters"] == built.values
    assert passed["source"] == SCENE
    expected = {
        "until": 1e-6,
        "threads": 2,
        "precision": "float32",
        "frames": False,
        "force": False,
        "device": "cpu",
    }
    assert expected.items() <= passed.items()
    assert "peak_pressure" in out
    assert out.endswith("results in here\n")


def test_options_may_come_before_the_scene(scene, runner, command):
    assert command("run", "--spacing", "3e-4", "--until", "1", scene)[0] == 0
    assert runner.calls[0][0][0].values["spacing"] == 3e-4


def test_results_go_to_runs_by_default(scene, runner, command):
    assert command("run", scene)[0] == 0
    assert runner.calls[0][0][1] == Path("runs/drop")
    assert runner.calls[0][1]["threads"] is None


@pytest.mark.parametrize(
    ("tokens", "words"),
    [
        (["run"], ["SCENE"]),
        (["run", "nothing"], ["'nothing'", "allowed"]),
        (["run", "drop.py", "--spacng", "1"], ["--spacng", "--spacing"]),
        (["run", "drop.py", "--scheme", "sav9"], ["sav9", "--scheme", "sav1", "bal"]),
        (["run", "drop.py", "--spacing", "fine"], ["fine", "--spacing"]),
        (["run", "drop.py", "--spacing", "-1"], ["spacing = -1.0", "positive"]),
        (["run", "drop.py", "--precision", "float16"], ["float16", "float64", "float32", "mixed"]),
        (["run", "drop.py", "--until", "-1"], ["--until = -1.0", "positive"]),
        (["run", "drop.py", "--until", "nan"], ["--until = nan", "positive"]),
        (["run", "drop.py", "--threads", "0"], ["--threads = 0", "1 or more"]),
        (["run", "drop.py", "--walltime", "soon"], ["--walltime", "soon", "2:30:00"]),
        (["run", "drop.py", "--device", "cuda:99"], ["cuda:99", "cpu"]),
        (["run", "drop.py", "--out", "full"], ["full", "not empty", "--force"]),
        (["run", "drop.py", "--out", "drop.py"], ["drop.py", "file"]),
        (["run", "drop.py", "--out", "drop.py/in"], ["drop.py", "file"]),
        (["run", "drop.py", "--out", "a" * 300], ["a" * 300, "File name too long", "--out"]),
        (["run", "drop.py", "--out", "a/" * 3000], ["File name too long", "--out"]),
        (["run", "a" * 300 + ".py"], ["a" * 300, "File name too long"]),
        (["resume", "a" * 300], ["a" * 300, "File name too long"]),
        (["info", "a" * 300], ["a" * 300, "File name too long"]),
        (["run", "drop.py", "more"], ["'more'"]),
        (["rnu", "drop.py"], ["rnu", "run"]),
        (["resume", "full"], ["full", "checkpoint.h5"]),
        (["resume", "full", "--threads", "0"], ["--threads = 0"]),
        (["info", "nowhere"], ["nowhere"]),
        (["info", "empty"], ["empty", "summary.json"]),
        (["materials", "stel"], ["stel", "steel"]),
        (["scenes", "nothing"], ["nothing"]),
        (["plot", "empty"], ["empty"]),
        (["render", "empty"], ["empty"]),
        (["render", "empty", "--range", "1"], ["--range", "2"]),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(scene, runner, command, tmp_path, tokens, words):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.txt").write_text("precious")
    (tmp_path / "empty").mkdir()
    before = sorted(tmp_path.rglob("*"))
    code, out, err = command(*tokens)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert all(word in err for word in words), err
    assert sorted(tmp_path.rglob("*")) == before
    assert not runner.calls


def test_force_allows_a_folder_that_is_in_use(scene, runner, command, tmp_path):
    assert command("run", scene, "--out", str(tmp_path), "--force")[0] == 0
    assert runner.calls[0][1]["force"] is True


def test_every_public_name_is_there():
    assert all(getattr(warpsph, name) is not None for name in warpsph.__all__)


def test_a_folder_without_permission_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr(folder.os, "access", lambda path, mode: False)
    with pytest.raises(InputError, match="no permission"):
        folder.check(tmp_path / "a" / "b", force=True)


@pytest.mark.parametrize(
    ("failure", "code", "words"),
    [
        (RunError("particle 7 of body plate\nhas no finite pressure"), 3, "plate has no finite"),
        (InputError("density = -1.0 is not allowed"), 2, "density"),
        (Ended("wall time is up", 5), 5, "wall time is up"),
        (Ended("terminated", 143), 143, "terminated"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (PermissionError(13, "Permission denied", "here"), 2, "here: Permission denied"),
        (OSError(28, "No space left on device"), 4, "No space left"),
        (DiskError("out/a.vtkhdf could not be written"), 4, "could not be written"),
    ],
)
def test_failures_have_their_exit_codes(scene, runner, command, failure, code, words):
    runner.failure = failure
    got, _, err = command("run", scene)
    assert got == code
    assert words in err
    assert err.count("\n") == 1


def test_resume_goes_on(scene, runner, command, tmp_path):
    (tmp_path / "checkpoint.h5").touch()
    (tmp_path / "scene.py").touch()
    assert command("resume", str(tmp_path), "--until", "2e-6")[0] == 0
    (folder,), passed = runner.calls[0]
    assert folder == tmp_path
    assert passed["until"] == 2e-6
    assert passed["device"] is passed["frames"] is passed["walltime"] is None


def test_a_wall_time_counts_from_the_start_of_the_process(scene, runner, command, monkeypatch):
    monkeypatch.setattr(walltime, "age", lambda: 50.0)
    for text, left in (("1:00", 10.0), ("2-0", 172750.0), ("20", 0.0)):
        assert command("run", scene, "--walltime", text)[0] == 0
        assert runner.calls[-1][1]["walltime"] == left


def test_a_parameter_cannot_hide_an_option(scene, command):
    Path("drop.py").write_text("def build(threads: int = 1):\n    pass\n")
    code, _, err = command("run", scene)
    assert code == 2
    assert "'threads'" in err


def test_help_shows_the_parameters_of_the_scene(scene, command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    code, out, _ = command("run", scene, "--help")
    assert code == 0
    for word in (
        "A drop on a plate.",
        "--device",
        "--spacing",
        "0.0001",
        "--scheme",
        "sav1",
        "Whether it is wet.",
    ):
        assert word in out
    assert "--spacing" not in command("run", "--help")[1]


def test_version_and_help_of_everything(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    assert command("--version")[1] == warpsph.__version__ + "\n"
    code, out, _ = command("--help")
    assert code == 0
    for name in (
        "run",
        "resume",
        "render",
        "info",
        "plot",
        "materials",
        "scenes",
        "validate",
        "bench",
        "compare",
    ):
        assert name in out
        assert command(name, "--help")[0] == 0


def test_a_scene_runs_as_a_script(scene, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")

    def script(*tokens):
        return subprocess.run([sys.executable, scene, *tokens], capture_output=True, text=True, check=False)

    shown = script("--help")
    assert shown.returncode == 0
    assert "--spacing" in shown.stdout
    wrong = script("--scheme", "sav9")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.count("\n") == 1


def test_the_command_line_starts_without_heavy_libraries():
    code = (
        "import sys, warpsph.cli; print(*{'warp', 'pyvista', 'matplotlib', 'h5py', 'numpy'} & {*sys.modules})"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout == "\n"


def test_materials_are_listed_and_described(command):
    listed = command("materials")[1]
    assert "aluminium" in listed
    assert "2785" in listed
    assert "Pa" in command("materials", "aluminium")[1]


def test_scenes_are_listed_and_described(scene, command):
    assert command("scenes")[0] == 0
    shown = command("scenes", scene)[1]
    for word in (
        "A drop on a plate.",
        "--spacing",
        "0.0001",
        "Particle spacing [m].",
        "yes or no",
        "sav1, bal",
    ):
        assert word in shown


def test_info_tells_the_summary(command, tmp_path):
    (tmp_path / "summary.json").write_text(json.dumps(SUMMARY))
    for path in (tmp_path, tmp_path / "summary.json"):
        code, out, _ = command("info", str(path))
        assert code == 0
        lines = {" ".join(line.split()) for line in out.splitlines()}
        assert {
            "time 8 µs",
            "drop 3",
            "wall_s 0:01:15",
            "energy_error 1.25e-13",
            "peak_pressure 1.94e+10",
        } <= lines
        assert "warning: the pressure was clipped" in lines


def test_info_tells_the_snapshot(command, state, tmp_path):
    (tmp_path / "snapshots").mkdir()
    path = tmp_path / "snapshots" / "drop_0000.vtkhdf"
    snapshot.write(path, state)
    for where in (path, tmp_path):
        code, out, _ = command("info", str(where))
        assert code == 0
        lines = {" ".join(line.split()) for line in out.splitlines()}
        assert {"time 3.2 µs, step 40", "particles 3", "drop 1 water", "plate 2 water, steel"} <= lines
        assert {"velocity m/s 0 5", "pressure Pa -1e+09 2.5e+09 1 not finite"} <= lines


@pytest.mark.parametrize("content", ["{", "[]", "\xff"])
def test_a_damaged_summary_is_bad_input(command, tmp_path, content):
    (tmp_path / "summary.json").write_bytes(content.encode("latin-1"))
    code, _, err = command("info", str(tmp_path))
    assert code == 2
    assert "summary.json" in err


def test_render_takes_negative_numbers_and_views(monkeypatch, command, tmp_path):
    calls = []
    fake = types.SimpleNamespace(
        render=lambda folder, **options: calls.append(options) or [tmp_path / "a.png"]
    )
    monkeypatch.setitem(sys.modules, "warpsph.render", fake)
    code, out, _ = command(
        "render", str(tmp_path), "--range", "-1e9", "2.5e9", "--view", "-x", "--cut", "y=-0.01"
    )
    assert (code, out) == (0, f"{tmp_path / 'a.png'}\n")
    assert calls[0]["range"] == (-1e9, 2.5e9)
    assert calls[0]["view"] == "-x"
    assert calls[0]["cut"] == "y=-0.01"


def test_a_table_has_columns():
    assert info.table([("a", "1"), ("long", "")], ("name", "n")) == "name  n\na     1\nlong"
