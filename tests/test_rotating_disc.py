"""The rotating disc: its exact stresses, its measures, and a coarse disc that turns."""

import numpy as np
import pytest

from warpsph import library
from warpsph.scenes import rotating_disc as disc
from warpsph.solver import Solver

RATE = 0.05 * disc.SOLID.bulk_speed / disc.RADIUS
R = np.linspace(1e-6, disc.RADIUS, 4001)


def test_the_exact_stresses_are_in_equilibrium():
    """d(r s_r)/dr - s_h + rho omega^2 r^2 = 0, and a free rim."""
    radial, hoop, _ = disc.exact_stress(R, RATE)
    force = disc.DENSITY * RATE**2 * R**2
    np.testing.assert_allclose(np.gradient(R * radial, R) - hoop, -force, atol=1e-3 * force.max())
    assert radial[-1] == 0.0


def test_the_exact_strains_fit_together():
    """By Hooke's law: none along the axis, and d(r e_h)/dr = e_r, the displacement being r e_h."""
    stress = disc.exact_stress(R, RATE)
    bulk = stress.sum(axis=0)
    strain = ((1.0 + disc.POISSON) * stress - disc.POISSON * bulk) / (2.0 * disc.G * (1.0 + disc.POISSON))
    np.testing.assert_allclose(strain[2], 0.0, atol=1e-18)
    np.testing.assert_allclose(np.gradient(R * strain[1], R)[1:-1], strain[0, 1:-1], atol=1e-6 * strain.max())
    assert strain[1, -1] == pytest.approx(disc.exact_growth(RATE))
    pressure = -disc.K * strain.sum(axis=0)
    np.testing.assert_allclose(pressure, -bulk / 3.0)


def measured(made, state):
    return {name: measure.function(state) for name, measure in made.measures.items()}


def test_measures_of_the_exact_state():
    """Grown, turned by a radian, under the exact stresses: nothing is off but the radius."""
    made = library.load("rotating_disc").build()
    state = Solver(made.finalize()).state()
    turn = np.array([[np.cos(1.0), -np.sin(1.0), 0.0], [np.sin(1.0), np.cos(1.0), 0.0], [0.0, 0.0, 1.0]])
    radius = np.linalg.norm(state.x, axis=1)
    stress = disc.exact_stress(radius, RATE)
    outward = state.x @ turn.T / np.maximum(radius, 1e-300)[:, None]
    along = np.stack((-outward[:, 1], outward[:, 0], 0.0 * radius), axis=1)
    axis = np.tile([0.0, 0.0, 1.0], (len(radius), 1))
    sigma = sum(
        s[:, None, None] * e[:, :, None] * e[:, None, :]
        for s, e in zip(stress, (outward, along, axis), strict=True)
    )
    state.fields["p"] = -stress.mean(axis=0)
    state.fields["tau"] = sigma + state.p[:, None, None] * np.eye(3)
    state.fields["x"], state.fields["v"] = 1.01 * state.x @ turn.T, state.v @ turn.T / 1.01
    found = measured(made, state)
    assert found["angular_momentum_change"] == pytest.approx(0.0, abs=1e-12)
    assert found["radius_growth"] == pytest.approx(0.01)
    assert found["axes_ratio"] == pytest.approx(1.0, abs=1e-3)
    assert found["pressure_error"] < 1e-12 and found["von_mises_error"] < 1e-12
    assert found["von_mises_max"] == found["von_mises_peak"] == pytest.approx(1.0, rel=1e-12)


def test_an_ellipse_is_no_disc():
    made = library.load("rotating_disc").build()
    state = Solver(made.finalize()).state()
    state.fields["x"] = state.x * [1.2, 1.0, 1.0]
    assert measured(made, state)["axes_ratio"] == pytest.approx(1.0 / 1.2, rel=1e-3)


def test_a_coarse_disc_turns():
    """A quarter of a revolution: round, with its angular momentum, and in the exact elastic state."""
    made = library.load("rotating_disc").build(spacing=4e-3, turns=0.25)
    solver = Solver(made.finalize())
    solver.advance(made.until)
    found = measured(made, solver.state())
    assert abs(found["angular_momentum_change"]) < 1e-6
    assert found["axes_ratio"] == pytest.approx(1.0, abs=1e-3)
    assert found["radius_growth"] == pytest.approx(disc.exact_growth(RATE), rel=0.2)
    assert found["pressure_error"] < 0.15 and found["von_mises_error"] < 0.15
    x, start = solver.state().x, solver.data.x
    turned = np.arctan2(np.cross(start, x)[:, 2].sum(), (start * x).sum())
    assert turned == pytest.approx(0.5 * np.pi, rel=2e-3)
