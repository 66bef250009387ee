"""Mixed precision: float64 positions, float32 for the rest; far from the origin nothing gets worse."""

import math

import numpy as np
import pytest
import warp as wp
from tools import ELASTIC, SPACING, body, by_id, collision, jittered, one_step, run, scene

from warpsph.config import Contact, Conversion
from warpsph.device.launch import SMALLEST_SLICE
from warpsph.kernels.spec import Spec
from warpsph.running.balance import Balance
from warpsph.schemes import SCHEMES, EulerianSettings
from warpsph.solver import Solver
from warpsph.storage import checkpoint, snapshot

FAR = 1e4 * SPACING
"""An offset [m] that costs float32 positions four digits of their differences, which are a spacing long."""

SINGLE_EPS = 1.2e-7
CONTACT = Contact(stiffness=0.25)
FAMILIES = {
    "eulerian": {"scheme": "sav1-mixed-as"},
    "godunov": {"scheme": "pm"},
    "second order": {"scheme": "ts2"},
    "lagrangian": {"scheme": "tl", "hourglass": 5.0, "contact": CONTACT},
    "coupled": {"scheme": "adaptle-mixed-as", "conversion": Conversion(strain=0.08), "contact": CONTACT},
}
"""A run of every family, together of every kernel that knows positions."""

CRUSHED = {"radius": 4.5, "speed": 900.0}


def shifted(made, offset):
    """The finished scene, everything moved along x and y by an offset [m]."""
    data = made.finalize()
    data.x[:, :2] += offset
    return data


def spread(solver, reference, name):
    """Largest difference of a field over its largest value."""
    a, b = by_id(solver, name).astype(float), by_id(reference, name)
    return np.abs(a - b).max() / np.abs(b).max()


@pytest.mark.parametrize("real", [wp.float32, wp.float64])
def test_positions_have_the_type_of_the_rest_unless_asked_otherwise(real):
    plain = Spec(2, real)
    assert plain == Spec(2, real, real) and plain.place is real and plain.point is plain.vec
    assert plain.tag in ("2d_f32", "2d_f64")
    mixed = Spec(2, wp.float32, wp.float64)
    assert mixed != plain and mixed.tag == "2d_mixed"
    assert mixed.point is Spec(2, wp.float64).vec and mixed.vec is Spec(2, wp.float32).vec


def test_only_positions_are_double(tmp_path):
    """On the device, in a picture of it, in a snapshot and in a checkpoint."""
    solver = Solver(collision(scheme="adaptle").finalize(), precision="mixed")
    state = solver.state()
    checkpoint.save(tmp_path / "checkpoint.h5", *solver.save())
    snapshot.write(tmp_path / "balls_0000.vtkhdf", state)
    stored, _ = checkpoint.load(tmp_path / "checkpoint.h5")
    for fields in (stored, state.fields, snapshot.read(tmp_path / "balls_0000.vtkhdf").fields):
        double = {name for name, values in fields.items() if values.dtype == np.float64}
        assert double - {"clock", "x_listed"} == {"x", "X"}
    np.testing.assert_array_equal(by_id(solver, "x"), solver.data.x)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_run_conserves_to_single_precision(family):
    solver = Solver(collision(**CRUSHED, **FAMILIES[family]).finalize(), precision="mixed")
    balance = Balance(solver.data, solver.ledger())
    solver.advance(2e-6)
    balance.update(solver.ledger())
    assert solver.reading.steps > 20
    assert solver.ledger()["internal_energy"] > 0.05 * solver.ledger()["kinetic_energy"]
    assert balance.energy_error < 1e-6 and balance.momentum_error < 1e-6


@pytest.mark.parametrize("family", FAMILIES)
def test_far_away_a_run_stays_as_good(family):
    """Against the same run in float64: float32 loses at least two of the digits that mixed precision keeps."""
    made = collision(**CRUSHED, **FAMILIES[family])
    solvers = {}
    for precision in ("float64", "mixed", "float32"):
        solvers[precision] = Solver(shifted(made, FAR), precision=precision)
        solvers[precision].advance(1e-6)
    reference = solvers.pop("float64")
    for name, limit in (("v", 1e-5), ("rho", 1e-5), ("p", 1e-4)):
        good, bad = (spread(solvers[precision], reference, name) for precision in ("mixed", "float32"))
        assert good < limit and good < 0.01 * bad, name
    assert np.abs(by_id(solvers["mixed"], "x") - by_id(reference, "x")).max() < 1e-5 * SPACING


@pytest.mark.parametrize("planes", [False, True])
def test_the_gradient_of_a_linear_field_keeps_its_digits(planes, monkeypatch):
    """On disordered particles, also beside mirror images, whose separations are found in double precision too."""
    # no comparison with a limit that is no number holds: the limiter never acts
    monkeypatch.setitem(SCHEMES, "sav1", EulerianSettings("monaghan", 1.0, 2.0, True, math.nan))
    rate = 1e3 * (
        np.diag([1.0, -0.7, 0.0]) if planes else np.array([[1.0, 0.3, 0], [-0.8, -0.7, 0], [0, 0, 0]])
    )
    x = jittered(2, 8)
    x[:, :2] += 0.5 * SPACING - x[:, :2].min(axis=0)
    error = {}
    for precision in ("mixed", "float32"):
        made = scene(2, scheme="sav1")
        made.add_body("body", x + FAR * np.array([1.0, 1.0, 0.0]), ELASTIC, velocity=x @ rate.T)
        for axis in "xy" if planes else "":
            made.add_symmetry_plane(axis, FAR)
        found = by_id(one_step(Solver(made.finalize(), precision=precision)), "dvdx")
        error[precision] = np.abs(found - rate).max() / np.abs(rate).max()
    assert error["mixed"] < 100 * SINGLE_EPS
    assert error["float32"] > 1000 * SINGLE_EPS


def test_a_small_step_is_not_lost():
    """A drift by less than float32 could resolve there, taken a hundred times, comes out whole."""
    points = jittered(2, 4) + FAR * np.array([1.0, 1.0, 0.0])
    solver = body(2, points, velocity=(1.0, 2.0, 0.0), precision="mixed")
    before, way = by_id(solver, "x"), 1e-6 * SPACING
    for _ in range(100):
        solver.advance(solver.reading.time + 0.01 * way)
    moved = (by_id(solver, "x") - before) / way
    np.testing.assert_allclose(moved, np.tile([1.0, 2.0, 0.0], (len(moved), 1)), atol=2e-4)


@pytest.mark.parametrize("family", ["eulerian", "coupled"])
def test_a_restart_on_any_number_of_threads_gives_the_same_bits(family, tmp_path):
    made = collision(radius=20, speed=1200.0, **FAMILIES[family])
    assert len(made) > 4 * SMALLEST_SLICE, "launches are cut"
    straight = run(made, 1e-6, precision="mixed", threads=2)
    checkpoint.save(tmp_path / "checkpoint.h5", *straight.save())
    restarted = Solver(made.finalize(), precision="mixed", threads=1)
    restarted.restore(*checkpoint.load(tmp_path / "checkpoint.h5"))
    for solver in (straight, restarted):
        solver.advance(2e-6)
    assert restarted.reading == straight.reading and restarted.ledger() == straight.ledger()
    for name, values in straight.particles.arrays().items():
        np.testing.assert_array_equal(values, restarted.particles.arrays()[name], err_msg=name)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("family", ["eulerian", "coupled"])
def test_a_run_goes_on_in_another_precision(family, precision):
    """Both ways; what it makes of the rest is that of an unbroken run but for the digits of single precision."""
    made = collision(speed=1000.0, **FAMILIES[family])
    for first, second in ((precision, "mixed"), ("mixed", precision)):
        before = run(made, 1e-6, precision=first)
        after = Solver(made.finalize(), precision=second)
        after.restore(*before.save())
        assert after.reading == before.reading
        for solver in (before, after):
            solver.advance(2e-6)
        assert abs(after.reading.steps - before.reading.steps) <= 1
        for name, scale in (("x", SPACING), ("v", 1000.0), ("rho", 2785.0)):
            assert np.abs(by_id(after, name) - by_id(before, name)).max() < 1e-3 * scale, name
