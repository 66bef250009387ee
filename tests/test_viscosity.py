"""Artificial viscosity: the force of a pair, and the switches of BAL and MON."""

import math

import numpy as np
import pytest
from tools import DENSITY, DOUBLE, SPACING, K, body, by_id, launch, one_step

from warpsph.kernels.viscosity import MORRIS_MIN, make_switches
from warpsph.schemes import SCHEMES

R = 0.9 * SPACING
H = 1.2 * SPACING
C = math.sqrt(K / DENSITY)
DIRECTION = {1: [1.0, 0.0, 0.0], 2: [0.6, 0.8, 0.0], 3: [0.48, 0.64, 0.6]}


def pair(dim, v, scheme="sav1"):
    """Two stress-free particles; the second has velocity v."""
    points = np.array([np.zeros(3), R * np.array(DIRECTION[dim])])
    return one_step(body(dim, points, np.array([np.zeros(3), v]), scheme=scheme))


def slope(dim):
    """dW/dr of the cubic spline at the pair's distance, q < 1."""
    q, sigma = R / H, {1: 2 / 3, 2: 10 / (7 * math.pi), 3: 1 / math.pi}[dim]
    return sigma / H ** (dim + 1) * (2.25 * q**2 - 3.0 * q)


@pytest.mark.parametrize("dim", DOUBLE)
@pytest.mark.parametrize("scheme", ["sav1", "sav2"])
def test_approaching_pairs_repel(dim, scheme):
    speed, n = 200.0, np.array(DIRECTION[dim])
    found = pair(dim, -speed * n, scheme)
    settings, mu = SCHEMES[scheme], -H * speed * R / (R**2 + 0.01 * H**2)
    big_pi = (-settings.alpha * C * mu + settings.beta * mu**2) / DENSITY
    m = DENSITY * SPACING**dim
    expected = m * big_pi * slope(dim) * n  # dv/dt = -m Pi grad_a W, grad_a W = W' (x_a - x_b)/r
    np.testing.assert_allclose(by_id(found, "dvdt"), [expected, -expected], rtol=1e-9)
    assert (by_id(found, "e") > 0.0).all(), "it heats"


@pytest.mark.parametrize("motion", ["receding", "across"])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_other_pairs_feel_nothing(dim, motion):
    n = np.array(DIRECTION[dim])
    v = 200.0 * n if motion == "receding" else 200.0 * np.cross(n, [0.0, 0.0, 1.0]) * (dim > 1)
    found = pair(dim, v)
    np.testing.assert_allclose(by_id(found, "dvdt"), 0.0, atol=1e-9 * 200.0 * C / H)
    np.testing.assert_allclose(by_id(found, "e"), 0.0, atol=1e-12)


@pytest.mark.parametrize(("L", "expected"), [("shear", 0.0), ("compression", 1.0), ("rotation", 0.0)])
def test_balsara_tells_shear_from_compression(L, expected):
    rate = 1e-3 * C / H
    matrix = rate * np.array(
        {
            "shear": [[0, 1, 0], [0, 0, 0], [0, 0, 0]],
            "compression": [[-1, 0, 0], [0, -1, 0], [0, 0, 0]],
            "rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 0]],
        }[L]
    )
    x = SPACING * np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0), [0.0]), axis=-1).reshape(-1, 3)
    found = by_id(one_step(body(2, x, x @ matrix.T, scheme="bal")), "av_switch")
    inside = np.linalg.norm(x[:, :2] - 4.0 * SPACING, axis=1) < 1.5 * SPACING
    np.testing.assert_allclose(found[inside], expected, atol=0.1 if expected else 1e-9)


def morris(start, div, dt, steps, c=5000.0):
    """The coefficient of MON after steps at a constant velocity divergence."""
    values = {"av_switch": np.array([start]), "dvdx": np.diag([div, 0.0, 0.0])[None], "cs": np.array([c])}
    kernel = make_switches(DOUBLE[2]).morris
    for _ in range(steps):
        values = launch(kernel, 1, DOUBLE[2], h=H, **(values | {"dt": np.array([dt])}))
    return float(values["av_switch"][0])


def test_morris_decays_and_grows():
    rate = 0.2 * 5000.0 / H
    dt = 0.01 / rate
    assert morris(1.0, 0.0, dt, 100) == pytest.approx(
        MORRIS_MIN + (1.0 - MORRIS_MIN) * math.exp(-1.0), rel=0.01
    )
    assert morris(MORRIS_MIN, 0.0, dt, 10) == pytest.approx(MORRIS_MIN, rel=1e-12)
    assert morris(MORRIS_MIN, +5.0 * rate, dt, 10) == pytest.approx(MORRIS_MIN, rel=1e-12), "expansion"
    assert morris(MORRIS_MIN, -5.0 * rate, 1e-3 * dt, 10) == pytest.approx(
        MORRIS_MIN + 10 * 1e-3 * dt * 5.0 * rate, rel=1e-3
    )
    assert morris(MORRIS_MIN, -5.0 * rate, dt, 2000) == pytest.approx(MORRIS_MIN + 5.0, rel=1e-6)
    assert 0.0 < morris(1.0, 0.0, 1e6 * dt, 1) < 1.0, "a long step overshoots nothing"
