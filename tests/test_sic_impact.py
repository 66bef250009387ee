"""Steel on silicon carbide: the paper's particles, the first wave, and a small impact that breaks the tile."""

import numpy as np
import pytest

from warpsph import library
from warpsph.solver import Solver


def test_the_particles_are_those_of_the_paper():
    data = library.load("sic_impact").build().finalize()
    assert dict(zip(data.bodies, np.bincount(data.body), strict=True)) == {
        "projectile": 81 * 41,
        "target": 121 * 401,
    }
    assert len(data.x) == 51842
    first = data.body == 0
    gap = data.x[~first, 0].min() - data.x[first, 0].max()
    assert gap == pytest.approx(data.spacing), "t = 0 is the impact"
    assert data.x[~first, 0].min() == 0.0
    assert np.abs(data.x[:, 1]).max() == pytest.approx(50e-3)


def impact(until, **parameters):
    """Solver after a time [s], the largest value of each measure on the way, and the state at the end."""
    solver = Solver(library.load("sic_impact").build(**parameters).finalize())
    found = {}
    for k in range(1, 13):
        solver.advance(until * k / 12)
        state = solver.state()
        for name, measure in solver.data.measures.items():
            found[name] = max(found.get(name, -np.inf), measure.function(state))
    return solver, found, state


@pytest.mark.parametrize("scheme", ["av", "ts2"])
def test_the_first_wave_carries_the_planar_pressure(scheme):
    """Before the sides release it: P in the ceramic between 7.97 and 8.46 GPa by Rankine and Hugoniot, u 407 to 415 m/s.

    The two ends are rate factors of 1 and of 10^6 per second; a coarse lattice overshoots.
    """
    _, found, state = impact(0.7e-6, scheme=scheme, spacing=5e-4)
    assert found["gauge_pressure"] == pytest.approx(8.2e9, rel=0.15)
    near = state.of("target") & (np.abs(state.x[:, 1]) < 1e-3) & (state.x[:, 0] < 2e-3)
    assert np.median(state.v[near, 0]) == pytest.approx(411.0, rel=0.08)


def test_a_small_impact_breaks_the_tile():
    solver, found, state = impact(8e-6, scheme="ts2", spacing=1e-3)
    tile = state.of("target")
    assert 0.02 < found["damaged_share"] < 0.8
    assert found["damaged_mass"] == pytest.approx(found["damaged_share"] * state.m[tile].sum())
    assert (state.D >= 0.0).all() and (state.D <= 1.0).all()
    assert (state.p[tile & (state.D >= 1.0)] >= 0.0).all(), "what has failed bears no tension"
    assert 100.0 < found["spall_velocity_peak"] < 800.0
    assert -0.5e-3 < found["penetration"] < 5e-3, (
        "-1 mm at the start: the spacing between both faces' particles"
    )
    x, y = state.x[tile, 0], state.x[tile, 1]
    rear = (solver.data.x[tile, 0] > 20e-3) & (np.abs(solver.data.x[tile, 1]) < 10e-3)
    assert (state.D[tile][rear] >= 1.0).any(), "a region of spall near the rear face"
    assert np.isfinite(x).all() and np.isfinite(y).all()
    start = 0.5 * float(np.sum(solver.data.m[:, None] * solver.data.v**2))
    ledger = solver.ledger()
    assert ledger["kinetic_energy"] + ledger["internal_energy"] == pytest.approx(start, rel=1e-12)
