"""Gradients in the reference configuration: exact for a linear displacement, and the same seen from both sides."""

import numpy as np
import pytest
from by_hand import gradients
from tools import DENSITY, DOUBLE, ELASTIC, REALS, SPACING, body, by_id, forces, jittered, overwrite, scene

from warpsph.kernels.mirror import INDEX_BITS
from warpsph.memory.policy import GENEROUS, THRIFTY
from warpsph.schemes import SCHEMES
from warpsph.solver import Solver

EPS = {"float64": 2.2e-16, "float32": 1.2e-7}
COUNT = {1: 20, 2: 10, 3: 6}


def dense(solver):
    """V0_b g0_ab and V0_b g0_ba [1/m] of all pairs, shapes [a, b, 3], in id order, from what the rows keep."""
    r, X, ids, n = (
        solver.reference,
        solver.particles.X.numpy(),
        solver.particles.id.numpy(),
        solver.particles.n,
    )
    start, count, entries, slope, w = (a.numpy() for a in (r.start0, r.n_neigh0, r.neigh0, r.slope0, r.w0))
    columns = solver.particles.spec.columns
    K, G, corrected = r.K0.numpy(), r.G0.numpy(), len(w) > 1
    there, other = np.zeros((n, n, 3)), np.zeros((n, n, 3))
    for i in range(n):
        for k in range(start[i], start[i] + columns * count[i], columns):
            j = entries[k]
            plain = slope[k] * (X[i] - X[j])
            there[ids[i], ids[j]] = K[i] @ (plain - w[k] * G[i]) if corrected else plain
            other[ids[i], ids[j]] = K[j] @ (-plain - w[k] * G[j]) if corrected else -plain
    return there, other


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", DOUBLE)
def test_linear_displacements_are_exact_on_disordered_particles_and_boundaries(dim, precision):
    X = jittered(dim, COUNT[dim], 0.25)
    H = np.zeros((3, 3))
    H[:dim, :dim] = np.random.default_rng(5).uniform(-1.0, 1.0, size=(dim, dim))
    g0, _ = dense(body(dim, X, scheme="tl", precision=precision))
    u = X @ H.T
    found = np.einsum("abi,abj->aij", u[None] - u[:, None], g0)
    np.testing.assert_allclose(found, np.broadcast_to(H, found.shape), atol=3e3 * EPS[precision])


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize("scheme", ["tl", "tl-plain"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_equal_those_by_hand(dim, scheme, policy):
    X = jittered(dim, COUNT[dim])
    solver = body(dim, X, scheme=scheme, policy=policy)
    V, corrected = SPACING**dim, SCHEMES[scheme].correction
    g = gradients(X, np.full(len(X), V), dim, solver.data.h, corrected)
    found, back = dense(solver)
    size = np.abs(V * g).max()
    np.testing.assert_allclose(found, V * g, atol=1e-12 * size)
    np.testing.assert_allclose(back, V * g.swapaxes(0, 1), atol=1e-12 * size)
    if corrected:
        assert np.abs(g + g.swapaxes(0, 1)).max() > 0.1 * np.abs(g).max(), "not antisymmetric at the boundary"


@pytest.mark.parametrize("precision", REALS)
def test_of_a_pair_is_that_of_the_reversed_pair(precision):
    """Of different volumes: a pair's two gradients are kept twice, times the volume of the other one."""
    made, x = scene(2, scheme="tl"), jittered(2, 8)
    volume = SPACING**2 * np.random.default_rng(2).uniform(0.8, 1.2, size=len(x))
    made.add_body("body", x, ELASTIC, volume=volume)
    g0, back = dense(Solver(made.finalize(), precision=precision))
    size = np.abs(g0).max()
    np.testing.assert_allclose(
        back * volume[:, None, None], (g0 * volume[:, None, None]).swapaxes(0, 1),
        atol=50 * EPS[precision] * size * SPACING**2,
    )  # fmt: skip
    assert np.abs(g0).max() > 0.0


def test_depend_on_nothing_but_the_reference():
    """A body that has moved, spun and been squeezed finds the same again."""
    solver = body(
        2, jittered(2, 8), lambda x: 1e4 * x @ np.array([[-1, 0.3, 0], [0.2, 0.5, 0], [0, 0, 0]]), scheme="tl"
    )
    before = dense(solver)
    solver.advance(2e-6)
    assert np.abs(by_id(solver, "x") - by_id(solver, "X")).max() > 0.05 * SPACING
    solver._run_still(solver._scheme.derive(solver._bind))
    for one, two in zip(before, dense(solver), strict=True):
        np.testing.assert_array_equal(one, two)


def test_mirror_images_are_reference_neighbours():
    """A block beside a plane has the gradients of the whole block: F of an affine map that keeps the plane is exact."""
    made, x = scene(2, scheme="tl"), jittered(2, 8)
    x[:, 0] += 0.5 * SPACING - x[:, 0].min()
    made.add_body("block", x, ELASTIC)
    made.add_symmetry_plane("x", 0.0)
    solver = Solver(made.finalize())
    whole = np.concatenate((x, x * [-1.0, 1.0, 1.0]))
    g = gradients(whole, np.full(len(whole), SPACING**2), 2, solver.data.h, True)
    A = np.diag([0.3, -0.2, 0.0])
    overwrite(solver, v=x @ A)
    forces(solver)
    order = np.argsort(solver.particles.id.numpy())
    r = solver.reference
    start, count, entries = (a.numpy() for a in (r.start0, r.n_neigh0, r.neigh0))
    rows = np.concatenate([entries[a : a + k] for a, k in zip(start, count, strict=False)])
    assert set(rows >> INDEX_BITS) == {0, 1}
    found = solver._work.rate0.numpy()[order] @ r.K0.numpy()[order].swapaxes(1, 2)
    u = whole @ A
    expected = np.einsum("abi,abj->aij", SPACING**2 * (u[None] - u[:, None]), g)[: len(x)]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    np.testing.assert_allclose(found, np.broadcast_to(A, found.shape), atol=1e-12)


def test_neighbours_are_of_the_same_body():
    made = scene(2, scheme="tl")
    x = jittered(2, 5)
    for name, shift in (("one", 0.0), ("two", 5.0)):
        made.add_body(name, x + np.array([shift * SPACING, 0.0, 0.0]), ELASTIC, density=DENSITY)
    solver = Solver(made.finalize())
    there, _ = dense(solver)
    strangers = solver.data.body[:, None] != solver.data.body
    assert not there[strangers].any()
    assert (np.linalg.norm(solver.data.x[:, None] - solver.data.x, axis=-1) < 2 * solver.data.h)[
        strangers
    ].any()
