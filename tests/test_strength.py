import functools
import math

import numpy as np
import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.kernels.material import make_material
from warpsph.kernels.strength import LINEAR, NONLINEAR, make_strength

G, Y, H = 27.6e9, 0.3e9, 2.0e9
GAS = lib.StiffenedGas(c0=5328.0, gamma0=2.0)
JC = lib.JohnsonCook(
    G=G, A=0.3e9, B=1.0e9, n=0.65, C=0.07, m=1.0, T0=298.0, Tm=1673.0, Cv=440.0, chi=0.9, rate0=1.0
)
JH = lib.get("sic").strength
STEEP = lib.JohnsonCook(G=G, A=0.09e9, B=0.292e9, n=0.31, C=0.0, m=1.09, T0=298.0, Tm=1356.0, Cv=383.0)
MATERIALS = {
    "fluid": lib.Material("fluid", 1000.0, GAS, lib.Fluid()),
    "elastic": lib.Material("elastic", 1000.0, GAS, lib.Elastic(G=G)),
    "plastic": lib.Material("plastic", 1000.0, GAS, lib.PerfectlyPlastic(G=G, Y=Y)),
    "hardening": lib.Material("hardening", 1000.0, GAS, lib.LinearHardening(G=G, Y=Y, H=H)),
    "johnson-cook": lib.Material("johnson-cook", 1000.0, GAS, JC),
    "steep": lib.Material("steep", 1000.0, GAS, STEEP),
    "ceramic": lib.Material("ceramic", 1000.0, GAS, JH),
}
DT = 1e-8


@functools.cache
def sampler(spec):
    real, mat, Material, strength = spec.real, spec.mat, make_material(spec), make_strength(spec)
    flow_stress, linear_return, nonlinear_return, warming = strength
    first = int(min(NONLINEAR))

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        table: wp.array[Material], trial: wp.array[mat], ep: wp.array[real], T: wp.array[real], p: wp.array[real],
        D: wp.array[real], dt: real,
        tau: wp.array[mat], d_ep: wp.array[real], flow: wp.array[real], dT: wp.array[real],
    ):  # fmt: skip
        i = wp.tid()
        tau_i, d_ep_i = mat(trial[i]), real(0.0)
        if table[0].strength < first:
            tau_i, d_ep_i = linear_return(table[0], trial[i], ep[i])
        else:
            tau_i, d_ep_i = nonlinear_return(table[0], trial[i], ep[i], T[i], p[i], D[i], dt)
        tau[i] = tau_i
        d_ep[i] = d_ep_i
        flow[i] = flow_stress(table[0], ep[i] + d_ep_i, d_ep_i / dt, T[i], p[i], D[i])
        dT[i] = warming(table[0], tau_i, d_ep_i, real(7903.0))

    return sample


def evaluate(spec, material, trial, ep, device="cpu", T=298.0, p=0.0, D=0.0, dt=DT):
    """Return tau, d_ep, the flow stress at the end of the step and the rise of temperature (at 7903 kg/m³)."""
    n = len(trial)
    real, mat = spec.real, spec.mat
    ins = [wp.array(trial, dtype=mat, device=device)]
    ins += [wp.array(np.broadcast_to(v, n).astype(float), dtype=real, device=device) for v in (ep, T, p, D)]
    outs = [wp.zeros(n, dtype=dtype, device=device) for dtype in (mat, real, real, real)]
    wp.launch(sampler(spec), n, [lib.pack([material], spec, device), *ins, real(dt), *outs], device=device)
    return [values.numpy().astype(np.float64) for values in outs]


@functools.cache
def flow_sampler(spec):
    real, Material, flow_stress = spec.real, make_material(spec), make_strength(spec).flow_stress

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        table: wp.array[Material], ep: wp.array[real], rate: wp.array[real], T: wp.array[real], p: wp.array[real],
        D: wp.array[real], flow: wp.array[real],
    ):  # fmt: skip
        i = wp.tid()
        flow[i] = flow_stress(table[0], ep[i], rate[i], T[i], p[i], D[i])

    return sample


def flow_stress(spec, law, ep=0.0, rate=0.0, T=298.0, p=0.0, D=0.0):
    """Flow stress of a law [Pa]."""
    columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=float)) for v in (ep, rate, T, p, D)))
    n = len(columns[0])
    ins = [wp.array(v, dtype=spec.real, device="cpu") for v in columns]
    flow = wp.zeros(n, dtype=spec.real, device="cpu")
    table = lib.pack([lib.Material("law", 1000.0, GAS, law)], spec, "cpu")
    wp.launch(flow_sampler(spec), n, [table, *ins, flow], device="cpu")
    return flow.numpy().astype(np.float64)


def von_mises(tau):
    return np.sqrt(1.5 * np.einsum("nij,nij->n", tau, tau))


def trials(size, n=20, seed=0):
    """Random deviators with von Mises stress from well below ``size`` to a few times that."""
    T = np.random.default_rng(seed).normal(size=(n, 3, 3)) * np.linspace(0.05, 1.0, n)[:, None, None] * size
    T = 0.5 * (T + T.swapaxes(1, 2))
    return T - np.trace(T, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)


def test_every_law_is_tested():
    assert {material.strength.id for material in MATERIALS.values()} == {*LINEAR, *NONLINEAR}
    assert max(LINEAR) < min(NONLINEAR)


@pytest.mark.parametrize("name", ["plastic", "hardening", "johnson-cook", "steep"])
def test_return_lands_on_the_yield_surface(name, precision, eps, device):
    trial, ep = trials(2.0 * Y), np.linspace(0.0, 0.1 if name in ("plastic", "hardening") else 1e-2, 20)
    tau, d_ep, flow, _ = evaluate(precision, MATERIALS[name], trial, ep, device)
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
    tau, _, _, _ = evaluate(precision, MATERIALS[name], trial, np.zeros(20))
    assert np.abs(np.trace(tau, axis1=1, axis2=2)).max() <= 20 * eps * Y
    scale = np.einsum("nij,nij->n", tau, trial) / np.einsum("nij,nij->n", trial, trial)
    np.testing.assert_allclose(tau, scale[:, None, None] * trial, atol=50 * eps * Y)


def test_hardening_by_hand(precision, eps):
    """Pure shear τ_xy = s has q = √3 s; one step from εp = 0.1."""
    s, ep = 0.5e9, 0.1
    trial = np.zeros((1, 3, 3))
    trial[0, 0, 1] = trial[0, 1, 0] = s
    tau, d_ep, flow, _ = evaluate(precision, MATERIALS["hardening"], trial, [ep])
    expected = (np.sqrt(3.0) * s - (Y + H * ep)) / (3.0 * G + H)
    assert d_ep[0] == pytest.approx(expected, rel=30 * eps)
    assert tau[0, 0, 1] == pytest.approx((Y + H * (ep + expected)) / np.sqrt(3.0), rel=10 * eps)
    assert flow[0] == pytest.approx(Y + H * (ep + expected), rel=10 * eps)


def test_fluid_carries_no_shear_stress(precision):
    tau, d_ep, flow, _ = evaluate(precision, MATERIALS["fluid"], trials(Y), np.zeros(20))
    assert not tau.any() and not d_ep.any() and not flow.any()


def test_elastic_never_yields(precision):
    trial = trials(100.0 * Y)
    tau, d_ep, flow, _ = evaluate(precision, MATERIALS["elastic"], trial, np.zeros(20))
    np.testing.assert_array_equal(tau, trial.astype(precision.real._type_).astype(float))
    assert not d_ep.any() and np.isinf(flow).all()


def test_no_stress_stays_none(precision):
    for material in MATERIALS.values():
        tau, d_ep, _, _ = evaluate(precision, material, np.zeros((1, 3, 3)), [0.0])
        assert not tau.any() and not d_ep.any()


def test_johnson_cook_by_hand(precision, eps):
    """Each factor alone, then together; the reference rate and temperature change nothing."""
    base = 0.3e9 + 1.0e9 * 0.1**0.65
    R, soft = 1.0 + 0.07 * math.log(1e4), 1.0 - (700.0 - 298.0) / (1673.0 - 298.0)
    found = flow_stress(
        precision,
        JC,
        ep=[0.0, 0.1, 0.0, 0.0, 0.1, 0.1, 0.1, 0.1],
        rate=[0.0, 0.0, 1e4, 1.0, 1e4, 0.5, 0.0, 0.0],
        T=[298.0, 298.0, 298.0, 298.0, 700.0, 100.0, 1673.0, 5000.0],
    )
    expected = [0.3e9, base, 0.3e9 * R, 0.3e9, base * R * soft, base, 0.0, 0.0]
    np.testing.assert_allclose(found, expected, rtol=20 * eps, atol=1.0 * eps)
    assert base == pytest.approx(523.872e6, rel=1e-6) and R == pytest.approx(1.6447238, rel=1e-7)


@pytest.mark.parametrize("ep", [0.0, 1e-9, 1e-3, 0.3])
@pytest.mark.parametrize("dt", [1e-6, 1e-8, 1e-10])
def test_return_finds_the_root_for_any_overstress(ep, dt, precision, eps):
    """From a hair above the quasi-static flow stress, where rate and εpⁿ make Y steep, to a multiple of it."""
    over = np.array([1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0])
    for law in (JC, STEEP, lib.get("aluminium-jc").strength):
        material = lib.Material("m", 1000.0, GAS, law)
        q = flow_stress(precision, law, ep=ep, T=350.0)[0] * (1.0 + over)
        trial = np.zeros((len(q), 3, 3))
        trial[:, 0, 1] = trial[:, 1, 0] = q / math.sqrt(3.0)
        tau, d_ep, flow, _ = evaluate(precision, material, trial, ep, T=350.0, dt=dt)
        assert (d_ep >= 0.0).all() and (d_ep[over > 100 * eps] > 0.0).all()
        np.testing.assert_allclose(von_mises(tau), flow, rtol=60 * eps)
        np.testing.assert_allclose(q - 3.0 * law.G * d_ep, flow, atol=60 * eps * q.max(), rtol=0)


def test_ceramic_returns_to_its_surface(precision, eps):
    """Intact and failed, at pressures on every line."""
    trial, p = trials(40e9), np.linspace(-0.7e9, 15e9, 20)
    for D in (0.0, 0.999, 1.0):
        tau, d_ep, flow, _ = evaluate(precision, MATERIALS["ceramic"], trial, 0.0, p=p, D=D)
        yielded = d_ep > 0.0
        assert 5 < yielded.sum()
        np.testing.assert_allclose(von_mises(tau)[yielded], flow[yielded], rtol=60 * eps, atol=eps)
        assert (von_mises(tau) <= flow * (1.0 + 60 * eps)).all()


def test_ceramic_curves_at_the_points_between_and_beyond(precision, eps):
    """The intact and the failed line of silicon carbide, quasi-static; D below 1 changes nothing."""
    p = np.array([-2e9, -0.75e9, 0.875e9, 2.5e9, 6.25e9, 10e9, 50e9])
    for D in (0.0, 0.5, 1.0 - 1e-6):
        np.testing.assert_allclose(
            flow_stress(precision, JH, p=p, D=D),
            [0.0, 0.0, 3.55e9, 7.1e9, 9.65e9, 12.2e9, 12.2e9],
            rtol=20 * eps,
            atol=eps,
        )
    p = np.array([-2e9, 0.0, 1e9, 3.25e9, 10e9])
    np.testing.assert_allclose(
        flow_stress(precision, JH, p=p, D=1.0), [0.0, 0.0, 0.4e9, 1.3e9, 1.3e9], rtol=20 * eps, atol=eps
    )


@pytest.mark.parametrize("D", [0.0, 1.0])
def test_ceramic_rate_factor(D, precision, eps):
    """1 + 0.009 ln 1e6 = 1.12434, intact and failed; nothing below the reference rate."""
    p = np.array([1e9, 5e9])
    still, slow, fast = (flow_stress(precision, JH, p=p, D=D, rate=rate) for rate in (0.0, 1.0, 1e6))
    np.testing.assert_array_equal(still, slow)
    np.testing.assert_allclose(fast / still, 1.0 + 0.009 * math.log(1e6), rtol=20 * eps)


def test_plastic_work_heats(precision, eps):
    """dT = χ q Δεp/(ρ Cv) with the stress after the return; a law without a heat capacity stays cold."""
    trial = trials(1.5e9)
    tau, d_ep, _, dT = evaluate(precision, MATERIALS["johnson-cook"], trial, 0.01)
    assert dT.max() > 1.0
    np.testing.assert_allclose(dT, 0.9 * von_mises(tau) * d_ep / (7903.0 * 440.0), rtol=20 * eps)
    assert not evaluate(precision, MATERIALS["plastic"], trial, 0.01)[3].any()


def test_molten_metal_carries_no_shear_stress(precision):
    tau, d_ep, flow, _ = evaluate(precision, MATERIALS["johnson-cook"], trials(1e9), 0.1, T=1700.0)
    assert not tau.any() and not flow.any() and (d_ep > 0.0).all()
