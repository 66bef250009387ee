"""The constitutive update driven by given velocity gradients: objectivity, plane strain, plane stress, uniaxial strain."""

import math

import numpy as np
import pytest
from tools import DENSITY, DOUBLE, ELASTIC, PLASTIC, G, K, body, by_id, jittered, launch

from warpsph import materials as lib
from warpsph.kernels.constitutive import make_constitutive
from warpsph.materials import pack

E = 9.0 * K * G / (3.0 * K + G)
NU = E / (2.0 * G) - 1.0
C = math.sqrt(K / DENSITY)
Y = PLASTIC.strength.Y


def deform(
    L,
    dt,
    steps,
    dim=3,
    plane_stress=False,
    material=ELASTIC,
    tau=None,
    e=0.0,
    div=None,
    spec=None,
    state=None,
):
    """One particle under a velocity gradient, or a function of its stress that gives one; its fields at the end.

    With ``div`` the density follows that rate. ``state`` is what an earlier call gave, to go on from.
    """
    spec = spec or DOUBLE[dim]
    kernel = make_constitutive(spec, plane_stress, div is not None)
    one = np.ones(1)
    start = {
        "dvdx": np.zeros((1, 3, 3)), "div": (div or 0.0) * one, "e": e * one, "m": material.density * one,
        "mat": np.zeros(1, np.int32), "dt": dt * one, "rho": material.density * one,
        "tau": (np.zeros((3, 3)) if tau is None else tau)[None], "ep": 0 * one, "ep_rate": 0 * one,
        "T": material.initial_temperature * one, "D": 0 * one, "p": 0 * one,
        "cs": material.bulk_speed * one, "cl": 0 * one, "sig": np.zeros((1, 3, 3)), "vol": one,
        "thickness": one.copy(), "p_high": 0 * one, "p_low": 0 * one, "clipped": np.zeros(1, np.int32),
        "F": np.eye(3)[None], "vol0": one, "kernel_type": np.zeros(1, np.int32), "fate": np.zeros(1, np.int32),
    }  # fmt: skip
    state = start | {name: values[None] for name, values in (state or {}).items() if name in start}
    state |= {"dt": dt * one}
    table = pack([material], spec, "cpu")
    for _ in range(steps):
        rate = L(state["sig"][0] / state["thickness"][0]) if callable(L) else L
        state = launch(
            kernel, 1, spec, materials=table, **(state | {"dvdx": np.array(rate, dtype=float)[None]})
        )
        state = {name: values for name, values in state.items() if name in start}
    return {name: values[0] for name, values in state.items()}


def uniaxial(ratio, rate=1.0):
    return np.diag([rate, -ratio * rate, 0.0])


def deviator(seed=0):
    T = np.random.default_rng(seed).normal(size=(3, 3))
    T = T + T.T
    return 1e9 * (T - np.trace(T) / 3.0 * np.eye(3))


def test_a_full_turn_brings_the_stress_back():
    axis, tau, steps = np.array([1.0, 2.0, -2.0]) / 3.0, deviator(), 2000
    spin = 2.0 * np.pi * np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    quarter, whole = (deform(spin, 1.0 / steps, n, tau=tau, e=7.0) for n in (steps // 4, steps))
    for state in (quarter, whole):
        for power in (2, 3):
            invariant = np.trace(np.linalg.matrix_power(tau, power))
            found = np.trace(np.linalg.matrix_power(state["tau"], power))
            assert found == pytest.approx(invariant, rel=1e-11, abs=1e-11 * 1e9**power)
        assert (state["rho"], state["e"], state["ep"], state["p"]) == (DENSITY, 7.0, 0.0, 0.0)
    turn = np.outer(axis, axis) + np.array(
        [[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]]
    )
    size = np.abs(tau).max()
    np.testing.assert_allclose(quarter["tau"], turn @ tau @ turn.T, atol=1e-5 * size)
    np.testing.assert_allclose(whole["tau"], tau, atol=1e-5 * size)


def test_a_rotating_frame_sees_the_same_stress():
    """Stretching while turning gives the stress of stretching alone, turned, but for the angle of one step."""
    rate, steps, angle = 1e-3, 1000, 0.5 * np.pi
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    still = deform(np.diag([rate, 0.0, 0.0]), 1.0 / steps, steps)["tau"]
    step = iter(range(steps))

    def turning(_):
        a = angle * (next(step) + 0.5) / steps
        n = np.array([math.cos(a), math.sin(a), 0.0])
        return rate * np.outer(n, n) + angle * np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0]], dtype=float)

    np.testing.assert_allclose(
        deform(turning, 1.0 / steps, steps)["tau"],
        turn @ still @ turn.T,
        atol=angle / steps * np.abs(still).max(),
    )


@pytest.mark.parametrize("scheme", ["sav1", "bal-mixed-as"])
def test_uniform_motion_gives_nothing(scheme):
    x = jittered(2, 8)
    solver = body(2, x, (1234.5, -678.9, 0.0), scheme=scheme)
    solver.advance(1e-6)
    assert solver.reading.steps > 3
    for name in ("tau", "p", "e", "dvdt", "dvdx", "ep"):
        np.testing.assert_array_equal(by_id(solver, name), 0.0)
    np.testing.assert_allclose(
        by_id(solver, "x") - x, np.broadcast_to([1.2345e-3, -0.6789e-3, 0], x.shape), atol=1e-15
    )


def test_a_split_density_follows_its_own_rate():
    """The density takes div, the deviator the gradient; in plane stress the thickness counts too."""
    shear = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    state = deform(shear, 1e-5, 10, dim=2, div=-2.0)
    assert state["rho"] == pytest.approx(DENSITY * math.exp(2e-4), rel=1e-14)
    assert state["p"] == pytest.approx(K * (math.exp(2e-4) - 1.0), rel=1e-10)
    assert state["tau"][0, 1] == pytest.approx(G * 1e-4, rel=1e-3)
    together, apart = (deform(uniaxial(NU), 1e-7, 10, 2, True, div=div) for div in (None, 1.0 - NU))
    for name in ("rho", "sig", "thickness"):
        np.testing.assert_allclose(apart[name], together[name], rtol=1e-7, atol=1e-8 * K * 1e-6)


def test_uniaxial_strain_has_the_longitudinal_modulus():
    state = deform(np.diag([1.0, 0.0, 0.0]), 1e-7, 10, dim=1)
    assert state["sig"][0, 0] / 1e-6 == pytest.approx(K + 4.0 * G / 3.0, rel=1e-5)
    assert state["cl"] == pytest.approx(math.sqrt((K + 4.0 * G / 3.0) / DENSITY), rel=1e-5)


def test_plane_strain_has_its_modulus():
    state = deform(uniaxial(NU / (1.0 - NU)), 1e-7, 10, dim=2)
    assert state["sig"][0, 0] / 1e-6 == pytest.approx(E / (1.0 - NU**2), rel=1e-5)
    assert abs(state["sig"][1, 1]) < 1e-5 * abs(state["sig"][0, 0])
    assert state["sig"][2, 2] == pytest.approx(NU * state["sig"][0, 0], rel=1e-4)
    assert state["thickness"] == 1.0


def test_plane_stress_has_youngs_modulus():
    state = deform(uniaxial(NU), 1e-7, 10, dim=2, plane_stress=True)
    assert state["sig"][0, 0] / 1e-6 == pytest.approx(E, rel=1e-5)
    assert abs(state["sig"][2, 2]) < 1e-9 * 10 * (K + 4.0 * G / 3.0)
    assert state["thickness"] - 1.0 == pytest.approx(-NU * 1e-6, rel=1e-2)
    assert state["vol"] * state["rho"] * state["thickness"] == pytest.approx(DENSITY, rel=1e-14)


@pytest.mark.parametrize("rate", [1.0, -1.0])
def test_plane_stress_holds_in_plastic_flow(rate):
    """A sheet pulled in x and left free in y yields at σ_xx = Y and flows at constant volume."""

    def free(sig):
        return np.diag([rate, -(0.5 * rate) - sig[1, 1] / (E * 1e-4), 0.0])

    state = deform(free, 1e-4, 1000, dim=2, plane_stress=True, material=PLASTIC)
    stress = state["sig"] / state["thickness"]
    assert stress[0, 0] == pytest.approx(rate * Y, rel=1e-3)
    assert abs(stress[2, 2]) < 1e-8 * K and abs(stress[1, 1]) < 1e-2 * Y
    assert state["ep"] == pytest.approx(0.1 - Y / E, rel=1e-3)
    assert state["thickness"] == pytest.approx(math.exp(-0.05 * rate), rel=1e-3)


def test_plastic_work_becomes_heat(precision):
    """χ of the work that is not stored elastically: pure shear at constant volume, Johnson-Cook steel."""
    steel, rate, dt, steps = lib.get("steel-jc"), 1e5, 1e-8, 200
    law, L = steel.strength, rate * np.diag([1.0, -1.0, 0.0])
    work, state = 0.0, None
    for _ in range(steps):
        before = np.zeros((3, 3)) if state is None else state["tau"].astype(float)
        state = deform(L, dt, 1, material=steel, spec=precision, state=state)
        work += dt * 0.5 * np.sum((before + state["tau"]) * L)
    plastic = work - np.sum(state["tau"].astype(float) ** 2) / (4.0 * law.G)
    assert state["T"] - law.T0 == pytest.approx(law.chi * plastic / (steel.density * law.Cv), rel=2e-3)
    assert state["T"] - law.T0 > 50.0
    assert state["ep_rate"] == pytest.approx(2.0 * rate / math.sqrt(3.0), rel=2e-2)
    assert state["rho"] == pytest.approx(steel.density, rel=1e-6)


def test_stress_is_on_the_yield_surface_of_rate_and_temperature(precision, eps):
    """q = Y(εp', ε̇, T) with the plastic strain and rate of the end of the step, the temperature of its start."""
    steel, L = lib.get("steel-jc"), 1e5 * np.diag([1.0, -0.3, -0.2])
    law = steel.strength
    before = deform(L, 1e-8, 20, material=steel, spec=precision)
    after = deform(L, 1e-8, 1, material=steel, spec=precision, state=before)
    q = math.sqrt(1.5 * np.sum(after["tau"].astype(float) ** 2))
    soft = 1.0 - (float(before["T"]) - law.T0) / (law.Tm - law.T0)
    Y = (
        (law.A + law.B * float(after["ep"]) ** law.n)
        * (1.0 + law.C * math.log(float(after["ep_rate"])))
        * soft
    )
    assert q == pytest.approx(Y, rel=100 * eps)


def test_metal_yields_alike_in_a_rotated_frame(precision, eps):
    """A rotation of the gradient rotates the stress and changes no invariant."""
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    L = 1e5 * np.diag([1.0, -0.8, -0.4])
    for name in ("steel-jc", "sic"):
        plain, turned = (
            deform(rate, 1e-7, 10, material=lib.get(name), spec=precision) for rate in (L, turn @ L @ turn.T)
        )
        size = np.abs(plain["tau"]).max() + 1e6
        np.testing.assert_allclose(turned["tau"], turn @ plain["tau"] @ turn.T, atol=1e4 * eps * size)
        for field in ("ep", "D", "T", "p"):
            assert turned[field] == pytest.approx(plain[field], rel=1e4 * eps)


def test_plane_stress_holds_for_a_rate_dependent_metal():
    """Thickness found with the pressure of the same trial; σ_zz vanishes while Johnson-Cook aluminium flows."""
    state = deform(
        1e4 * uniaxial(0.45), 1e-8, 300, dim=2, plane_stress=True, material=lib.get("aluminium-jc")
    )
    assert state["ep"] > 0.01 and abs(state["sig"][2, 2]) < 1e-6 * state["sig"][0, 0]


@pytest.mark.parametrize("name", ["steel-jc", "aluminium-jc", "sic"])
def test_a_state_that_is_not_a_number_stays_one(name):
    """No law hides it, and no iteration hangs on it."""
    state = deform(np.full((3, 3), np.nan), 1e-8, 1, material=lib.get(name))
    assert np.isnan(state["rho"]) and np.isnan(state["cl"])
