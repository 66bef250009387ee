"""Zero-energy control: silent in affine motion, and a restoring force on what the deformation gradient does not see."""

import functools

import numpy as np
import pytest
import warp as wp
from tools import SPACING, jittered

from warpsph.kernels.hourglass import make_hourglass
from warpsph.kernels.smoothing import make_smoothing
from warpsph.kernels.spec import Spec

ALPHA, E, H = 10.0, 70e9, 1.2 * SPACING


@functools.cache
def sampler(spec):
    real, vec, mat = spec.real, spec.vec, spec.mat
    force, w = make_hourglass(spec), make_smoothing(spec, "cubic_spline").w

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        X: wp.array[vec],
        x: wp.array[vec],
        F: wp.array[mat],
        young: wp.array[real],
        alpha: real,
        h: real,
        out: wp.array2d[real],
    ):
        i, j = wp.tid()
        if i != j:
            Xij, xij = X[i] - X[j], x[i] - x[j]
            w0 = w(wp.length(Xij), h)
            out[i, j] = force(Xij, xij, mat(F[i]), mat(F[j]), w0, alpha, real(young[i]), real(young[j]))

    return sample


def shares(spec, X, x, F, young=E):
    """s of every pair, shape [n, n]; F may be one for all."""
    n = len(X)
    F = np.broadcast_to(F, (n, 3, 3)).copy()
    arrays = [
        wp.array(a, dtype=kind, device="cpu") for a, kind in ((X, spec.vec), (x, spec.vec), (F, spec.mat))
    ]
    modulus = wp.array(np.broadcast_to(young, n).copy(), dtype=spec.real, device="cpu")
    out = wp.zeros((n, n), dtype=spec.real, device="cpu")
    wp.launch(sampler(spec), (n, n), [*arrays, modulus, ALPHA, H, out], device="cpu")
    return out.numpy().astype(float)


def forces(spec, X, x, F, young=E):
    """Forces of b on a [N] of particles of one volume, shape [a, b, 3]."""
    V = SPACING**spec.dim
    xij = x[:, None] - x
    r = np.linalg.norm(xij, axis=-1)
    return V * V * (shares(spec, X, x, F, young) / np.where(r > 0.0, r, 1.0))[..., None] * xij


def deformation_gradient(dim, X, x):
    """Least-squares F of every particle, weighted with the kernel: it is exact for affine motion."""
    Xij, xij = X[:, None] - X, x[:, None] - x
    weight = np.maximum(2.0 - np.linalg.norm(Xij, axis=-1) / H, 0.0) ** 3
    A = np.einsum("ab,abi,abj->aij", weight, xij, Xij)
    B = np.einsum("ab,abi,abj->aij", weight, Xij, Xij)
    A[:, range(dim, 3), range(dim, 3)] = B[:, range(dim, 3), range(dim, 3)] = 1.0
    return A @ np.linalg.inv(B)


def affine(dim, seed=0):
    """A deformation gradient with stretch, shear and rotation in the problem's space."""
    F = np.eye(3)
    F[:dim, :dim] += np.random.default_rng(seed).uniform(-0.3, 0.3, size=(dim, dim))
    return F


def rough(dim, seed=3):
    """A disordered body, moved affinely and then by noise: reference, current positions and F."""
    X = jittered(dim, {1: 20, 2: 6, 3: 4}[dim])
    x = X @ affine(dim).T
    x[:, :dim] += 0.1 * SPACING * np.random.default_rng(seed).normal(size=(len(X), dim))
    return X, x, deformation_gradient(dim, X, x)


def scale(spec):
    """Force of a pair one spacing apart whose error is one spacing [N]: the size to compare with."""
    X = np.zeros((2, 3))
    X[1, 0] = SPACING
    return np.linalg.norm(forces(spec, X, 2.0 * X, np.eye(3))[0, 1])


def test_affine_motion_feels_nothing(spec, eps):
    X = jittered(spec.dim, {1: 20, 2: 6, 3: 4}[spec.dim])
    F = affine(spec.dim)
    found = forces(spec, X, X @ F.T + [0.01, 0.0, 0.0], F)
    assert np.abs(found).max() < 1e3 * eps * scale(spec)  # of positions ten spacings and more from the origin


def test_rigid_motion_feels_nothing(spec, eps):
    X, Q = jittered(spec.dim, {1: 20, 2: 6, 3: 4}[spec.dim]), np.eye(3)
    if spec.dim > 1:
        Q[:2, :2] = [[0.6, -0.8], [0.8, 0.6]]
    assert np.abs(forces(spec, X, X @ Q.T, Q)).max() < 1e3 * eps * scale(spec)


def test_equals_the_published_form(spec, eps):
    """Ganzenmüller's f = α/2 V V W/R² (E_a δ_a + E_b δ_b) x/|x|, written out in numpy."""
    X, x, F = rough(spec.dim)
    young = E * np.random.default_rng(1).uniform(0.5, 2.0, len(X))
    found = forces(spec, X, x, F, young)
    Xij, xij = X[:, None] - X, x[:, None] - x
    R, r = (np.linalg.norm(d, axis=-1) + np.eye(len(X)) for d in (Xij, xij))
    q = R / H
    norm = {1: 2 / 3, 2: 10 / (7 * np.pi), 3: 1 / np.pi}[spec.dim] / H**spec.dim
    w0 = norm * np.where(q < 1, 1 - 1.5 * q**2 + 0.75 * q**3, 0.25 * np.maximum(2 - q, 0) ** 3)
    own = np.einsum("abi,abi->ab", np.einsum("aij,abj->abi", F, Xij) - xij, xij) / r
    size = 0.5 * ALPHA * SPACING ** (2 * spec.dim) * w0 / R**2
    expected = (size * (young[:, None] * own + (young[:, None] * own).T) / r)[..., None] * xij
    np.testing.assert_allclose(found, expected, atol=1e3 * eps * scale(spec))
    assert np.abs(found).max() > 0.01 * scale(spec)


def test_reaction_equals_action_to_the_last_bit(spec):
    X, x, F = rough(spec.dim)
    found = shares(spec, X, x, F, E * np.linspace(0.5, 2.0, len(X)))
    np.testing.assert_array_equal(found, found.T)
    assert found.any()


def test_a_pair_too_close_is_driven_apart(spec):
    X = np.zeros((2, 3))
    X[1, 0] = SPACING
    for factor, sign in ((0.9, 1.0), (1.1, -1.0)):
        assert sign * forces(spec, X, factor * X, np.eye(3))[1, 0, 0] > 0.0, (
            "force of 0 on 1, which is at x > 0"
        )
    still = forces(spec, X, 0.9 * X, np.diag([0.9, 1.0, 1.0]))
    assert np.abs(still).max() < 1e-5 * scale(spec), "but not where F says so"


@pytest.mark.parametrize("factor", [0.0, 1e-6])
def test_pairs_that_meet_stay_finite(spec, factor):
    X = np.zeros((2, 3))
    X[1, 0] = SPACING
    found = forces(spec, X, factor * X, np.eye(3))
    assert np.isfinite(found).all() and np.abs(found).max() <= scale(spec) * (1.0 + 1e-4)


@pytest.mark.parametrize("axis", [0, 1])
def test_checkerboard_is_driven_back(precision, axis):
    """Every other particle of a lattice displaced: F of the inner ones is I, so that only this force sees it."""
    spec, n = Spec(2, precision.real), 9
    X = jittered(2, n, amount=0.0)
    index = np.round(X / SPACING).astype(int)
    parity = 1.0 - 2.0 * ((index[:, 0] + index[:, 1]) % 2)
    u = np.zeros_like(X)
    u[:, axis] = 0.05 * SPACING * parity
    inner = ((index[:, :2] >= 3) & (index[:, :2] <= n - 4)).all(axis=1)
    F = deformation_gradient(2, X, X + u)
    assert np.abs(F[inner] - np.eye(3)).max() < 1e-12, "blind to it"
    found = forces(spec, X, X + u, np.eye(3)).sum(axis=1)
    assert (np.sum(found * u, axis=1)[inner] < -0.1 * scale(spec) * 0.05**2 * SPACING).all(), "restoring"
    assert (np.abs(found[inner, 1 - axis]) < 0.02 * np.abs(found[inner, axis])).all(), "and along the mode"
