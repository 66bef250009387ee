"""The mixed correction: exact gradients of linear fields, and safe where there are too few neighbours."""

import math

import numpy as np
import pytest
from tools import DENSITY, DOUBLE, ELASTIC, REALS, SPACING, body, by_id, jittered, one_step, scene

from warpsph.schemes import SCHEMES, EulerianSettings
from warpsph.solver import Solver

EPS = {"float64": 2.2e-16, "float32": 1.2e-7}
RATE = 100.0


@pytest.fixture
def correct(monkeypatch):
    """Register a scheme without viscosity whose limiter has a given ratio, and give its name."""

    def register(ratio, correction=True):
        settings = EulerianSettings("monaghan", 0.0, 0.0, correction=correction, gradient_ratio=ratio)
        monkeypatch.setitem(SCHEMES, "corrected", settings)
        return "corrected"

    return register


def linear(dim, x):
    """A linear velocity field and its gradient."""
    L = np.zeros((3, 3))
    L[:dim, :dim] = RATE * np.random.default_rng(5).uniform(-1.0, 1.0, size=(dim, dim))
    return x @ L.T, L


def gradient(points, velocity, dim, scheme, precision="float64"):
    """The velocity gradient of a stress-free body, which a step finds at the positions it starts from."""
    return by_id(one_step(body(dim, points, velocity, scheme=scheme, precision=precision)), "dvdx")


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", DOUBLE)
def test_linear_fields_are_exact_on_disordered_particles_and_boundaries(dim, precision, correct):
    x = jittered(dim, {1: 20, 2: 10, 3: 6}[dim], 0.25)
    v, L = linear(dim, x)
    off = correct(math.nan)  # no comparison with it holds: the limiter never acts
    found = gradient(x, v, dim, off, precision)
    np.testing.assert_allclose(found, np.broadcast_to(L, found.shape), atol=3e3 * EPS[precision] * RATE)


@pytest.mark.parametrize("scheme", ["sav1", "sav1-mixed"])
def test_gradient_of_a_constant_is_zero(scheme):
    found = gradient(jittered(2, 8), (123.4, -56.7, 0.0), 2, scheme)
    np.testing.assert_array_equal(found, 0.0)


def test_plain_gradients_are_wrong_at_boundaries(correct):
    """What the correction is for; a limiter that lets nothing pass gives the plain gradient back."""
    x = jittered(2, 8)
    v, L = linear(2, x)
    plain = gradient(x, v, 2, correct(7.5, correction=False))
    assert np.abs(plain - L).max() > 0.3 * RATE
    np.testing.assert_allclose(gradient(x, v, 2, correct(1.0)), plain, atol=1e-12 * RATE)


def test_the_limiter_leaves_most_of_the_correction(correct):
    x = jittered(2, 10)
    v, L = linear(2, x)
    plain, limited = (
        np.abs(gradient(x, v, 2, correct(7.5, correction=on)) - L).max(axis=(1, 2)) for on in (False, True)
    )
    assert limited.mean() < 0.5 * plain.mean()
    assert np.median(limited) < 0.05 * RATE


def few(dim, kind):
    """Sets of particles that span too little to correct a gradient."""
    line = np.arange(3)[:, None] * np.array([1.0, 0.0, 0.0])
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float)
    if kind == "oblique":
        s, c = math.sin(0.7), math.cos(0.7)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        tilt = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]) if dim == 3 else np.eye(3)
        line, square = line @ turn.T @ tilt.T, square @ turn.T @ tilt.T
    sets = [line[:1], line[:2]]
    if dim > 1:
        sets.append(line)
    if dim > 2:
        sets += [square[:3], square]
    return [SPACING * points for points in sets]


@pytest.mark.parametrize(
    ("dim", "kind"), [(1, "axis"), (2, "axis"), (2, "oblique"), (3, "axis"), (3, "oblique")]
)
def test_too_few_neighbours_fall_back_to_the_plain_gradient(dim, kind, correct):
    rng = np.random.default_rng(3)
    for points in few(dim, kind):
        v = RATE * SPACING * rng.uniform(-1.0, 1.0, size=points.shape) * (np.arange(3) < dim)
        plain, corrected = (gradient(points, v, dim, correct(math.nan, on)) for on in (False, True))
        np.testing.assert_allclose(corrected, plain, atol=1e-12 * RATE)


@pytest.mark.parametrize("precision", REALS)
def test_nearly_degenerate_sets_stay_finite(precision):
    """Triples off their line by ever less: somewhere on the way the correction gives up, nowhere it blows up."""
    made = scene(2, scheme="sav1-mixed")
    for k, off in enumerate(10.0 ** np.arange(-12.0, 0.0)):
        points = SPACING * np.array([[0.0, 20.0 * k], [0.9, 20.0 * k + off], [1.8, 20.0 * k]])
        made.add_body(f"{k}", points, ELASTIC, density=1.02 * DENSITY)
    solver = Solver(made.finalize(), precision=precision)
    solver.advance(20 * 0.1 * SPACING / 6000.0)
    for name in ("x", "v", "dvdx", "tau", "p"):
        assert np.isfinite(by_id(solver, name)).all()
    assert np.linalg.norm(by_id(solver, "v"), axis=1).max() < 500.0
