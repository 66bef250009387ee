import functools
import math

import numpy as np
import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.kernels.eos import MODELS, make_eos
from warpsph.kernels.material import make_material
from warpsph.kernels.spec import Spec

DOUBLE = Spec(3, wp.float64)
SOLID = lib.Elastic(G=1e10)
MATERIALS = {
    "linear": lib.Material("linear", 7870.0, lib.LinearElastic(K=1.6e11), SOLID),
    "stiffened": lib.Material("stiffened", 2785.0, lib.StiffenedGas(c0=5328.0, gamma0=2.0), SOLID),
    "isothermal": lib.Material("isothermal", 6100.0, lib.IsothermalMieGrueneisen(c0=5077.0, S1=1.201), SOLID),
    "shock": lib.Material("shock", 1845.0, lib.ShockMieGrueneisen(c0=12870.0, S1=1.124, Gamma0=2.0), SOLID),
    "cubic": lib.Material(
        "cubic",
        2870.0,
        lib.CubicGrueneisen(c0=5328.0, S1=1.338, S2=0.2, S3=-0.1, Gamma0=2.0, a=0.48),
        SOLID,
    ),
    "polynomial": lib.Material(
        "polynomial", 3215.0, lib.Polynomial(k1=220e9, k2=361e9, k3=50e9, B0=1.2, B1=0.6), SOLID
    ),
    "gas": lib.Material("gas", 1.225, lib.IdealGas(gamma=1.4), lib.Fluid()),
}
SOLIDS = [name for name in MATERIALS if name != "gas"]
SHOCKS = ["isothermal", "shock", "cubic"]


@functools.cache
def sampler(spec):
    real, Material, eos = spec.real, make_material(spec), make_eos(spec)

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        table: wp.array[Material], rho: wp.array[real], e: wp.array[real],
        p: wp.array[real], c: wp.array[real], out: wp.array[wp.int32],
    ):  # fmt: skip
        i = wp.tid()
        p_i, c_i, out_i = eos(table[0], rho[i], e[i])
        p[i] = p_i
        c[i] = c_i
        out[i] = out_i

    return sample


def evaluate(spec, material, rho, e, device="cpu"):
    rho, e = np.broadcast_arrays(np.asarray(rho, float), np.asarray(e, float))
    real, n = spec.real, rho.size
    ins = [wp.array(values.ravel(), dtype=real, device=device) for values in (rho, e)]
    outs = [wp.zeros(n, dtype=dtype, device=device) for dtype in (real, real, wp.int32)]
    wp.launch(sampler(spec), n, [lib.pack([material], spec, device), *ins, *outs], device=device)
    return [values.numpy().astype(np.float64).reshape(rho.shape) for values in outs]


def states(material):
    """A grid of (rho, e) inside every law's range: tension, rest, compression; cold to hot."""
    if isinstance(material.eos, lib.IdealGas):
        return np.meshgrid([0.1, 1.0, 5.0], [1.0, 1e3, 3e5])
    heat = 0.05 * material.bulk_speed**2
    return np.meshgrid(material.density * np.array([0.8, 0.97, 1.02, 1.1, 1.4]), [-0.02 * heat, 0.0, heat])


def test_every_model_is_tested():
    assert {material.eos.id for material in MATERIALS.values()} == set(MODELS)


@pytest.mark.parametrize("name", MATERIALS)
def test_sound_speed_is_the_isentropic_derivative(name, precision, eps, device):
    material = MATERIALS[name]
    rho, e = states(material)
    p, c, out = evaluate(precision, material, rho, e, device)
    assert not out.any()
    # the derivative along the isentrope de = p/rho^2 drho, always in double precision
    p0 = evaluate(DOUBLE, material, rho, e)[0]
    step = 1e-5 * rho
    above, below = (evaluate(DOUBLE, material, rho + s, e + p0 / rho**2 * s)[0] for s in (step, -step))
    np.testing.assert_allclose(
        p, p0, rtol=30 * eps, atol=100 * eps * material.density * material.bulk_speed**2
    )
    np.testing.assert_allclose(c**2, (above - below) / (2 * step), rtol=1e-7 + 200 * eps)


@pytest.mark.parametrize("name", MATERIALS)
def test_reference_state_has_no_pressure(name, precision, eps):
    material = MATERIALS[name]
    p, c, out = evaluate(precision, material, [material.density], [0.0])
    assert p[0] == 0.0
    assert out[0] == 0
    assert c[0] == pytest.approx(material.bulk_speed, rel=10 * eps, abs=1.1e-6)


def test_pressures_worked_out_by_hand():
    p = {name: evaluate(DOUBLE, MATERIALS[name], 1.1 * MATERIALS[name].density, 1e5)[0] for name in MATERIALS}
    D = 1 - 0.124 * 0.1
    assert p["linear"] == pytest.approx(1.6e10)
    assert p["stiffened"] == pytest.approx(5328.0**2 * 278.5 + 1.1 * 2785.0 * 1e5)
    assert p["isothermal"] == pytest.approx(6100.0 * 5077.0**2 * 0.1 / (1 - 0.201 * 0.1))
    assert p["shock"] == pytest.approx(1845.0 * (12870.0**2 * 0.1 / D**2 + 2e5))
    assert p["polynomial"] == pytest.approx(22e9 + 3.61e9 + 5e7 + 1.26 * 3215.0 * 1e5)
    assert p["gas"] == pytest.approx(0.4 * 1.1 * 1.225 * 1e5)


def test_hugoniot_of_the_shock_forms_is_linear():
    """A shock of particle speed u has p = ρ0 (c0 + S1 u) u by construction; here the cubic form equals the shock form."""
    c0, S1, rho0, u = 5328.0, 1.338, 2785.0, 1550.0
    Us = c0 + S1 * u
    shock = lib.Material("s", rho0, lib.ShockMieGrueneisen(c0=c0, S1=S1, Gamma0=2.0), SOLID)
    cubic = lib.Material("c", rho0, lib.CubicGrueneisen(c0=c0, S1=S1, Gamma0=2.0), SOLID)
    for material in (shock, cubic):
        assert evaluate(DOUBLE, material, rho0 * Us / (Us - u), u**2 / 2)[0] == pytest.approx(rho0 * Us * u)


def test_flyer_reproduces_the_exact_star_state():
    """Behind the plastic shock of the flyer problem (1D reference solution): 6440.27 kg/m³ and 8.8701 GPa."""
    assert evaluate(DOUBLE, lib.get("flyer"), 6440.27, 0.0)[0] == pytest.approx(8.8701e9, rel=1e-4)


@pytest.mark.parametrize("name", MATERIALS)
def test_out_of_range_is_finite_and_flagged(name, precision, device):
    material = MATERIALS[name]
    rho = material.density * np.array([-1.0, 0.0])
    p, c, out = evaluate(precision, material, rho, [0.0, 0.0], device)
    assert np.isfinite(p).all() and np.isfinite(c).all()
    assert (c > 0.0).all()
    assert (out == 1).all()


@pytest.mark.parametrize("name", SHOCKS)
def test_beyond_the_shock_limit_is_finite_and_flagged(name, precision):
    material = MATERIALS[name]
    eta = material.eos.S1 / (material.eos.S1 - 1) if name != "cubic" else 4.0
    p, c, out = evaluate(precision, material, material.density * np.array([0.999, 1.0, 1.5, 50.0]) * eta, 0.0)
    assert np.isfinite(p).all() and np.isfinite(c).all()
    assert (c > 0.0).all()
    assert (out[1:] == 1).all()
    if name != "cubic":  # whose numerator turns negative at twice the reference density and more
        assert (np.diff(p) > 0.0).all()


@pytest.mark.parametrize("name", ["stiffened", "gas"])
def test_imaginary_sound_speed_is_floored_and_flagged(name, precision, eps):
    material = MATERIALS[name]
    p, c, out = evaluate(precision, material, [0.3 * material.density], [-1.0])
    floor = 1e-3 * material.bulk_speed or 1e-6
    assert out[0] == 1
    assert c[0] == pytest.approx(floor, rel=4 * eps)
    assert math.isfinite(p[0])


def test_cold_gas_is_in_range(precision):
    p, c, out = evaluate(precision, MATERIALS["gas"], [1.0], [0.0])
    assert (p[0], out[0]) == (0.0, 0)
    assert 0.0 < c[0] < 1e-5


@pytest.mark.parametrize("name", MATERIALS)
def test_not_a_number_is_not_hidden(name, precision):
    p, _, _ = evaluate(precision, MATERIALS[name], [math.nan], [0.0])
    assert math.isnan(p[0])


@pytest.mark.parametrize("name", SOLIDS)
def test_shock_slope_is_that_of_a_weak_shock(name):
    """A = (Us - c)/u on the Hugoniot of the device's own law, extrapolated to no strength."""
    material = MATERIALS[name]
    rho0, slopes = material.density, []
    for zeta in (2e-3, 1e-3):
        rho, e = rho0 * (1.0 + zeta), 0.0
        lost = 1.0 / rho0 - 1.0 / rho
        for _ in range(20):
            p = evaluate(DOUBLE, material, [rho], [e])[0][0]
            e = 0.5 * p * lost
        Us, u = math.sqrt(p / lost) / rho0, math.sqrt(p * lost)
        slopes.append((Us - material.bulk_speed) / u)
    assert 2.0 * slopes[1] - slopes[0] == pytest.approx(material.eos.shock_slope(rho0), rel=1e-4)


def test_shock_slope_of_a_cold_gas_is_exact():
    gas, u = MATERIALS["gas"], 100.0
    Us = gas.eos.shock_slope(gas.density) * u
    p = evaluate(DOUBLE, gas, [gas.density * Us / (Us - u)], [0.5 * u * u])[0][0]
    assert p == pytest.approx(gas.density * Us * u)
