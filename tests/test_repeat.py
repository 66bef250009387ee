"""Repeatability: run twice, on another number of threads, or with a stop in between, and get the same bits."""

import numpy as np
import pytest
from tools import SPACING, by_id, collision, run

from warpsph import materials as lib
from warpsph.config import Contact, Conversion
from warpsph.device.launch import SMALLEST_SLICE
from warpsph.errors import InputError
from warpsph.progress import Progress
from warpsph.run import resume
from warpsph.run import run as run_scene
from warpsph.solver import Solver
from warpsph.storage import checkpoint, history, snapshot

SCENE = '''
"""Two balls."""
from warpsph.config import Numerics
from warpsph.scene import Scene
from warpsph.shapes import Disc


def build(spacing: float = 1e-3) -> Scene:
    """Build it.

    Args:
        spacing: Particle spacing [m].
    """
    scene = Scene("balls", dim=2, spacing=spacing, until=6e-6, snapshots=4, numerics=Numerics(scheme="mon-mixed-as"))
    scene.add_body("left", Disc(4.5e-3, (-5e-3, 0.0)), "aluminium", velocity=(1000.0, 0.0))
    scene.add_body("right", Disc(4.5e-3, (5e-3, 2e-3)), "aluminium")
    scene.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    return scene
'''


def assert_same(one, two):
    assert one.particles.fields == two.particles.fields
    for f in one.particles.fields:
        np.testing.assert_array_equal(by_id(one, f.name), by_id(two, f.name), err_msg=f.name)


@pytest.mark.parametrize(
    ("scheme", "precision"),
    [("mon-mixed-as", "float64"), ("mon-mixed-as", "float32"), ("pm", "float64"), ("ts2-mixed", "float64")],
)
def test_any_number_of_threads_gives_the_same_bits(scheme, precision):
    made = collision(radius=26, scheme=scheme, speed=1000.0)
    assert len(made) > 6 * SMALLEST_SLICE, "launches are cut"
    first, again, single = (run(made, 2e-6, precision=precision, threads=k) for k in (2, 2, 1))
    assert first.reading.steps > 15 and first.neighbours.builds > 2
    assert_same(first, again)
    assert_same(first, single)
    assert first.ledger() == single.ledger()


PLATE = lib.get("aluminium-jc")
FRAGILE = lib.Material(
    "fragile", PLATE.density, PLATE.eos, PLATE.strength, PLATE.pressure_cutoff, lib.JohnsonCookDamage(D1=0.05)
)
CONTACT = Contact(stiffness=0.25)
LAGRANGIAN = {
    "eroding": {"scheme": "tl", "erosion": True, "contact": CONTACT, "hourglass": 5.0},
    "converting": {"scheme": "adaptle-mixed-as", "conversion": Conversion(strain=0.1, damage=True)},
    "touching": {"scheme": "adaptle-as", "conversion": Conversion(damage=True), "contact": CONTACT},
}
"""Runs with Lagrangian particles that end in every way."""


def ends(solver):
    """Numbers of the particles that have converted, and of those that are eroded."""
    kind = by_id(solver, "kernel_type")
    return (kind == 0).sum(), (kind == 2).sum()


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_lagrangian_runs_repeat_on_any_number_of_threads(kind):
    made = collision(radius=20, speed=1200.0, material=FRAGILE, **LAGRANGIAN[kind])
    assert len(made) > 4 * SMALLEST_SLICE, "launches are cut"
    first, again, single = (run(made, 4e-6, threads=k) for k in (2, 2, 1))
    assert sum(ends(first)) > 20
    assert_same(first, again)
    assert_same(first, single)
    assert first.ledger() == single.ledger() and first.tally() == single.tally()


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_a_lagrangian_restart_gives_the_same_bits(kind, tmp_path):
    """Reference neighbours and their gradients are found anew, interfaces and rows too."""
    made = collision(radius=8, speed=1200.0, material=FRAGILE, **LAGRANGIAN[kind])
    straight = run(made, 2e-6)
    before = ends(straight)
    assert sum(before) > 5
    checkpoint.save(tmp_path / "checkpoint.h5", *straight.save())
    straight.advance(4e-6)
    assert ends(straight) > before
    restarted = Solver(made.finalize())
    restarted.restore(*checkpoint.load(tmp_path / "checkpoint.h5"))
    restarted.advance(4e-6)
    assert restarted.reading == straight.reading
    assert restarted.neighbours.builds == straight.neighbours.builds
    assert_same(straight, restarted)
    assert restarted.tally() == straight.tally() and restarted.ledger() == straight.ledger()


@pytest.mark.parametrize("kind", LAGRANGIAN)
def test_how_steps_are_batched_changes_no_conversion(kind, monkeypatch):
    made = collision(radius=6, speed=1200.0, material=FRAGILE, **LAGRANGIAN[kind])
    batched = run(made, 3e-6)
    assert sum(ends(batched)) > 5
    monkeypatch.setattr("warpsph.solver.MAX_BATCH", 1)
    assert_same(batched, run(made, 3e-6))


def test_a_checkpoint_without_a_field_is_refused():
    solver = run(collision(), 1e-7)
    arrays, info = solver.save()
    older = {name: values for name, values in arrays.items() if name not in ("T", "D")}
    with pytest.raises(InputError, match="lacks T, D"):
        solver.restore(older, info)


def test_a_ceramic_restarts_with_the_same_bits():
    made = collision(radius=6, speed=800.0, material="sic", scheme="sav1")
    straight, stopped = (run(made, time) for time in (3e-6, 1.5e-6))
    assert straight.particles.D.numpy().max() == 1.0
    restarted = Solver(made.finalize())
    restarted.restore(*stopped.save())
    restarted.advance(3e-6)
    stopped.advance(3e-6)
    assert_same(stopped, restarted)


def test_how_steps_are_batched_changes_nothing(monkeypatch):
    made, time = collision(speed=1000.0), 4e-6
    batched = run(made, time)
    monkeypatch.setattr("warpsph.solver.MAX_BATCH", 1)
    assert_same(batched, run(made, time))


def test_what_is_saved_stays():
    """On a CPU the device's arrays can be seen from the host: what is saved must be a copy."""
    solver = run(collision(speed=1000.0), 1e-6)
    arrays, _ = solver.save()
    before = {name: array.copy() for name, array in arrays.items()}
    solver.advance(2e-6)
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, before[name], err_msg=name)


@pytest.mark.parametrize("scheme", ["mon-mixed-as", "pm", "ts2-mixed"])
def test_a_restart_gives_the_same_bits(scheme, tmp_path):
    made = collision(scheme=scheme, speed=1000.0)
    straight = run(made, 2e-6)
    checkpoint.save(tmp_path / "checkpoint.h5", *straight.save())
    straight.advance(5e-6)
    restarted = Solver(made.finalize())
    restarted.restore(*checkpoint.load(tmp_path / "checkpoint.h5"))
    restarted.advance(5e-6)
    assert restarted.neighbours.builds == straight.neighbours.builds
    assert restarted.reading == straight.reading
    assert_same(straight, restarted)


class Crash(Progress):
    """Stops the program at a time, without any ending."""

    def __init__(self, time):
        super().__init__()
        self.time = time

    def update(self, **values):
        if values["time"] > self.time:
            raise SystemError


def test_a_run_that_crashed_goes_on_as_if_it_had_not(tmp_path):
    """It goes on from the checkpoint of the last snapshot: every file then holds what the straight run's does."""
    (tmp_path / "balls.py").write_text(SCENE)
    from warpsph.library import load

    options = {"frames": False, "source": SCENE, "parameters": {"spacing": SPACING}}
    build = load(tmp_path / "balls.py").build
    straight, broken = tmp_path / "straight", tmp_path / "broken"
    expected = run_scene(build(), straight, **options)
    with pytest.raises(SystemError):
        run_scene(build(), broken, progress=Crash(3.5e-6), **options)
    assert len(snapshot.find(broken)) == 3
    found = resume(broken, frames=False)
    for one, two in zip(snapshot.find(straight), snapshot.find(broken), strict=True):
        for name, values in snapshot.read(one).fields.items():
            np.testing.assert_array_equal(
                values, snapshot.read(two).fields[name], err_msg=f"{two.name} {name}"
            )
    (arrays, info), (others, other) = (checkpoint.load(out / "checkpoint.h5") for out in (straight, broken))
    for name in arrays:
        np.testing.assert_array_equal(arrays[name], others[name], err_msg=name)
    for facts in (info, other):
        del facts["job"]["wall"], facts["job"]["step_wall"]
    assert info == other
    assert (straight / "history.csv").read_text() == (broken / "history.csv").read_text()
    assert len(history.read(broken / "history.csv")[2]["time"]) > 20
    timings = ("wall_s", "step_wall_s", "ns_per_particle_step", "ns_per_pair")
    assert {k: v for k, v in found.items() if k not in timings} == {
        k: v for k, v in expected.items() if k not in timings
    }


@pytest.mark.parametrize("scheme", ["sav1-mixed-as", "pm", "ts2", "tl", "adaptle"])
def test_single_precision_agrees_with_double(scheme):
    made, time = collision(scheme=scheme, speed=1000.0), 3e-6
    double, single = (run(made, time, precision=precision) for precision in ("float64", "float32"))
    assert abs(single.reading.steps - double.reading.steps) <= 1
    for name, scale in (
        ("x", SPACING),
        ("v", 1000.0),
        ("rho", 2785.0),
        ("e", 5e5),
        ("p", 1e10),
        ("tau", 1e9),
    ):
        error = np.abs(by_id(single, name) - by_id(double, name))
        assert error.max() < 1e-2 * scale and error.mean() < 1e-3 * scale, name
