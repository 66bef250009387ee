"""The two-dimensional impact, small, from the command line to files that other programs read."""

import contextlib
import io
import json

import numpy as np
import pytest
from PIL import Image

from warpsph import cli
from warpsph.fields import FIELDS
from warpsph.storage import history, snapshot

KEYS = {
    "scene", "scheme", "parameters", "device", "precision", "threads", "particles", "particles_per_body", "dim",
    "steps", "time", "dt_min", "dt_max", "wall_s", "step_wall_s", "ns_per_particle_step", "mean_neighbours",
    "ns_per_pair", "energy_error", "momentum_error", "angular_momentum_error", "measures", "warnings", "version",
}  # fmt: skip
UNTIL = 2e-6


def command(*tokens):
    """Exit code, stdout and stderr of a command line."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), pytest.raises(SystemExit) as ended:
        cli.main(tokens)
    return ended.value.code, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def impact(tmp_path_factory):
    """Folder of a run that has ended."""
    folder = tmp_path_factory.mktemp("runs") / "impact"
    options = ["--spacing", "5e-4", "--scheme", "sav1-as", "--until", str(UNTIL), "--no-frames"]
    code, out, err = command("run", "hvi_2d", "--out", str(folder), *options)
    assert code == 0, err
    assert str(folder) in out
    return folder


def files(folder):
    """Everything in a folder, with content."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_the_summary_tells_everything(impact):
    summary = json.loads((impact / "summary.json").read_text())
    assert summary.keys() >= KEYS
    assert (summary["scene"], summary["scheme"], summary["dim"]) == ("hvi_2d", "sav1-as", 2)
    assert summary["parameters"]["spacing"] == 5e-4
    assert summary["particles"] == sum(summary["particles_per_body"].values()) > 700
    assert summary["time"] == UNTIL and summary["steps"] > 30
    assert 0.0 < summary["dt_min"] <= summary["dt_max"] < UNTIL / 10
    assert 0.0 < summary["step_wall_s"] < summary["wall_s"]
    assert summary["ns_per_particle_step"] == pytest.approx(
        1e9 * summary["step_wall_s"] / summary["particles"] / summary["steps"], rel=1e-6
    )
    assert 15 < summary["mean_neighbours"] < 28  # 24 in a square lattice with a support of 2.8 spacings
    assert summary["energy_error"] < 1e-12 and summary["momentum_error"] < 1e-12
    assert 8e9 < summary["measures"]["peak_pressure"] < 30e9
    assert summary["warnings"] == []


def test_the_history_goes_on_in_time(impact):
    names, units, table = history.read(impact / "history.csv")
    summary = json.loads((impact / "summary.json").read_text())
    assert names[0] == "time" and units[0] == "s"
    assert {
        "dt",
        "kinetic_energy",
        "internal_energy",
        "total_energy",
        "momentum_x",
        "angular_momentum_z",
    } <= set(names)
    assert set(summary["measures"]) <= set(names)
    time, energy = table["time"], table["total_energy"]
    assert len(time) > 15 and (np.diff(time) > 0.0).all() and (time[0], time[-1]) == (0.0, UNTIL)
    np.testing.assert_allclose(energy, table["kinetic_energy"] + table["internal_energy"], rtol=1e-12)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
    assert table["internal_energy"][-1] > 0.1 * energy[0]
    assert table["peak_pressure"][-1] == summary["measures"]["peak_pressure"]


def test_other_programs_read_the_snapshots(impact):
    import pyvista

    paths = snapshot.find(impact)
    index = json.loads((impact / "snapshots" / "hvi_2d.vtkhdf.series").read_text())
    assert [entry["name"] for entry in index["files"]] == [path.name for path in paths]
    times = [entry["time"] for entry in index["files"]]
    np.testing.assert_allclose(times, np.linspace(0.0, UNTIL, len(paths)), atol=1e-15)
    mesh, state = pyvista.read(paths[-1]), snapshot.read(paths[-1])
    assert mesh.n_points == mesh.n_cells == len(state.id)
    np.testing.assert_array_equal(mesh.points, state.x)
    for f in FIELDS:
        if f.output and not f.group and f.name != "x":
            found = np.asarray(mesh.point_data[f.title]).reshape(state.fields[f.name].shape)
            np.testing.assert_array_equal(found, state.fields[f.name], err_msg=f.title)
    np.testing.assert_array_equal(state.id, np.arange(len(state.id)))
    assert state.time == UNTIL and state.bodies == ["projectile", "plate"]


def test_pictures_show_something(impact, tmp_path):
    size = ("--size", "400", "300", "--every", "10", "--output", str(tmp_path / "frames"))
    code, out, err = command("render", str(impact), "--field", "speed", *size)
    if code == 3 and "draw" in err:
        pytest.skip(f"this machine cannot draw: {err}")
    assert code == 0, err
    pictures = [np.asarray(Image.open(line).convert("RGB")).astype(int) for line in out.split()]
    assert len(pictures) == 3 and all(picture.shape == (300, 400, 3) for picture in pictures)
    for picture in pictures:
        colours = np.unique(picture.reshape(-1, 3), axis=0)
        assert len(colours) > 100 and picture.std() > 5.0
    assert np.abs(pictures[0] - pictures[-1]).mean() > 0.5, "something has moved"


def test_the_run_is_described_and_plotted(impact, tmp_path):
    code, out, _ = command("info", str(impact))
    assert code == 0 and "projectile" in out and "peak_pressure" in out
    code, out, _ = command("info", str(snapshot.find(impact)[-1]))
    assert code == 0 and "pressure" in out and "Pa" in out
    code, out, _ = command("plot", str(impact), "--output", str(tmp_path / "plot.svg"))
    assert code == 0 and (tmp_path / "plot.svg").stat().st_size > 5000


def test_a_folder_in_use_is_left_alone(impact):
    before = files(impact)
    code, out, err = command("run", "hvi_2d", "--spacing", "5e-4", "--out", str(impact))
    assert (code, out) == (2, "") and "not empty" in err and err.count("\n") == 1
    code, out, err = command("resume", str(impact))
    assert code == 0 and "is done" in err and "peak_pressure" in out
    code, out, err = command("resume", str(impact), "--until", str(0.5 * UNTIL))
    assert code == 2 and "until" in err and err.count("\n") == 1
    assert files(impact) == before


def test_a_run_goes_on_later_and_can_be_replaced(impact):
    """Last, because it changes the folder."""
    later = 1.25 * UNTIL
    code, _, err = command("resume", str(impact), "--until", str(later), "--no-frames")
    assert code == 0, err
    summary = json.loads((impact / "summary.json").read_text())
    assert summary["time"] == later and summary["energy_error"] < 1e-12
    table = history.read(impact / "history.csv")[2]
    assert (np.diff(table["time"]) > 0.0).all() and table["time"][-1] == later
    times = [snapshot.time(path) for path in snapshot.find(impact)]
    assert times == sorted(set(times)) and times[-1] == later
    options = ["--spacing", "5e-4", "--until", "2e-7", "--no-frames", "--force"]
    assert command("run", "hvi_2d", "--out", str(impact), *options)[0] == 0
    times = [snapshot.time(path) for path in snapshot.find(impact)]
    assert times[-1] == 2e-7 and times == sorted(times), "nothing of the old run is left"
    assert json.loads((impact / "summary.json").read_text())["scheme"] == "sav1"
