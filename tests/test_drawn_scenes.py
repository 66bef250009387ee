"""Scenes drawn at random run or are refused; and what drawing them has found."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from tools import FLUID, SPACING, by_id, jittered, overwrite, scene

from warpsph.config import Conversion
from warpsph.errors import InputError
from warpsph.quality.torture import scenes
from warpsph.quality.torture.drawing import COMMON, drawn_scenes
from warpsph.quality.torture.drawn import DrawnBody, DrawnMaterial, DrawnScene
from warpsph.quality.torture.judging import judge
from warpsph.quality.torture.trial import Means
from warpsph.running.balance import Balance
from warpsph.shapes import Box
from warpsph.solver import Solver


@settings(
    max_examples=15,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
@given(drawn_scenes(COMMON[0]))
def test_a_drawn_scene_runs_or_is_refused(drawn):
    outcome = judge(drawn)
    assert outcome.kind != "failed", outcome.detail


def test_the_short_trial_finds_nothing(tmp_path):
    found = scenes.run(Means(tmp_path, True, lambda line: None))
    assert found.failed == []
    assert len(found.rows) == len(COMMON)
    for row in found.rows:
        drawn, *kinds = map(int, row[1:7])
        assert drawn == sum(kinds) == scenes.QUICK_EACH
        assert kinds[0] > drawn / 2, "most scenes run"


def test_a_number_gives_the_same_scene_again():
    drawn = scenes.scene(3)
    assert scenes.scene(3) == drawn != scenes.scene(4)
    names = {"DrawnScene": DrawnScene, "DrawnBody": DrawnBody, "DrawnMaterial": DrawnMaterial}
    assert eval(repr(drawn), names) == drawn, "its description makes it again"


def steps(solver, count):
    """Take so many steps, or a few more."""
    solver.advance(1e9, lambda now: now.steps >= count)


@pytest.mark.parametrize("scheme", ["sav1", "adaptle"])
def test_pairs_exactly_at_the_support_are_the_same_from_both_sides_of_a_plane(scheme):
    """The support is three spacings: rounding must not make one of two a neighbour that the other is not."""
    coupled = scheme == "adaptle"
    conversion = Conversion(strain=0.01) if coupled else None
    made = scene(2, scheme=scheme, kernel="gaussian", smoothing_ratio=1.0, conversion=conversion)
    x = jittered(2, 9, 0.0) + np.array([0.37 * SPACING, 0.0, 0.0])
    turning = 3e5 * np.cross([0.0, 0.0, 1.0], x - x.mean(axis=0))
    velocity = turning if coupled else (500.0, 900.0, 0.0)
    made.add_body("block", x, "aluminium", velocity=velocity, density=2785.0 if coupled else 2900.0)
    made.add_symmetry_plane("x", x[:, 0].max() + 0.5 * SPACING)
    solver = Solver(made.finalize())
    balance = Balance(solver.data, solver.ledger())
    steps(solver, 40)
    balance.update(solver.ledger())
    assert balance.energy_error < 1e-13 and balance.momentum_error < 1e-13


def test_nothing_leaps_over_the_support():
    """Slow sound, fast bodies: without a limit the first passes through the plane and the second in one step."""
    made = scene(1)
    made.add_body("left", Box(0.0, 5 * SPACING), FLUID, velocity=(-40e3, 0.0, 0.0))
    made.add_body("right", Box(9 * SPACING, 14 * SPACING), FLUID)
    made.add_symmetry_plane("x", -3 * SPACING)
    solver = Solver(made.finalize())
    h = solver.data.h
    assert 80e3 * 0.5 * h / 1480.0 > 20 * h
    while solver.reading.steps < 60:
        before = solver.reading
        steps(solver, before.steps + 1)
        if before.steps == 0:
            assert solver.reading.dt_max == pytest.approx(h / 80e3)
        assert (by_id(solver, "x")[:, 0] > -3 * SPACING).all()
    assert by_id(solver, "v")[:5, 0].max() > -20e3, "it has felt the plane"
    assert np.isfinite(by_id(solver, "rho")).all()


def test_slower_bodies_step_as_before():
    """Below twice the longitudinal sound speed, at a Courant number of a half, sound alone decides."""
    dt = []
    for speed in (0.0, 2900.0):
        made = scene(1)
        made.add_body("left", Box(0.0, 5 * SPACING), FLUID, velocity=(speed, 0.0, 0.0))
        made.add_body("right", Box(50 * SPACING, 55 * SPACING), FLUID)
        solver = Solver(made.finalize())
        steps(solver, 1)
        dt.append(solver.reading.dt_max)
    assert dt[0] == dt[1]


def sheet(material, energy=0.0):
    """A small sheet in plane stress."""
    made = scene(2, plane="stress")
    made.add_body("sheet", jittered(2, 4, 0.0), material, internal_energy=energy)
    return made


def test_a_sheet_too_hot_for_plane_stress_is_refused():
    with pytest.raises(InputError, match=r"body 'sheet' starts beyond .*internal energy of 1e\+07 J/kg"):
        Solver(sheet("steel-jc", energy=1e7).finalize())
    steps(Solver(sheet("steel-jc", energy=1e5).finalize()), 1)


def test_matter_that_heats_up_in_plane_stress_stays_within_its_law():
    """No thickness leaves it without stress: it thins out as far as its law goes, and that is counted."""
    solver = Solver(sheet("steel-jc").finalize())
    overwrite(solver, e=np.full(16, 1e7))
    steps(solver, 30)
    rho = by_id(solver, "rho")
    assert np.isfinite(by_id(solver, "x")).all() and np.isfinite(rho).all()
    assert (rho > 0.5e-3 * 7903.0).all() and by_id(solver, "p").max() > 1e8
    assert by_id(solver, "clipped").max() > 0


def test_a_fluid_in_plane_stress_is_refused():
    with pytest.raises(
        InputError, match=r"material 'fluid' does not go with plane = 'stress'.*allowed: plane = 'strain'"
    ):
        Solver(sheet(FLUID).finalize())


def test_a_start_beyond_the_equation_of_state_is_refused():
    made = scene(2)
    made.add_body("torn", jittered(2, 4, 0.0), "beryllium", density=0.5 * 1845.0)
    with pytest.raises(
        InputError, match=r"body 'torn' starts beyond .* 'beryllium', at a density of 922.5 kg/m\^3"
    ):
        Solver(made.finalize())
