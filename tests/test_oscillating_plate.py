"""The oscillating plate: its mode, what is read from a history, and a coarse vibration."""

import numpy as np
import pytest
from tools import run

from warpsph import library
from warpsph.errors import InputError
from warpsph.running.balance import energy
from warpsph.scenes import oscillating_plate as plate
from warpsph.solver import Solver

THEORY = 3.9361
"""Frequency of the thin plate [Hz]: E = 2 MPa, nu = 0.3975, 1000 kg/m^3, 0.2 m by 0.02 m, by hand."""


def built(**parameters):
    return library.load("oscillating_plate").build(**parameters)


def test_the_frequency_of_the_thin_plate():
    assert plate.thin_plate_frequency() == pytest.approx(THEORY, rel=1e-4)
    assert plate.SOLID.bulk_speed == pytest.approx(57.03, rel=1e-4)


def test_the_mode_is_that_of_a_clamped_plate():
    """Neither deflection nor slope at the clamp, neither moment nor shear force at the end, and f'''' = k^4 f."""
    step = plate.LENGTH / 200
    f = plate.mode(step * np.arange(-4, 205))
    root, end = 4, 204
    derivative = [f]
    for _ in range(4):
        derivative.append(np.gradient(derivative[-1], step))
    k = plate.MODE / plate.LENGTH
    assert f[root] == pytest.approx(0.0, abs=1e-12) and f[end] == pytest.approx(1.0)
    assert abs(derivative[1][root]) < 1e-4 * k
    assert abs(derivative[2][end]) < 1e-3 * k**2
    assert abs(derivative[3][end]) < 1e-3 * k**3
    np.testing.assert_allclose(derivative[4][50:150], k**4 * f[50:150], rtol=1e-3)


@pytest.mark.parametrize("phase", [0.0, 0.7])
def test_frequency_and_amplitude_of_a_sine(phase):
    times = np.linspace(0.0, 3.3, 70)
    values = 2.5 * np.sin(2.0 * np.pi * 1.1 * times + phase)
    assert plate.frequency_of(times, values) == pytest.approx(1.1, rel=2e-3)
    assert plate.amplitude_of(times, values, 1.1) == pytest.approx(2.5)


def test_a_history_without_two_changes_of_sign_has_no_frequency():
    times = np.linspace(0.1, 0.4, 10)
    for values in (times, np.sin(2.0 * np.pi * times + 2.5)):
        assert plate.frequency_of(times, values) == 0.0
    assert plate.amplitude_of(times, times, 0.0) == 0.0


def test_measures_are_read_from_the_rows_so_far():
    """They see a state for each row; one that comes again replaces what was known from its time on."""
    made = built(particles=2)
    state = Solver(made.finalize()).state()
    rest = state.x.copy()
    measures = {name: measure.function for name, measure in made.measures.items()}
    for time in (*np.linspace(0.0, 1.0, 81), *np.linspace(0.5, 1.0, 41)):
        state = type(state)(**(vars(state) | {"time": time, "fields": dict(state.fields)}))
        state.fields["x"] = rest + 0.01 * np.sin(2.0 * np.pi * 4.0 * time) * np.array([0.0, 1.0, 0.0])
        found = {name: function(state) for name, function in measures.items()}
    assert found["frequency"] == pytest.approx(4.0, rel=1e-3)
    assert found["frequency_ratio"] == pytest.approx(4.0 / THEORY, rel=1e-3)
    assert found["amplitude"] == pytest.approx(0.01, rel=1e-3)
    assert found["amplitude_kept"] == pytest.approx(1.0, rel=1e-3)
    assert built(particles=2).measures["frequency"].function(state) == 0.0, (
        "after a restart there are no rows yet"
    )


def test_the_clamp_is_held_and_the_rest_is_the_plate():
    data = built(particles=6).finalize()
    held = data.fixed > 0
    assert held.sum() == plate.CLAMP * 6 and len(data.x) == held.sum() + 6 * 60
    assert (data.x[held, 0] < 0.0).all() and (data.x[~held, 0] > 0.0).all()
    assert not data.v[held].any()
    assert data.v[:, 1].max() == pytest.approx(0.05 * 57.03, rel=0.02)


def test_a_thickness_of_one_particle_is_refused():
    with pytest.raises(InputError, match=r"particles = 1 .* allowed: 2 or more"):
        plate.build(particles=1)


def test_a_coarse_plate_vibrates():
    """More than a period: somewhat slower than the thin plate, as wide as its speed says, and the energy is kept."""
    made = built(particles=4, speed=0.01)
    start = Solver(made.finalize()).ledger()
    solver = run(made, 0.0)
    for time in np.linspace(0.0, 1.3 / THEORY, 30):
        solver.advance(time)
        found = {name: measure.function(solver.state()) for name, measure in made.measures.items()}
    assert 0.75 < found["frequency_ratio"] < 1.0
    speed = 2.0 * np.pi * found["frequency"] * found["amplitude"]
    assert speed == pytest.approx(0.01 * plate.SOLID.bulk_speed, rel=0.05)
    held = solver.data.fixed > 0
    np.testing.assert_array_equal(solver.state().x[held], solver.data.x[held])
    now = solver.ledger()
    assert energy(now) - now["work"] == pytest.approx(energy(start), rel=1e-12)
