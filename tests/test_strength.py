import functools

import numpy as np
import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.kernels.material import make_material
from warpsph.kernels.strength import LAWS, make_strength

G, Y, H = 27.6e9, 0.3e9, 2.0e9
GAS = lib.StiffenedGas(c0=5328.0, gamma0=2.0)
MATERIALS = {
    "fluid": lib.Material("fluid", 1000.0, GAS, lib.Fluid()),
    "elastic": lib.Material("elastic", 1000.0, GAS, lib.Elastic(G=G)),
    "plastic": lib.Material("plastic", 1000.0, GAS, lib.PerfectlyPlastic(G=G, Y=Y)),
    "hardening": lib.Material("hardening", 1000.0, GAS, lib.LinearHardening(G=G, Y=Y, H=H)),
}


@functools.cache
def sampler(spec):
    real, mat, Material, strength = spec.real, spec.mat, make_material(spec), make_strength(spec)
    flow_stress, return_map = strength.flow_stress, strength.return_map

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        table: wp.array[Material], trial: wp.array[mat], ep: wp.array[real],
        tau: wp.array[mat], d_ep: wp.array[real], flow: wp.array[real],
    ):  # fmt: skip
        i = wp.tid()
        tau_i, d_ep_i = return_map(table[0], trial[i], ep[i])
        Y_i, _ = flow_stress(table[0], ep[i] + d_ep_i)
        tau[i] = tau_i
        d_ep[i] = d_ep_i
        flow[i] = Y_i

    return sample


def evaluate(spec, material, trial, ep, device="cpu"):
    """Return tau, d_ep and the flow stress at the end of the step."""
    n = len(trial)
    real, mat = spec.real, spec.mat
    ins = [wp.array(trial, dtype=mat, device=device), wp.array(ep, dtype=real, device=device)]
    outs = [wp.zeros(n, dtype=dtype, device=device) for dtype in (mat, real, real)]
    wp.launch(sampler(spec), n, [lib.pack([material], spec, device), *ins, *outs], device=device)
    return [values.numpy().astype(np.float64) for values in outs]


def von_mises(tau):
    return np.sqrt(1.5 * np.einsum("nij,nij->n", tau, tau))


def trials(size, n=20, seed=0):
    """Random deviators with von Mises stress from well below ``size`` to a few times that."""
    T = np.random.default_rng(seed).normal(size=(n, 3, 3)) * np.linspace(0.05, 1.0, n)[:, None, None] * size
    T = 0.5 * (T + T.swapaxes(1, 2))
    return T - np.trace(T, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)


def test_every_law_is_tested():
    assert {material.strength.id for material in MATERIALS.values()} == set(LAWS)


@pytest.mark.parametrize("name", ["plastic", "hardening"])
def test_return_lands_on_the_yield_surface(name, precision, eps, device):
    trial, ep = trials(2.0 * Y), np.linspace(0.0, 0.1, 20)
    tau, d_ep, flow = evaluate(precision, MATERIALS[name], trial, ep, device)
    q, q_trial = von_mises(tau), von_mises(trial)
    yielded = d_ep > 0.0
    assert 5 < yielded.sum() < 20
    np.testing.assert_allclose(q[yielded], flow[yielded], rtol=30 * eps)
    assert (q <= flow * (1.0 + 30 * eps)).all()
    np.testing.assert_allclose(
        q_trial - q, 3.0 * G * d_ep, atol=100 * eps * Y
    )  # the identity q_trial - 3 G d_ep = q
    np.testing.assert_array_equal(tau[~yielded], trial[~yielded].astype(precision.real._type_).astype(float))


@pytest.mark.parametrize("name", MATERIALS)
def test_deviator_stays_trace_free_and_keeps_its_direction(name, precision, eps):
    trial = trials(3.0 * Y)
    tau, _, _ = evaluate(precision, MATERIALS[name], trial, np.zeros(20))
    assert np.abs(np.trace(tau, axis1=1, axis2=2)).max() <= 20 * eps * Y
    scale = np.einsum("nij,nij->n", tau, trial) / np.einsum("nij,nij->n", trial, trial)
    np.testing.assert_allclose(tau, scale[:, None, None] * trial, atol=50 * eps * Y)


def test_hardening_by_hand(precision, eps):
    """Pure shear τ_xy = s has q = √3 s; one step from εp = 0.1."""
    s, ep = 0.5e9, 0.1
    trial = np.zeros((1, 3, 3))
    trial[0, 0, 1] = trial[0, 1, 0] = s
    tau, d_ep, flow = evaluate(precision, MATERIALS["hardening"], trial, [ep])
    expected = (np.sqrt(3.0) * s - (Y + H * ep)) / (3.0 * G + H)
    assert d_ep[0] == pytest.approx(expected, rel=30 * eps)
    assert tau[0, 0, 1] == pytest.approx((Y + H * (ep + expected)) / np.sqrt(3.0), rel=10 * eps)
    assert flow[0] == pytest.approx(Y + H * (ep + expected), rel=10 * eps)


def test_fluid_carries_no_shear_stress(precision):
    tau, d_ep, flow = evaluate(precision, MATERIALS["fluid"], trials(Y), np.zeros(20))
    assert not tau.any() and not d_ep.any() and not flow.any()


def test_elastic_never_yields(precision):
    trial = trials(100.0 * Y)
    tau, d_ep, flow = evaluate(precision, MATERIALS["elastic"], trial, np.zeros(20))
    np.testing.assert_array_equal(tau, trial.astype(precision.real._type_).astype(float))
    assert not d_ep.any() and np.isinf(flow).all()


def test_no_stress_stays_none(precision):
    for material in MATERIALS.values():
        tau, d_ep, _ = evaluate(precision, material, np.zeros((1, 3, 3)), [0.0])
        assert not tau.any() and not d_ep.any()
