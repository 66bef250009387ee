"""Artificial stress: minus 0.3 of the tensile part of the stress, over density squared."""

import numpy as np
import pytest
import warp as wp
from tools import DOUBLE, launch

from warpsph.kernels.artificial_stress import make_artificial_stress
from warpsph.kernels.spec import Spec

RHO, GPA = 2700.0, 1e9


def stresses(dim):
    """Random stresses, and ones with equal, zero and extreme principal components."""
    rng = np.random.default_rng(0)
    general = rng.normal(size=(60, 3, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] if dim == 3 else np.eye(3)
    values = [(1, 1, 1), (-1, -1, -1), (1, 1, -1), (2, 0, 0), (0, 0, 0), (1, 1 + 1e-9, 0.5), (1e-6, 1, -1e-6)]
    diagonal = np.array([np.diag(v) for v in values], dtype=float)
    return GPA * np.concatenate([general + general.swapaxes(1, 2), diagonal, turn @ diagonal @ turn.T])


def tensile(stress, dim):
    """Reference: the positive part of the in-problem block of the stress."""
    out = np.zeros_like(stress)
    values, vectors = np.linalg.eigh(stress[:, :dim, :dim])
    out[:, :dim, :dim] = np.einsum("nij,nj,nkj->nik", vectors, np.maximum(values, 0.0), vectors)
    return out


@pytest.mark.parametrize("real", [wp.float64, wp.float32], ids=["f64", "f32"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_tensile_principal_components_are_reversed(dim, real):
    sig = stresses(dim)
    n = len(sig)
    found = launch(
        make_artificial_stress(Spec(dim, real)), n, Spec(dim, real),
        sig=sig, rho=np.full(n, RHO), dt=np.ones(1), R=np.zeros((n, 3, 3)),
    )["R"]  # fmt: skip
    tolerance = {wp.float64: 1e-13, wp.float32: 1e-5}[real]
    size = 0.3 * np.abs(sig).max(axis=(1, 2), keepdims=True) / RHO**2
    error = np.abs(found + 0.3 * tensile(sig, dim) / RHO**2) / np.maximum(size, 1e-300)
    assert np.isfinite(found).all() and error.max() < tolerance
