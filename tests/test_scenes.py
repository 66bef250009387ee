"""The bundled scenes: each builds and steps, and the numbers of particles are those of the papers."""

import numpy as np
import pytest
from tools import by_id

from warpsph import library
from warpsph.solver import Solver

COARSE = {"spacing": 4.0, "particles": 0.2}
"""Factors on the parameters that set the resolution."""


def coarse(name):
    file = library.load(name)
    values = {
        p: type(file.parameters[p].default)(file.parameters[p].default * factor)
        for p, factor in COARSE.items()
        if p in file.parameters
    }
    assert values, "a scene's resolution is a parameter"
    return file.build(**values)


@pytest.mark.parametrize("name", library.names())
def test_a_scene_builds_and_steps(name):
    solver = Solver(coarse(name).finalize())
    solver.advance(0.02 * solver.data.until)
    state = solver.state()
    assert solver.reading.steps > 0
    for field in ("x", "v", "rho", "e", "p"):
        assert np.isfinite(by_id(solver, field)).all()
    for measure in solver.data.measures.values():
        assert not np.isnan(measure.function(state))


@pytest.mark.parametrize(
    ("parameters", "projectile"), [({}, 7830), ({"lattice": "rings"}, 8012)], ids=["core-and-rings", "rings"]
)
def test_hvi_2d_has_the_papers_particles(parameters, projectile):
    data = library.load("hvi_2d").build(**parameters).finalize()
    assert dict(zip(data.bodies, np.bincount(data.body), strict=True)) == {
        "projectile": projectile,
        "plate": 10020,
    }
    first = data.body == 0
    gap = data.x[~first, 0].min() - data.x[first, 0].max()
    assert gap == pytest.approx(2.0 * data.h, rel=1e-6), "the supports are about to overlap"
