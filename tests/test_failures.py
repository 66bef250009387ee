"""Runs that cannot go on say which particle is to blame; runs that are interrupted end in good order."""

import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tools import SPACING, by_id, collision, jittered, scene

from warpsph import cli
from warpsph.config import Contact
from warpsph.errors import DiskError, RunError
from warpsph.kernels.timestep import COLLAPSED
from warpsph.shapes import Disc
from warpsph.solver import Solver
from warpsph.storage import checkpoint, history, snapshot
from warpsph.watching.trouble import explain

MICRO = 1e-6


def poke(solver, particle, name, value):
    """Overwrite a field of one particle."""
    array = getattr(solver.particles, name)
    values = array.numpy().copy()
    values[np.flatnonzero(solver.particles.id.numpy() == particle)[0]] = value
    array.assign(values)


@pytest.fixture
def solver():
    solver = Solver(collision(speed=1000.0).finalize())
    solver.advance(0.5 * MICRO)
    return solver


@pytest.mark.parametrize(
    ("name", "value", "cause"),
    [
        ("v", (np.nan, 0.0, 0.0), "velocity not finite"),
        ("x", (0.0, np.inf, 0.0), "position not finite"),
        ("rho", np.nan, "density not finite"),
        ("e", np.inf, "energy not finite"),
    ],
)
def test_a_state_that_is_not_finite_stops_the_run(solver, name, value, cause):
    steps = solver.reading.steps
    poke(solver, 70, name, value)
    x, y, z = by_id(solver, "x")[70]
    with pytest.raises(RunError) as stopped:
        solver.advance(4 * MICRO)
    message = str(stopped.value)
    assert (
        f"particle 70 of body 'right' (material 'aluminium') at ({x:.6g}, {y:.6g}, {z:.6g}) m: {cause}"
        in message
    )
    assert f"step {steps}:" in message and "\n" not in message
    assert solver.reading.steps == steps, "nothing was stepped on with it"


def test_a_collapsing_time_step_stops_the_run(solver):
    poke(solver, 3, "e", 1e26)  # a particle that explodes
    with pytest.raises(
        RunError, match=r"particle 3 of body 'left' .*at \(.*\) m: time step collapsed to .* s"
    ):
        solver.advance(4 * MICRO)


def test_a_particle_too_fast_for_any_step_stops_the_run(solver):
    poke(solver, 3, "v", (0.0, -1e13, 0.0))
    with pytest.raises(
        RunError, match=r"particle 3 of body 'left' .*collapsed to 1.2e-16 s .*speed 1e\+13 m/s"
    ):
        solver.advance(4 * MICRO)


def test_a_contact_too_stiff_for_any_step_is_found():
    solver = Solver(collision(scheme="sav1", contact=Contact(stiffness=0.25)).finalize())
    poke(solver, 5, "contact_rate", 1e40)
    collapsed = replace(solver.reading, status=COLLAPSED)
    said = str(explain(collapsed, solver.particles, solver.data, solver._scheme))
    assert "particle 5 of body 'left'" in said and "collapsed to 5e-21 s" in said


@pytest.mark.parametrize("energy", [1e308, 1e200])
@pytest.mark.filterwarnings("error")
def test_a_scene_beyond_all_numbers_stops_at_once(energy):
    """Its sound speed overflows or its first step does: it must not go on for ever with a time step of zero."""
    made = scene(2)
    made.add_body("bomb", Disc(4 * SPACING), "aluminium", internal_energy=energy)
    solver, batches = Solver(made.finalize()), iter(range(200))

    def give_up(_):
        return next(batches, None) is None

    with pytest.raises(RunError, match=r"particle \d+ of body 'bomb' .*(not finite|collapsed)"):
        solver.advance(MICRO, give_up)


def crushed(**numerics):
    """A block one of whose particles is about to turn over; nobody can help it."""
    made = scene(2, scheme="adaptle", **numerics)
    x = jittered(2, 9, 0.0)
    rate = 1e9
    made.add_body("block", x, "aluminium", velocity=lambda x: -rate * (x - 4.0 * SPACING) * [1.0, 0.0, 0.0])
    made.fix("block")
    solver = Solver(made.finalize())
    poke(solver, 40, "F", np.diag([0.0101, 1.0, 1.0]))
    return solver


def test_a_lagrangian_particle_that_turns_over_stops_the_run():
    solver = crushed()
    with pytest.raises(RunError) as stopped:
        solver.advance(MICRO)
    message = str(stopped.value)
    assert "particle 40 of body 'block' (material 'aluminium') at (0.004, 0.004, 0) m: turned over" in message
    assert "det F below 0.01" in message and "\n" not in message
    assert np.isfinite(by_id(solver, "F")).all()


def test_or_the_run_goes_on_with_eulerian_ones():
    solver = crushed(inverted="convert")
    solver.advance(1e-11)
    kind = by_id(solver, "kernel_type")
    assert kind[40] == 0 and kind[0] == 1
    solver.advance(5e-11)
    assert solver.tally()["inverted"] >= 1
    assert np.isfinite(by_id(solver, "rho")).all()


SCENE = '''
"""Two balls."""
from warpsph.scene import Scene
from warpsph.shapes import Disc


def build() -> Scene:
    """Build it."""
    scene = Scene("balls", dim=2, spacing=1e-3, until=3e-6, snapshots=6)
    scene.add_body("left", Disc(4.5e-3, (-5e-3, 0.0)), "aluminium", velocity=(1000.0, 0.0))
    scene.add_body("right", Disc(4.5e-3, (5e-3, 2e-3)), "aluminium")
    return scene


if __name__ == "__main__":
    import warpsph.cli

    warpsph.cli.run_file(__file__)
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a scene, to work in."""
    monkeypatch.chdir(tmp_path)
    Path("balls.py").write_text(SCENE)
    return tmp_path


def command(*tokens):
    """Exit code of a command line."""
    with pytest.raises(SystemExit) as ended:
        cli.main(tokens)
    return ended.value.code


def test_the_command_line_tells_the_failure_and_keeps_the_last_snapshot(folder, monkeypatch, capsys):
    advance = Solver.advance

    def spoiled(self, t_stop, on_batch=None):
        if t_stop > 1.2 * MICRO:
            poke(self, 9, "v", np.nan)
        advance(self, t_stop, on_batch)

    monkeypatch.setattr(Solver, "advance", spoiled)
    assert command("run", "balls.py", "--out", "out", "--no-frames") == 3
    err = capsys.readouterr().err
    assert "particle 9 of body 'left'" in err and "velocity not finite" in err
    last = snapshot.find(folder / "out")[-1]
    assert str(last.relative_to(folder)) in err
    assert np.isnan(snapshot.read(last).v[9]).all() and snapshot.read(last).time > 0.9 * MICRO
    summary = json.loads(Path("out/summary.json").read_text())
    assert "particle 9" in summary["warnings"][0]
    assert np.isfinite(checkpoint.load(folder / "out/checkpoint.h5")[0]["v"]).all(), (
        "one can go on from before"
    )


def test_a_snapshot_that_cannot_be_written_stops_the_run(folder, monkeypatch, capsys):
    write = snapshot.write

    def full(path, state):
        if path.stem.endswith("3"):
            raise DiskError(f"{path} could not be written: No space left on device")
        write(path, state)

    monkeypatch.setattr(snapshot, "write", full)
    assert command("run", "balls.py", "--out", "out", "--no-frames") == 4
    err = capsys.readouterr().err
    assert "balls_0003.vtkhdf could not be written: No space left on device" in err
    assert "last snapshot: out/snapshots/balls_0002.vtkhdf; then `warpsph resume out` goes on" in err
    assert [path.name for path in snapshot.find("out")] == [f"balls_000{k}.vtkhdf" for k in range(3)]
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert command("resume", "out", "--no-frames") == 0, "with room on the disk it goes on"
    assert len(snapshot.find("out")) == 7
    capsys.readouterr()


def test_ctrl_c_ends_in_good_order(folder, capsys):
    Path("long.py").write_text(SCENE.replace("until=3e-6", "until=3e-3"))  # longer than anyone waits
    out = folder / "out"
    process = subprocess.Popen(
        [sys.executable, "long.py", "--out", str(out), "--no-frames", "--threads", "1"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        table, deadline = out / "history.csv", time.monotonic() + 120.0
        while not (table.exists() and table.read_text().count("\n") > 3):
            assert process.poll() is None and time.monotonic() < deadline, "it never got going"
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        shown = process.communicate(timeout=60.0)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130, shown
    assert "interrupted" in shown[1] and "Traceback" not in shown[1]
    info, last = checkpoint.load(out / "checkpoint.h5")[1], snapshot.find(out)[-1]
    assert info["time"] == snapshot.time(last) > 0.0
    assert json.loads((out / "summary.json").read_text())["time"] == info["time"]

    until = info["time"] + 2 * MICRO
    assert command("resume", str(out), "--until", str(until), "--no-frames") == 0
    assert json.loads((out / "summary.json").read_text())["time"] == until
    assert snapshot.time(snapshot.find(out)[-1]) == until
    times = history.read(table)[2]["time"]
    assert (np.diff(times) > 0.0).all() and times[-1] == until
    capsys.readouterr()
