"""The smoothing kernels: normalised in every dimension, and consistent with their derivative."""

import functools
import math

import numpy as np
import pytest
import warp as wp

from warpsph.config import KERNELS
from warpsph.kernels.smoothing import make_smoothing

H = 0.7


@functools.cache
def sampler(spec):
    real, pairs = spec.real, [make_smoothing(spec, name)[1:3] for name in KERNELS]
    ws, slopes = tuple(w for w, _ in pairs), tuple(slope for _, slope in pairs)

    @wp.kernel(module="unique", enable_backward=False)
    def sample(r: wp.array[real], h: real, w: wp.array2d[real], dw_r: wp.array2d[real]):
        i = wp.tid()
        for k in range(wp.static(len(ws))):
            w[k, i] = wp.static(ws[k])(r[i], h)
            dw_r[k, i] = wp.static(slopes[k])(r[i], h)

    return sample


def evaluate(spec, name, r):
    """W and (dW/dr)/r of one kernel at distances r."""
    out = [wp.zeros((len(KERNELS), len(r)), dtype=spec.real, device="cpu") for _ in range(2)]
    at = wp.array(r, dtype=spec.real, device="cpu")
    wp.launch(sampler(spec), len(r), [at, spec.real(H), *out], device="cpu")
    return [values.numpy()[KERNELS.index(name)].astype(float) for values in out]


@pytest.fixture(params=KERNELS)
def name(request):
    return request.param


def shell(spec, r):
    """Surface of the sphere of radius r."""
    return {1: 2.0 + 0.0 * r, 2: 2.0 * math.pi * r, 3: 4.0 * math.pi * r**2}[spec.dim]


def test_integrates_to_one(spec, name, eps):
    r_max = make_smoothing(spec, name).support * H
    points, weights = np.polynomial.legendre.leggauss(40)
    total = 0.0
    for a, b in zip(np.arange(6) / 6, np.arange(1, 7) / 6, strict=True):  # a spline's pieces end at whole h
        r = r_max * (0.5 * (b - a) * (points + 1.0) + a)
        total += np.sum(0.5 * (b - a) * r_max * weights * shell(spec, r) * evaluate(spec, name, r)[0])
    assert total == pytest.approx(1.0, abs=1e-12 + 10 * eps)


def test_slope_is_the_derivative(spec, name):
    if spec.real is wp.float32:
        pytest.skip("differences of float32 are too coarse")
    support = make_smoothing(spec, name).support
    r, d = np.linspace(0.02, support - 0.02, 200) * H, 1e-5 * H
    difference = (evaluate(spec, name, r + d)[0] - evaluate(spec, name, r - d)[0]) / (2.0 * d)
    np.testing.assert_allclose(evaluate(spec, name, r)[1] * r, difference, atol=1e-8 / H ** (spec.dim + 1))


def test_positive_decreasing_and_zero_outside(spec, name):
    support = make_smoothing(spec, name).support
    w, slope = evaluate(spec, name, np.linspace(0.0, support - 1e-3, 100) * H)
    assert np.isfinite(w).all() and np.isfinite(slope).all()  # at r = 0 too
    assert (w > 0.0).all() and (np.diff(w) < 0.0).all() and (slope[1:] < 0.0).all()
    for outside in evaluate(spec, name, np.array([support + 1e-6, 2.0 * support, 1e3]) * H):
        np.testing.assert_array_equal(outside, 0.0)
