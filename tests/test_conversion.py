"""Conversion of Lagrangian particles: when, whom it takes along, what stays, and that no neighbour is missed."""

import functools
import math

import numpy as np
import pytest
import warp as wp
from test_neighbours import expected as brute_force
from test_neighbours import listed
from tools import (
    DENSITY,
    ELASTIC,
    REALS,
    SPACING,
    by_id,
    collision,
    jittered,
    one_step,
    overwrite,
    run,
    scene,
)

from warpsph import materials as lib
from warpsph.config import Conversion
from warpsph.kernels.kernel_type import EULERIAN, LAGRANGIAN
from warpsph.kernels.timestep import RUNNING
from warpsph.solver import Solver

STATE = ("x", "v", "rho", "e", "tau", "ep", "D", "m", "p")
PLATE = lib.get("aluminium-jc")


def block(dim=2, material=ELASTIC, n=9, amount=0.0, precision="float64", scheme="adaptle", **numerics):
    """A lattice of Lagrangian particles at rest."""
    made = scene(dim, scheme=scheme, **numerics)
    made.add_body("block", jittered(dim, n, amount), material)
    return Solver(made.finalize(), precision=precision)


def middle(solver):
    """The particle nearest to the body's centre."""
    X = solver.data.x
    return int(np.argmin(np.linalg.norm(X - X.mean(axis=0), axis=1)))


def stretch(solver, i, factor):
    """Deform one particle along x, as far as its F says."""
    F = by_id(solver, "F")
    F[i] = np.diag([factor, 1.0, 1.0])
    overwrite(solver, F=F)


def damage(solver, i):
    """Fail one particle."""
    D = by_id(solver, "D")
    D[i] = 1.0
    overwrite(solver, D=D)


def converted(solver):
    """Numbers of the Eulerian particles."""
    return set(np.flatnonzero(by_id(solver, "kernel_type") == EULERIAN).tolist())


def within(solver, i, radius):
    """Numbers of the particles that were within a radius [m] of one at the start."""
    X = solver.data.x
    return set(np.flatnonzero(np.linalg.norm(X - X[i], axis=1) <= radius * (1 + 1e-9)).tolist())


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_by_strain(dim, precision):
    """One particle beyond the threshold converts, alone; just below it stays."""
    for share, expected in ((0.99, set()), (1.01, {0})):
        solver = block(dim, n=7, precision=precision, conversion=Conversion(strain=0.2))
        i = middle(solver)
        stretch(solver, i, math.exp(1.5 * share * 0.2))
        assert {k - i for k in converted(one_step(solver))} == expected


@pytest.mark.parametrize(
    ("measure", "principal"),
    [
        ("logarithmic", math.log),
        ("green-lagrange", lambda s: 0.5 * (s * s - 1.0)),
        ("almansi", lambda s: 0.5 * (1.0 - s**-2.0)),
    ],
)
def test_measures_of_strain(measure, principal):
    """2/3 of the principal strain where there is one: for the same stretch each measure has a threshold of its own."""
    limit = 2.0 / 3.0 * principal(1.5)
    for share in (0.98, 1.02):
        solver = block(conversion=Conversion(strain=limit / share, measure=measure))
        stretch(solver, middle(solver), 1.5)
        assert len(converted(one_step(solver))) == (share > 1.0)


def test_by_plastic_strain():
    solver = block(material=PLATE, conversion=Conversion(strain=0.3, measure="plastic"))
    ep = np.zeros(solver.particles.n)
    ep[3], ep[5] = 0.29, 0.31
    overwrite(solver, ep=ep)
    assert converted(one_step(solver)) == {5}


@pytest.mark.parametrize("layers", [0, 1, 2, 3])
def test_damage_takes_layers_of_reference_neighbours(layers):
    solver = block(material=PLATE, n=21, conversion=Conversion(damage=True, layers=layers))
    i = middle(solver)
    damage(solver, i)
    expected = {i}
    for _ in range(layers):
        expected = {b for a in expected for b in within(solver, a, 2.0 * solver.data.h)}
    assert converted(one_step(solver)) == expected


@pytest.mark.parametrize("radius", [0.5, 1.0, 1.5, 2.0])
def test_damage_takes_a_radius(radius):
    solver = block(material=PLATE, conversion=Conversion(damage=True, radius=radius * SPACING))
    i = middle(solver)
    damage(solver, i)
    assert converted(one_step(solver)) == within(solver, i, radius * SPACING)


def test_layers_are_of_the_reference_configuration_and_the_body():
    """A neighbour that has moved far away goes along; one of another body that is near does not."""
    made = scene(2, scheme="adaptle", conversion=Conversion(damage=True))
    x = jittered(2, 5, 0.0)
    for name, shift in (("one", 0.0), ("two", 5.0)):
        made.add_body(name, x + np.array([shift * SPACING, 0.0, 0.0]), PLATE)
    solver = Solver(made.finalize())
    i = int(np.argmin(np.linalg.norm(solver.data.x - np.array([4.0, 2.0, 0.0]) * SPACING, axis=1)))
    expected = {k for k in within(solver, i, 2.0 * solver.data.h) if k < len(x)}
    moved = solver.data.x.copy()
    moved[next(iter(expected - {i}))] -= [50.0 * SPACING, 0.0, 0.0]
    overwrite(solver, x=moved)
    damage(solver, i)
    assert converted(one_step(solver)) == expected


def test_by_a_criterion_of_ones_own():
    """It sees F, τ, p, εp, D, T: here the temperature over 500 K, and the pressure, decide."""

    @functools.cache
    def hot(s):
        real, mat = s.real, s.mat

        @wp.func
        def share(F: mat, tau: mat, p: real, ep: real, D: real, T: real):
            return T / real(500.0)

        return share

    solver = block(material=PLATE, conversion=Conversion(criterion=hot))
    T = np.full(solver.particles.n, 300.0)
    T[[7, 11]] = 501.0
    T[12] = 499.0
    overwrite(solver, T=T)
    assert converted(one_step(solver)) == {7, 11}


@pytest.mark.parametrize("precision", REALS)
def test_conversion_changes_the_type_and_nothing_else(precision):
    """The step in which particles convert leaves the bits that it leaves where they do not."""
    found = []
    for strain in (0.1, 10.0):
        made = collision(speed=300.0, scheme="adaptle-as", conversion=Conversion(strain=strain))
        solver = Solver(made.finalize(), precision=precision)
        x = solver.data.x
        v = 2e4 * np.cross([0.0, 0.0, 1.0], x)
        overwrite(solver, v=v)
        stretch(solver, 20, 1.3)
        stretch(solver, 21, 1.3)
        found.append(one_step(solver))
    one, other = found
    assert converted(one) == {20, 21} and not converted(other)
    for name in STATE:
        np.testing.assert_array_equal(by_id(one, name), by_id(other, name), err_msg=name)
    before, after = (solver.ledger() for solver in (other, one))
    assert before == after


def test_conversion_is_once_and_for_all():
    """Strained back, a particle stays Eulerian; the share never falls."""
    solver = block(conversion=Conversion(strain=0.2))
    i = middle(solver)
    stretch(solver, i, 1.6)
    one_step(solver)
    stretch(solver, i, 1.0)
    overwrite(solver, rho=np.full(solver.particles.n, DENSITY), vol=by_id(solver, "vol0"))
    for _ in range(3):
        assert converted(one_step(solver)) == {i}
    assert solver.tally()["converted_share"] == 1.0 / solver.particles.n


def test_a_region_is_eulerian_from_the_start():
    made = scene(2, scheme="adaptle")
    made.add_body("block", jittered(2, 9), ELASTIC)
    made.make_eulerian("block", lambda x: x[:, 0] < 2.5 * SPACING)
    solver = Solver(made.finalize())
    np.testing.assert_array_equal(
        by_id(solver, "kernel_type") == EULERIAN, solver.data.x[:, 0] < 2.5 * SPACING
    )
    assert solver.tally()["converted_share"] == 0.0


def impact(**numerics):
    """A plate that is hit hard: it converts where it is hit, from step to step somewhere else."""
    made = collision(
        radius=6.5, speed=900.0, scheme="adaptle-as", conversion=Conversion(strain=0.15), **numerics
    )
    return Solver(made.finalize())


def test_a_conversion_out_of_sight_lists_its_neighbours_before_the_next_step():
    """A particle far from all rows converts: before the next step it has every neighbour."""
    solver = block(n=40, conversion=Conversion(strain=0.2))
    i = middle(solver)
    assert not solver.neighbours.role.numpy().any(), "nothing was listed"
    stretch(solver, i, 1.6)
    one_step(solver)
    assert converted(solver) == {i} and solver.neighbours.unlisted.numpy()[0] == 1
    builds = solver.neighbours.builds
    one_step(solver)
    assert solver.neighbours.builds == builds + 1 and solver.neighbours.unlisted.numpy()[0] == 0
    rows = {(a, b) for a, b, _ in listed(solver)}
    near = {(a, b) for a, b, _ in brute_force(solver, 2.0 * solver.data.h) if i in (a, b)}
    assert near and near <= rows


def test_rows_of_the_converted_are_complete_in_every_step(monkeypatch):
    """Whatever is listed when: each pair with an Eulerian member that is within the support is in the rows of both."""
    monkeypatch.setattr("warpsph.solver.MAX_BATCH", 2)
    solver, seen = impact(), []

    def look(_):
        kind = by_id(solver, "kernel_type")
        eulerian = set(np.flatnonzero(kind == EULERIAN).tolist())
        near = {
            (a, b) for a, b, _ in brute_force(solver, 2.0 * solver.data.h) if (a in eulerian or b in eulerian)
        }
        if solver._plan().status == RUNNING:  # the rows are to be used as they are
            rows = {(a, b) for a, b, _ in listed(solver)}
            assert near <= rows
            seen.append(len(eulerian))

    solver.advance(4e-6, look)
    assert len(seen) > 10 and seen[0] == 0 and seen[-1] > 30


def test_which_rows_are_kept_changes_nothing():
    """With a skin so wide that nearly everything is listed at once, and with a narrow one: the same to round-off."""
    narrow, wide = (impact(skin=skin) for skin in (0.1, 2.0))
    for solver in (narrow, wide):
        solver.advance(4e-6)
    assert narrow.neighbours.builds > wide.neighbours.builds
    assert len(converted(narrow)) > 30
    assert converted(narrow) == converted(wide)
    for name, scale in (("x", SPACING), ("v", 900.0), ("tau", 1e9), ("rho", 2785.0)):
        np.testing.assert_allclose(by_id(narrow, name), by_id(wide, name), atol=1e-9 * scale, err_msg=name)


def test_a_particle_that_turns_over_converts_with_its_neighbours():
    """If asked to: J would fall below its floor in the next step."""
    made = scene(2, scheme="adaptle", inverted="convert")
    made.add_body("block", jittered(2, 9, 0.0), ELASTIC)
    made.fix("block")
    solver = Solver(made.finalize())
    i, v = middle(solver), np.zeros((solver.particles.n, 3))
    F = by_id(solver, "F")
    F[i] = np.diag([0.0101, 1.0, 1.0])
    v[:, 0] = -1e-3 / 1e-9 * (solver.data.x[:, 0] - solver.data.x[i, 0])
    overwrite(solver, F=F, v=v)
    solver.advance(1e-10)
    assert converted(solver) == within(solver, i, 2.0 * solver.data.h)
    tally = solver.tally()
    assert tally["inverted"] == 1 and tally["converted_share"] == len(converted(solver)) / len(v)
    assert (by_id(solver, "kernel_type") != LAGRANGIAN).sum() == len(converted(solver))
    assert np.isfinite(by_id(solver, "dvdx")).all()


def test_a_run_reports_the_share():
    solver = run(collision(speed=900.0, scheme="adaptle", conversion=Conversion(strain=0.15)), 4e-6)
    share = (by_id(solver, "kernel_type") == EULERIAN).mean()
    assert 0.05 < share < 0.95
    assert solver.tally()["converted_share"] == pytest.approx(share)
    assert solver.tally()["eroded"] == 0


@pytest.mark.parametrize(
    ("density", "F"), [(1.4, 1.0), (1.0, 0.2)], ids=["J apart from the density", "F too far"]
)
def test_a_stale_deformation_gradient_releases_its_neighbours(density, F):
    """An Eulerian interface particle whose F no longer describes its matter converts its Lagrangian neighbours, counted."""
    made = scene(2, scheme="adaptle")
    made.add_body("block", jittered(2, 15, 0.0), ELASTIC)
    made.make_eulerian("block", lambda x: x[:, 0] > 9.5 * SPACING)
    solver = one_step(Solver(made.finalize()))
    before, i = converted(solver), 10 * 15 + 7  # beside the interface
    rho, vol = by_id(solver, "rho"), by_id(solver, "vol")
    rho[i], vol[i] = density * rho[i] / F, vol[i] * F / density
    gradient = by_id(solver, "F")
    gradient[i] = np.diag([F, 1.0, 1.0])
    overwrite(solver, rho=rho, vol=vol, F=gradient)
    expected = before | within(solver, i, 2.0 * solver.data.h)
    assert i in before and expected > before
    assert converted(one_step(solver)) == expected
    assert solver.tally()["inverted"] == 1
