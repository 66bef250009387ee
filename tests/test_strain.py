"""Equivalent strain: known deformations, numpy's eigenvalues, and what a rotation must not change."""

import functools
import math

import numpy as np
import pytest
import warp as wp

from warpsph.kernels.spec import Spec
from warpsph.kernels.strain import MEASURES, make_strain

SINGLE, DOUBLE = (Spec(3, real) for real in (wp.float32, wp.float64))
NEVER = 0.0
"""A threshold that no bound is below."""


@functools.cache
def sampler(spec, measure):
    real, mat, strain = spec.real, spec.mat, make_strain(spec, measure)

    @wp.kernel(module="unique", enable_backward=False)
    def sample(F: wp.array[mat], thickness: wp.array[real], threshold: real, out: wp.array[real]):
        i = wp.tid()
        out[i] = strain(mat(F[i]), real(thickness[i]), threshold)

    return sample


def equivalent(spec, measure, F, thickness=1.0, threshold=NEVER):
    """Equivalent strains of deformation gradients of shape [n, 3, 3]."""
    n, real = len(F), spec.real
    out = wp.zeros(n, dtype=real, device="cpu")
    given = wp.array(F, dtype=spec.mat, device="cpu")
    across = wp.array(np.broadcast_to(thickness, n).copy(), dtype=real, device="cpu")
    wp.launch(sampler(spec, measure), n, [given, across, real(threshold), out], device="cpu")
    return out.numpy().astype(np.float64)


def strain_of_stretch(measure, stretch):
    """Principal strains."""
    return {
        "logarithmic": np.log(stretch),
        "green-lagrange": 0.5 * (stretch**2 - 1.0),
        "almansi": 0.5 * (1.0 - stretch**-2.0),
    }[measure]


def expected(measure, F):
    """The same from numpy's singular values."""
    principal = strain_of_stretch(measure, np.linalg.svd(F, compute_uv=False))
    dev = principal - principal.mean(axis=-1, keepdims=True)
    return np.sqrt(2.0 / 3.0 * (dev**2).sum(axis=-1))


def rotations(dim, n, seed=0):
    """Random proper rotations that stay in the problem's space, shape [n, 3, 3]."""
    rng = np.random.default_rng(seed)
    out = np.tile(np.eye(3), (n, 1, 1))
    if dim == 2:
        c, k = np.cos(a := rng.uniform(0.0, 2.0 * np.pi, n)), np.sin(a)
        out[:, :2, :2] = np.moveaxis(np.array([[c, -k], [k, c]]), -1, 0)
    if dim == 3:
        out = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
        out *= np.linalg.det(out)[:, None, None]
    return out


def gradients(dim, n=300, size=0.6, seed=1):
    """Random deformation gradients with stretches from exp(-size) to exp(size), shape [n, 3, 3]."""
    stretch = np.exp(np.random.default_rng(seed).uniform(-size, size, size=(n, 3)))
    stretch[:, dim:] = 1.0
    return rotations(dim, n, 2) @ (stretch[:, :, None] * rotations(dim, n, 3))


def stored(spec, F):
    """F as the precision holds it."""
    return F.astype(wp.dtype_to_numpy(spec.real)).astype(np.float64)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("size", [1e-3, 0.6, 2.0])
def test_equals_the_one_of_the_singular_values(spec, measure, size, eps):
    F = stored(spec, gradients(spec.dim, size=size))
    found, right = equivalent(spec, measure, F), expected(measure, F)
    tolerance = 20.0 * eps * math.exp(4.0 * size)  # b is as ill-conditioned as the ratio of its eigenvalues
    np.testing.assert_allclose(found, right, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("stretch", [0.3, 0.9, 1.0, 1.7])
def test_uniaxial_stretch(spec, measure, stretch, eps):
    """Only one principal strain: 2/3 of it."""
    found = equivalent(spec, measure, np.diag([stretch, 1.0, 1.0])[None])
    assert found == pytest.approx(
        2.0 / 3.0 * abs(strain_of_stretch(measure, stretch)), rel=60 * eps, abs=4 * eps
    )


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("g", [0.1, 1.0, 2.5])
def test_simple_shear(precision, dim, g, eps):
    """Logarithmic 2/sqrt(3) asinh(γ/2), as the stretches are exp(±asinh(γ/2)); the others by their tensors."""
    spec, F = Spec(dim, precision.real), np.eye(3)[None].copy()
    F[0, 0, 1] = g = float(np.dtype(wp.dtype_to_numpy(precision.real)).type(g))
    polynomial = math.sqrt(2.0 / 3.0 * (0.5 * g**2 + g**4 / 6.0))  # of [[0, γ/2], [γ/2, ±γ²/2]]
    for measure, value in {
        "logarithmic": 2.0 / math.sqrt(3.0) * math.asinh(0.5 * g),
        "green-lagrange": polynomial,
        "almansi": polynomial,
    }.items():
        assert equivalent(spec, measure, F) == pytest.approx(value, rel=200 * eps)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_rotation_is_no_strain(spec, measure, eps):
    F = rotations(spec.dim, 200)
    assert equivalent(spec, measure, F).max() < 10 * eps
    assert equivalent(spec, measure, F, threshold=0.85).max() < 10 * eps


@pytest.mark.parametrize("measure", MEASURES)
def test_rotations_before_and_after_change_nothing(spec, measure, eps):
    F = gradients(spec.dim)
    alone = equivalent(spec, measure, F)
    for turned in (rotations(spec.dim, len(F), 5) @ F, F @ rotations(spec.dim, len(F), 6)):
        np.testing.assert_allclose(equivalent(spec, measure, turned), alone, rtol=300 * eps, atol=100 * eps)


@pytest.mark.parametrize("measure", MEASURES)
def test_thickness_is_the_stretch_across(precision, measure, eps):
    """In the plane it counts, whatever F_zz says; nowhere else does it."""
    F, across = stored(precision, gradients(2)), 0.75
    full = F.copy()
    full[:, 2, 2] = across
    found = equivalent(Spec(2, precision.real), measure, F, across)
    np.testing.assert_allclose(found, expected(measure, full), rtol=300 * eps, atol=100 * eps)
    for dim in (1, 3):
        spec, F = Spec(dim, precision.real), gradients(dim)
        np.testing.assert_array_equal(equivalent(spec, measure, F, across), equivalent(spec, measure, F))


@pytest.mark.parametrize("size", [0.01, 0.3, 1.5])
def test_the_bound_is_one(precision, size, eps):
    """In three dimensions a value below the threshold may be too large, but says right on which side it is."""
    threshold, F = 0.85, stored(precision, gradients(3, 5000, size))
    true, found = expected("logarithmic", F), equivalent(precision, "logarithmic", F, threshold=threshold)
    tolerance = 20.0 * eps * math.exp(4.0 * size)
    assert (found >= true - tolerance).all()
    clear = abs(true - threshold) > tolerance
    np.testing.assert_array_equal((found < threshold)[clear], (true < threshold)[clear])
    if size == 0.01:
        assert (found != equivalent(precision, "logarithmic", F)).all(), "the bound is in use"
        np.testing.assert_allclose(found, true, rtol=0.02 + 1e3 * eps)


@pytest.mark.parametrize("measure", ["logarithmic", "green-lagrange"])
def test_a_flattened_particle_is_strained(spec, measure):
    """Not a number would never convert."""
    assert (equivalent(spec, "logarithmic", np.diag([1e-9, 1.0, 1.0])[None]) > 5.0).all()
    crushed = np.diag([1e-4, 1e4, 1.0] if spec.dim > 1 else [1e-4, 1.0, 1.0])[None]
    assert (equivalent(spec, measure, crushed) > 0.3).all()
