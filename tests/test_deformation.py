"""Deformation gradient, density and first Piola-Kirchhoff stress: affine motion, rotation, and back to Cauchy stress."""

import itertools
import math

import numpy as np
import pytest
from by_hand import cofactor
from tools import (
    DENSITY,
    DOUBLE,
    ELASTIC,
    REALS,
    SPACING,
    G,
    K,
    body,
    by_id,
    forces,
    jittered,
    overwrite,
    scene,
)

from warpsph.schemes import SCHEMES, LagrangianSettings
from warpsph.solver import Solver

EPS = {"float64": 2.2e-16, "float32": 1.2e-7}
COUNT = {1: 20, 2: 9, 3: 6}
STIFF = K + 4.0 * G / 3.0


@pytest.fixture
def exact(monkeypatch):
    """A Total Lagrangian scheme without viscosity."""
    monkeypatch.setitem(SCHEMES, "exact", LagrangianSettings(None, True, 0.0, 0.0))
    return "exact"


def driven(dim, points, precision, **numerics):
    """A body all of whose particles are driven."""
    made = scene(dim, **numerics)
    made.add_body("body", points, ELASTIC)
    made.fix("body")
    return Solver(made.finalize(), precision=precision)


def carry(solver, motion, times):
    """Take a body through positions motion(t, X), one step from each time to the next."""
    X = solver.data.x
    for now, after in itertools.pairwise(times):
        overwrite(solver, v=(motion(after, X) - motion(now, X)) / (after - now))
        steps = solver.reading.steps
        solver.advance(after)
        assert solver.reading.steps == steps + 1


def rotation(dim, angle):
    """About z in the plane, about a diagonal in space."""
    axis = np.array([0.0, 0.0, 1.0]) if dim == 2 else np.array([1.0, 2.0, -2.0]) / 3.0
    W = np.cross(np.eye(3), axis)
    return np.eye(3) + math.sin(angle) * W + (1.0 - math.cos(angle)) * W @ W


def short(n):
    """Times of n equal steps, each far shorter than the largest stable one."""
    return 1e-3 * SPACING / 6000.0 * np.arange(n + 1)


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", DOUBLE)
def test_an_affine_map_is_exact(dim, precision, exact):
    """F = I + t A for x = X + t A X, whatever the number of steps; ρ = ρ0/J; L = A F⁻¹ at the middle of the step."""
    A = np.zeros((3, 3))
    A[:dim, :dim] = np.random.default_rng(1).uniform(-0.5, 0.5, size=(dim, dim))
    solver, times = driven(dim, jittered(dim, COUNT[dim], 0.25), precision, scheme=exact), short(20)
    A /= times[-1]
    carry(solver, lambda t, X: X + t * X @ A.T, times)
    F, middle = (np.eye(3) + t * A for t in (times[-1], 0.5 * (times[-1] + times[-2])))
    tolerance = 1e3 * EPS[precision]
    np.testing.assert_allclose(
        by_id(solver, "F"), np.broadcast_to(F, (solver.particles.n, 3, 3)), atol=tolerance
    )
    np.testing.assert_allclose(by_id(solver, "rho"), DENSITY / np.linalg.det(F), rtol=tolerance)
    L = A @ np.linalg.inv(middle)
    np.testing.assert_allclose(
        by_id(solver, "dvdx"),
        np.broadcast_to(L, (solver.particles.n, 3, 3)),
        atol=tolerance / (times[1] - times[0]),
    )


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", [2, 3])
def test_a_rotation_of_any_size_gives_no_stress(dim, precision, exact):
    """Two turns in steps of 9 degrees: L is a pure spin, as it is taken at the middle of the step."""
    solver, times = driven(dim, jittered(dim, COUNT[dim], 0.25), precision, scheme=exact), short(80)
    rate = math.radians(9.0) / times[1]
    carry(solver, lambda t, X: X @ rotation(dim, rate * t).T + [t * 1e3, 0.0, 0.0], times[:31])
    turned = np.broadcast_to(rotation(dim, math.radians(270.0)), (solver.particles.n, 3, 3))
    tolerance = 3e3 * EPS[precision]
    np.testing.assert_allclose(by_id(solver, "F"), turned, atol=tolerance)
    assert np.abs(by_id(solver, "sig")).max() < tolerance * STIFF
    carry(solver, lambda t, X: X @ rotation(dim, rate * t).T + [t * 1e3, 0.0, 0.0], times[30:])
    assert np.abs(by_id(solver, "sig")).max() < tolerance * STIFF
    assert np.abs(by_id(solver, "dvdt")).max() < tolerance * STIFF / DENSITY / SPACING
    np.testing.assert_allclose(by_id(solver, "rho"), DENSITY, rtol=tolerance)


@pytest.mark.parametrize("dim", [2, 3])
def test_plain_gradients_take_a_rotation_for_strain_at_boundaries(dim):
    """What the correction is for: at a boundary F is far from the rotation, inside of a regular lattice near it."""
    solver, times = driven(dim, jittered(dim, COUNT[dim] + 2, 0.0), "float64", scheme="tl-plain"), short(2)
    turn = rotation(dim, math.radians(9.0))
    carry(solver, lambda t, X: X + t / times[1] * X @ (turn - np.eye(3)).T, times[:2])
    error = np.abs(by_id(solver, "F") - turn).max(axis=(1, 2))
    index = np.round(by_id(solver, "X")[:, :dim] / SPACING)
    inside = ((index >= 3) & (index <= COUNT[dim] - 2)).all(axis=1)
    assert inside.sum() >= 2**dim
    assert error[inside].max() < 0.01
    assert error.max() > 0.04


def state(solver, dim, seed=0):
    """Give a body random deformation gradients and symmetric stresses that its dimension allows."""
    rng, n = np.random.default_rng(seed), solver.particles.n
    F = np.tile(np.eye(3), (n, 1, 1))
    F[:, :dim, :dim] += rng.uniform(-0.3, 0.3, size=(n, dim, dim))
    sig = 1e9 * rng.normal(size=(n, 3, 3))
    sig += sig.swapaxes(1, 2)
    across = np.arange(3) >= dim
    sig[:, across[:, None] != across] = 0.0
    overwrite(solver, F=F, sig=sig)
    return F, sig


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", DOUBLE)
def test_piola_stress_and_back(dim, precision):
    """σ = P Fᵀ/J is what P came from, and P Fᵀ is symmetric; the kernel's P and cofactor hold the correction K besides."""
    solver = body(dim, jittered(dim, COUNT[dim]), scheme="tl", precision=precision)
    F, sig = state(solver, dim)
    forces(solver)
    order = np.argsort(solver.particles.id.numpy())
    uncorrected = np.linalg.inv(solver.reference.K0.numpy()[order].astype(float))
    P, cof = (getattr(solver._work, name).numpy()[order] @ uncorrected for name in ("P", "cof"))
    J, atol = np.linalg.det(F)[:, None, None], 200 * EPS[precision] * np.abs(sig).max()
    np.testing.assert_allclose(P @ F.swapaxes(1, 2) / J, sig, atol=atol)
    PF = P @ F.swapaxes(1, 2)
    np.testing.assert_allclose(PF, PF.swapaxes(1, 2), atol=atol)
    np.testing.assert_allclose(cof, cofactor(F), atol=200 * EPS[precision])
    np.testing.assert_allclose(P, sig @ cofactor(F), atol=atol)


def test_contraction_shortens_the_step():
    """shrink bounds 1/λ_min, exactly so along the axes: the step follows h as it shrinks."""
    solver = body(2, jittered(2, 9), scheme="tl")
    F = np.tile(np.diag([0.5, 1.2, 1.0]), (solver.particles.n, 1, 1))
    F[0] = rotation(2, 0.6) @ np.diag([0.8, 0.9, 1.0]) @ rotation(2, -0.3)
    overwrite(solver, F=F)
    forces(solver)
    found = solver._work.shrink.numpy()[np.argsort(solver.particles.id.numpy())]
    np.testing.assert_allclose(found[1:], 2.0, rtol=1e-12)
    assert 1.25 <= found[0] < 1.25 * math.sqrt(2.0)
