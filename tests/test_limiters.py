"""Slope limiters: the published formulas, their symmetry and bounds, and no new extrema on monotone data."""

import functools

import numpy as np
import pytest
import warp as wp

from warpsph.kernels.limiters import LIMITERS, make_limiter
from warpsph.kernels.spec import Spec

DOUBLE = Spec(3, wp.float64)
BETA = 1.3
N = 5000


@functools.cache
def sampler(spec, name, jump):
    real, limited = spec.real, make_limiter(spec, name, jump)

    @wp.kernel(module="unique", enable_backward=False)
    def sample(a: wp.array[real], b: wp.array[real], d: wp.array[real], beta: real, slope: wp.array[real]):
        i = wp.tid()
        slope[i] = limited(a[i], b[i], d[i], beta)

    return sample


def slope(spec, name, a, b, d=None, beta=BETA, device="cpu"):
    """Limited slope of slopes a and b, bounded by d where it is given."""
    values = np.broadcast_arrays(*(np.asarray(x, float) for x in (a, b, 0.0 if d is None else d)))
    ins = [wp.array(x.ravel(), dtype=spec.real, device=device) for x in values]
    out = wp.zeros(values[0].size, dtype=spec.real, device=device)
    wp.launch(sampler(spec, name, d is not None), out.size, [*ins, beta, out], device=device)
    return out.numpy().astype(np.float64).reshape(values[0].shape)


def slopes(spec, count=2, seed=0):
    """Random slopes of either sign, over many orders of magnitude, as the precision can hold them."""
    rng = np.random.default_rng(seed)
    x = rng.choice([-1.0, 1.0], size=(count, N)) * 10.0 ** rng.uniform(-6.0, 6.0, size=(count, N))
    return x.astype(wp.dtype_to_numpy(spec.real)).astype(np.float64)


def phi(name, r):
    """The limiters as functions of r (Connolly et al. 2013, Eq. 27)."""
    if name == "vanleer":
        return (r + np.abs(r)) / (1.0 + np.abs(r))
    if name == "mc":
        return np.maximum(0.0, np.minimum(np.minimum(2.0 * r, 0.5 * (1.0 + r)), 2.0))
    beta = {"minmod": 1.0, "superbee": 2.0, "sweby": BETA}[name]
    return np.maximum(0.0, np.maximum(np.minimum(beta * r, 1.0), np.minimum(r, beta)))


@pytest.mark.parametrize("name", LIMITERS)
def test_published_formulas(name, precision, eps, device):
    """The slope is φ(b/a) a, and φ(a/b) b just as well."""
    a, b = slopes(precision)
    found = slope(precision, name, a, b, device=device)
    np.testing.assert_allclose(found, phi(name, b / a) * a, rtol=10 * eps)
    np.testing.assert_allclose(found, phi(name, a / b) * b, rtol=10 * eps)


@pytest.mark.parametrize("name", LIMITERS)
def test_symmetric_homogeneous_and_odd(name, precision):
    """Both particles of a pair must find the same slope to the last bit: it enters a force and its reaction."""
    a, b, d = slopes(precision, 3)
    for own in (None, d):
        found = slope(precision, name, a, b, own)
        np.testing.assert_array_equal(found, slope(precision, name, b, a, own))
        flipped = None if own is None else -own
        np.testing.assert_array_equal(found, -slope(precision, name, -a, -b, flipped))
        scaled = None if own is None else 8.0 * own
        np.testing.assert_array_equal(8.0 * found, slope(precision, name, 8.0 * a, 8.0 * b, scaled))


@pytest.mark.parametrize("name", LIMITERS)
def test_zero_at_an_extremum(name, precision):
    a, b, d = np.abs(slopes(precision, 3))
    for first, second in ((a, -b), (-a, b), (a, 0.0), (0.0, b), (0.0, 0.0)):
        assert not slope(precision, name, first, second).any()
        assert not slope(precision, name, first, second, d).any()
    for own in (-d, 0.0):
        assert not slope(precision, name, a, b, own).any(), "nor against the pair's own difference"


@pytest.mark.parametrize("name", LIMITERS)
def test_between_minmod_and_superbee(name, precision, eps):
    a, b = np.abs(slopes(precision))
    low, found, high = (slope(precision, n, a, b) for n in ("minmod", name, "superbee"))
    np.testing.assert_array_equal(low, np.minimum(a, b))
    np.testing.assert_array_equal(high, np.minimum(2.0 * np.minimum(a, b), np.maximum(a, b)))
    assert (found >= low * (1.0 - 2.0 * eps)).all() and (found <= high * (1.0 + 2.0 * eps)).all()


def test_ends_of_sweby(precision):
    a, b = slopes(precision)
    for beta, name in ((1.0, "minmod"), (2.0, "superbee")):
        found = slope(precision, "sweby", a, b, beta=beta)
        np.testing.assert_array_equal(found, slope(precision, name, a, b))


@pytest.mark.parametrize("name", LIMITERS)
def test_equal_slopes_stay(name, precision, eps):
    """A linear field is reconstructed as it is: second order."""
    a, _ = slopes(precision)
    np.testing.assert_allclose(slope(precision, name, a, a), a, rtol=2 * eps)
    np.testing.assert_allclose(slope(precision, name, a, a, a), a, rtol=2 * eps)


@pytest.mark.parametrize("name", LIMITERS)
def test_bounded_by_the_own_difference_states_never_cross(name, precision, eps):
    """Whatever the slopes: both states lie between the particles' values, in their order.

    Without the bound they need not. Smooth data 0, 0, 1, 1 have the centred slopes 1/2 and 1/2 at its two middle
    points and the difference 1, so that all is well; but 0, 1, 1.1, 2.1 has 0.55 twice where the difference is 0.1:
    the states 1 + 0.275 and 1.1 - 0.275 have crossed and lie outside of the two values.
    """
    a, b, d = slopes(precision, 3)
    ends = np.random.default_rng(1).normal(size=N)
    reach = np.random.default_rng(2).uniform(0.0, 0.5, size=(2, N))  # (1 - c dt/r)/2 of either side
    bounded = slope(precision, name, a, b, d)
    assert (np.abs(bounded) <= np.abs(d)).all() and (bounded * d >= 0.0).all()
    right, left = ends + d, ends  # r = 1: Q_b = Q_a - d
    state_r, state_l = right - reach[0] * bounded, left + reach[1] * bounded
    slack = 4 * eps * (np.abs(ends) + np.abs(d))
    low, high = np.minimum(left, right) - slack, np.maximum(left, right) + slack
    for state in (state_r, state_l):
        assert (low <= state).all() and (state <= high).all()
    assert ((state_r - state_l) * np.sign(d) >= -2 * slack).all()


@pytest.mark.parametrize("name", LIMITERS)
def test_the_docstring_of_the_bound(name):
    """Data 0, 1, 1.1, 2.1: what is said above holds, and the bound cures it."""
    free, bounded = slope(DOUBLE, name, 0.55, 0.55), slope(DOUBLE, name, 0.55, 0.55, 0.1)
    assert free == pytest.approx(0.55) and 1.0 + 0.5 * free > 1.1 > 1.0 > 1.1 - 0.5 * free
    assert bounded == pytest.approx(0.1)
