import numpy as np
import pytest
from states import impact

from warpsph.errors import InputError
from warpsph.scalars import KERNEL_TYPES, equivalent_strain, names, scalar


def gradients(seed=1, n=20):
    """Deformation gradients of any kind, but without inversion, shape [n, 3, 3]."""
    made = np.eye(3) + 0.4 * np.random.default_rng(seed).normal(size=(n, 3, 3))
    made[np.linalg.det(made) < 0.0, 0] *= -1.0
    return made


def rotations(seed=2, n=20):
    """Rotations, shape [n, 3, 3]."""
    made = np.linalg.qr(np.random.default_rng(seed).normal(size=(n, 3, 3)))[0]
    return made * np.linalg.det(made)[:, None, None]


def test_equivalent_strain_of_uniaxial_stretch_and_of_shear():
    stretch, shear = 1.7, 0.9
    F = np.stack([np.diag([stretch, stretch**-0.5, stretch**-0.5]), np.eye(3), 1.3 * np.eye(3)])
    F[1, 0, 1] = shear
    expected = [np.log(stretch), 2.0 / np.sqrt(3.0) * np.arcsinh(0.5 * shear), 0.0]
    np.testing.assert_allclose(equivalent_strain(F), expected, rtol=1e-13, atol=1e-15)


def test_equivalent_strain_is_its_definition():
    F = gradients()
    values, axes = np.linalg.eigh(F @ F.transpose(0, 2, 1))
    strain = np.einsum("nik,nk,njk->nij", axes, 0.5 * np.log(values), axes)
    deviator = strain - np.trace(strain, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    expected = np.sqrt(2.0 / 3.0 * (deviator * deviator).sum(axis=(1, 2)))
    np.testing.assert_allclose(equivalent_strain(F), expected, rtol=1e-10)


def test_equivalent_strain_knows_no_rotation():
    F, Q = gradients(), rotations()
    np.testing.assert_allclose(equivalent_strain(Q), 0.0, atol=1e-14)
    np.testing.assert_allclose(equivalent_strain(Q @ F), equivalent_strain(F), rtol=1e-10)
    np.testing.assert_allclose(equivalent_strain(F @ Q), equivalent_strain(F), rtol=1e-10)


def test_singular_gradient_gives_no_finite_strain():
    F = np.stack([np.diag([1.0, 1.0, 0.0]), np.eye(3)])
    assert np.isfinite(equivalent_strain(F)).tolist() == [False, True]


def test_equivalent_strain_needs_the_deformation_gradient():
    state = impact()
    state.fields.pop("F", None)
    assert "equivalent_strain" not in names(state)
    with pytest.raises(InputError, match="field 'equivalent_strain' is unknown"):
        scalar(state, "equivalent_strain")
    state.fields["F"] = np.tile(np.diag([2.0, 1.0, 0.5]), (len(state.x), 1, 1)).astype(np.float32)
    quantity = scalar(state, "equivalent_strain")
    assert quantity.unit == "1" and quantity.values.dtype == np.float64
    np.testing.assert_allclose(quantity.values, 2.0 / np.sqrt(3.0) * np.log(2.0), rtol=1e-6)


def test_kernel_types_have_names():
    assert scalar(impact(), "kernel_type").categories == KERNEL_TYPES
