"""Damage: the growth laws by hand, and a ceramic taken through tension, crushing and reloading."""

import functools
import math

import numpy as np
import pytest
import warp as wp
from test_constitutive import deform

from warpsph import materials as lib
from warpsph.kernels.damage import LAWS, make_damage
from warpsph.kernels.material import DamageId, make_material

SIC = lib.get("sic")
PLATE = lib.get("aluminium-jc")
BRITTLE = lib.Material(
    "brittle",
    7830.0,
    lib.ShockMieGrueneisen(c0=4570.0, S1=1.49, Gamma0=1.9),
    lib.JohnsonCook(G=77e9, A=792e6, B=510e6, n=0.26, C=0.014, m=1.03, T0=300.0, Tm=1793.0, Cv=477.0),
    damage=lib.JohnsonCookDamage(D1=0.05, D2=3.44, D3=-2.12, D4=0.002, D5=0.61),
)
"""4340 steel, Johnson & Cook 1985."""


@functools.cache
def sampler(spec):
    real, mat, Material, damage = spec.real, spec.mat, make_material(spec), make_damage(spec)
    tension, growth, pressure = damage

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        table: wp.array[Material], D: wp.array[real], d_ep: wp.array[real], rate: wp.array[real], T: wp.array[real],
        p: wp.array[real], q: wp.array[real], torn: wp.array[real], grown: wp.array[real], borne: wp.array[real],
    ):  # fmt: skip
        i = wp.tid()
        shear = q[i] / wp.sqrt(real(3.0))
        tau = mat(real(0.0), shear, real(0.0), shear, real(0.0), real(0.0), real(0.0), real(0.0), real(0.0))
        torn[i] = tension(table[0], D[i], p[i])
        grown[i] = growth(table[0], D[i], d_ep[i], rate[i], T[i], p[i], tau)
        borne[i] = pressure(table[0], D[i], p[i])

    return sample


def evaluate(spec, material, D=0.0, d_ep=0.0, rate=0.0, T=300.0, p=0.0, q=1e9):
    """Damage after tension alone, damage after flow, and the pressure borne [Pa]."""
    columns = np.broadcast_arrays(*(np.atleast_1d(v) for v in (D, d_ep, rate, T, p, q)))
    n = len(columns[0])
    ins = [wp.array(v.astype(float), dtype=spec.real, device="cpu") for v in columns]
    outs = [wp.zeros(n, dtype=spec.real, device="cpu") for _ in range(3)]
    wp.launch(sampler(spec), n, [lib.pack([material], spec, "cpu"), *ins, *outs], device="cpu")
    return [values.numpy().astype(float) for values in outs]


def test_every_law_is_tested():
    tested = {material.damage_id for material in (SIC, PLATE, BRITTLE, lib.get("aluminium"))}
    assert tested == {DamageId.NONE, *LAWS} == set(DamageId)


def test_strain_to_failure_of_silicon_carbide(precision, eps):
    """0.8 (P + 0.75)/(99.75 + 0.75), P in GPa: a line, constant beyond."""
    p = np.array([0.0, 2.5e9, 10e9, 99.75e9, 200e9])
    _, grown, _ = evaluate(precision, SIC, d_ep=1e-3, p=p)
    np.testing.assert_allclose(1e-3 / grown, [0.00597, 0.02587, 0.08557, 0.8, 0.8], rtol=1e-3)
    np.testing.assert_allclose(1e-3 / grown, np.minimum(0.8 * (p + 0.75e9) / 100.5e9, 0.8), rtol=20 * eps)


def test_johnson_cook_strain_to_failure_by_hand(precision, eps):
    """4340 steel in shear, tension and compression, fast, hot; the plate of Young et al. knows the rate alone."""
    p, q = np.array([0.0, -0.5e9, 0.5e9, 0.0, 0.0]), 1e9
    rate, T = np.array([0.0, 0.0, 0.0, 1e4, 0.0]), np.array([300.0, 300.0, 300.0, 300.0, 1046.5])
    _, grown, _ = evaluate(precision, BRITTLE, d_ep=1e-2, p=p, q=q, rate=rate, T=T)
    expected = [
        3.49,
        0.05 + 3.44 * math.exp(-1.06),
        0.05 + 3.44 * math.exp(1.06),
        3.49 * (1.0 + 0.002 * math.log(1e4)),
        3.49 * 1.305,
    ]
    np.testing.assert_allclose(1e-2 / grown, expected, rtol=30 * eps)
    _, grown, _ = evaluate(
        precision, PLATE, d_ep=1e-2, p=[-1e9, 0.0, 5e9], rate=[0.5, 1e4, 1e4], T=[300, 300, 800]
    )
    fast = 0.45 * (1.0 + 0.0138 * math.log(1e4))
    np.testing.assert_allclose(1e-2 / grown, [0.45, fast, fast], rtol=20 * eps)


def test_damage_adds_up_stays_and_ends_at_one(precision, eps):
    for material in (SIC, PLATE, BRITTLE):
        still, _, _ = evaluate(precision, material, D=[0.0, 0.3, 1.0], p=1e9)
        np.testing.assert_allclose(still, [0.0, 0.3, 1.0], rtol=eps)
        _, grown, _ = evaluate(
            precision, material, D=[0.0, 0.3, 0.3, 1.0], d_ep=[1e-4, 1e-4, 100.0, 1e-4], p=1e9
        )
        assert 0.0 < grown[0] < 1.0 and grown[1] == pytest.approx(0.3 + grown[0], rel=30 * eps)
        assert grown[2] == grown[3] == 1.0


def test_extremes_give_finite_damage(precision):
    """At the very pressure of failure ε_f = 0; without shear stress the triaxiality is infinite."""
    p = np.array([-0.75e9, np.nextafter(np.float32(-0.75e9), np.float32(0)), 1e12, -1e12])
    for material in (SIC, PLATE, BRITTLE):
        for q in (0.0, 1e9):
            _, grown, _ = evaluate(precision, material, d_ep=1e-12, p=p, q=q)
            assert np.isfinite(grown).all() and (grown >= 0.0).all() and (grown <= 1.0).all()


def test_ceramic_fails_at_once_in_tension_alone(precision):
    p = np.array([-1e9, -0.75e9, -0.74e9, 1e9])
    torn, _, _ = evaluate(precision, SIC, D=0.2, p=p)
    np.testing.assert_allclose(torn, [1.0, 1.0, 0.2, 0.2], rtol=1e-6)
    for material in (PLATE, BRITTLE):
        np.testing.assert_allclose(evaluate(precision, material, D=0.2, p=p)[0], 0.2, rtol=1e-6)


def test_only_a_failed_ceramic_bears_no_tension(precision):
    p = np.array([-0.5e9, 0.5e9])
    for material, D, expected in (
        (SIC, 0.99, p),
        (SIC, 1.0, [0.0, 0.5e9]),
        (PLATE, 1.0, p),  # what a failed metal does is not decided by its damage law
    ):
        np.testing.assert_allclose(evaluate(precision, material, D=D, p=p)[2], expected, rtol=1e-6)


def stretched(strain, steps=1, spec=None, rate=1e5, **start):
    """SiC after the same logarithmic strain along every axis."""
    dt = abs(strain) / rate / steps
    return deform(math.copysign(rate, strain) * np.eye(3), dt, steps, material=SIC, spec=spec, **start)


def test_ceramic_pulled_apart_carries_nothing(precision):
    """K = 220 GPa: P = T = -0.75 GPa at a volume strain of 0.34 %; the shear stress goes with the pressure."""
    tau = 0.5e8 * np.array([[2.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    before = stretched(0.001, tau=tau, spec=precision)
    assert before["D"] == 0.0 and before["p"] == pytest.approx(-0.66e9, rel=0.01) and before["tau"].any()
    after = stretched(0.0012, tau=tau, spec=precision)
    assert after["D"] == 1.0 and after["p"] == 0.0
    assert not after["tau"].any() and not after["sig"].any()
    assert after["cs"] > 0.0 and np.isfinite(after["ep"])


def test_crushed_ceramic_keeps_friction_alone(precision, eps):
    """Sheared under pressure: intact strength until D = 1, in that very step no more than the failed strength."""
    squeeze, shear = 0.05, np.diag([0.02, -0.02, 0.0])
    damage, stress, plastic = [], [], []
    state = {}
    for _ in range(30):
        L = (shear - squeeze / 3.0 * np.eye(3)) if not state else shear
        state = deform(1e6 * L, 1e-7, 1, material=SIC, spec=precision, state=state)
        damage.append(float(state["D"]))
        stress.append(math.sqrt(1.5 * float((state["tau"].astype(float) ** 2).sum())))
        plastic.append(float(state["ep"]))
    damage, stress, plastic = map(np.array, (damage, stress, plastic))
    pressure = float(state["p"])
    assert pressure == pytest.approx(1.1e9, rel=0.05)
    assert (np.diff(damage) >= 0.0).all() and damage[-1] == 1.0 and 0.0 < damage[np.argmax(damage > 0)] < 1.0
    intact = 7.1e9 * (pressure + 0.75e9) / 3.25e9
    rates = np.diff(plastic) / 1e-7
    factor = 1.0 + 0.009 * np.log(np.maximum(rates, 1.0))
    flowing = (np.diff(plastic) > 0.0) & (damage[1:] < 1.0)
    assert flowing.sum() >= 2
    np.testing.assert_allclose(stress[1:][flowing], (intact * factor)[flowing], rtol=2e-4 + 1e4 * eps)
    failed = damage[1:] == 1.0
    np.testing.assert_allclose(stress[1:][failed], (0.4 * pressure * factor)[failed], rtol=2e-4 + 1e4 * eps)
    apart = deform(1e4 * np.eye(3), 1e-7, 10, material=SIC, spec=precision, state=state)
    assert apart["p"] == 0.0 and not apart["tau"].any() and apart["D"] == 1.0


def test_silicon_carbide_has_its_elastic_limit():
    """Uniaxial strain, slow (rate factor 1): HEL 11.539 GPa at 5.463 GPa and 3291.82 kg/m³ (1D reference solution)."""

    def compressed(strain):
        return deform(np.diag([-strain, 0.0, 0.0]), 1.0, 1, dim=1, material=SIC)

    low, high = 0.0, 0.05
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if compressed(middle)["ep"] > 0.0 else (middle, high)
    limit = compressed(low)
    assert -limit["sig"][0, 0] == pytest.approx(11.539e9, rel=1e-4)
    assert limit["p"] == pytest.approx(5.463e9, rel=2e-4)
    assert limit["rho"] == pytest.approx(3291.82, rel=1e-5)


def test_damaged_metal_keeps_its_strength(precision):
    """D is reported and capped; it changes no stress."""
    undamaged = lib.Material("whole", PLATE.density, PLATE.eos, PLATE.strength, PLATE.pressure_cutoff)
    L = 1e5 * np.diag([1.0, -1.0, 0.0])
    found, expected = (
        deform(L, 1e-7, 100, material=material, spec=precision) for material in (PLATE, undamaged)
    )
    assert found["D"] == 1.0 and expected["D"] == 0.0
    for name in ("tau", "p", "ep", "T"):
        np.testing.assert_array_equal(found[name], expected[name])


COMPRESSION = lib.Material(
    "failing",
    PLATE.density,
    PLATE.eos,
    PLATE.strength,
    PLATE.pressure_cutoff,
    lib.JohnsonCookDamage(D1=0.45, D4=0.0138, carries="compression"),
)
"""The plate, if a failed particle carries compression only."""


def test_a_failed_metal_may_carry_compression_only(precision):
    """Neither shear nor tension from the step on in which it fails; until then no difference, and none in compression."""
    shear, apart, together = 1e5 * np.diag([1.0, -1.0, 0.0]), 1e4 * np.eye(3), -1e4 * np.eye(3)
    whole, early = (deform(shear, 1e-7, 10, material=m, spec=precision) for m in (PLATE, COMPRESSION))
    assert early["D"] < 1.0
    for name in ("tau", "p", "ep", "T", "D"):
        np.testing.assert_array_equal(early[name], whole[name])
    failed, intact = (deform(shear, 1e-7, 100, material=m, spec=precision) for m in (COMPRESSION, PLATE))
    assert failed["D"] == intact["D"] == 1.0
    assert not failed["tau"].any() and np.abs(intact["tau"]).max() > 1e8
    for L, carried in ((apart, False), (together, True)):
        loose, held = (
            deform(L, 1e-8, 20, material=m, spec=precision, state=state)
            for m, state in ((COMPRESSION, failed), (PLATE, intact))
        )
        assert (abs(held["p"]) > 1e8) and np.abs(held["tau"]).max() > 1e8
        assert not loose["tau"].any()
        assert loose["p"] == (pytest.approx(float(held["p"]), rel=1e-4) if carried else 0.0)
        assert loose["cl"] > 0.0


def test_it_fails_within_one_step_to_nothing(precision):
    """A step in which D reaches 1 leaves no shear behind, as in a ceramic."""
    state = deform(1e5 * np.diag([1.0, -1.0, 0.0]), 1e-5, 1, material=COMPRESSION, spec=precision)
    assert state["D"] == 1.0 and not state["tau"].any() and np.isfinite(state["ep"])


def test_plate_fails_at_its_strain(precision):
    """D = Σ Δεp/ε_f with ε_f = 0.45 (1 + 0.0138 ln ε̇)."""
    L = 1e5 * np.diag([1.0, -1.0, 0.0])
    state = deform(L, 1e-8, 200, material=PLATE, spec=precision)
    expected = state["ep"] / (0.45 * (1.0 + 0.0138 * math.log(2e5 / math.sqrt(3.0))))
    assert 0.002 < state["D"] < 1.0
    assert state["D"] == pytest.approx(expected, rel=2e-2)
