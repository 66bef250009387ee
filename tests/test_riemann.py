"""Riemann solvers: exact solutions, a bisection of the two curves, and the same state seen from both sides."""

import functools
import math

import numpy as np
import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.kernels.interface import make_interface
from warpsph.kernels.riemann import SOLVERS, make_riemann, make_riemann_state
from warpsph.kernels.spec import Spec

DOUBLE = Spec(3, wp.float64)
U, P, RHO, C, A = range(5)
SHOCKS = {
    "aluminium": (2785.0, 5328.0, 1.338),
    "copper": (8930.0, 3940.0, 1.489),
    "beryllium": (1845.0, 12870.0, 1.124),
    "steel": (7903.0, 4552.0, 1.4933),
}
"""Density [kg/m³], c0 [m/s] and S of Us = c0 + S up."""


@functools.cache
def sampler(spec, name):
    real, State, solve = spec.real, make_riemann_state(spec), make_riemann(spec, name)

    @wp.func
    def read(values: wp.array2d[real], i: wp.int32):
        state = State()
        state.u = values[i, 0]
        state.p = values[i, 1]
        state.rho = values[i, 2]
        state.c = values[i, 3]
        state.A = values[i, 4]
        return state

    @wp.kernel(module="unique", enable_backward=False)
    def sample(
        left: wp.array2d[real], right: wp.array2d[real], star: wp.array2d[real]
    ):  # fmt: skip
        i = wp.tid()
        u, p = solve(read(left, i), read(right, i))
        star[i, 0] = u
        star[i, 1] = p

    return sample


def star(spec, name, left, right, device="cpu"):
    """u* and p* for rows of states (u, p, ρ, c, A)."""
    left, right = np.atleast_2d(left), np.atleast_2d(right)
    ins = [wp.array(values, dtype=spec.real, device=device) for values in (left, right)]
    out = wp.zeros((len(left), 2), dtype=spec.real, device=device)
    wp.launch(sampler(spec, name), len(left), [*ins, out], device=device)
    return out.numpy().astype(np.float64).T


def states(n, real=np.float64, seed=0):
    """Random states whose two sides are of any ratio: strong shocks as well as expansions beyond the vertices."""
    rng = np.random.default_rng(seed)
    sides = []
    for _ in range(2):
        rho, c = (10.0 ** rng.uniform(-1.0, 1.0, n) for _ in range(2))
        jump = 10.0 ** rng.uniform(-4.0, 1.0, n) * rng.normal(size=n)
        sides.append(np.stack([jump, rho * c**2 * jump, rho, c, rng.uniform(0.5, 2.5, n)], axis=1))
    return [side.astype(real).astype(np.float64) for side in sides]


def curve(side, w):
    """Pressure behind a wave of velocity jump w, as in Dukowicz: the parabola about its vertex, turned over there."""
    vertex = side[:, C] / (2.0 * side[:, A])
    lowest = side[:, P] - 0.5 * side[:, RHO] * side[:, C] * vertex
    return lowest + side[:, RHO] * side[:, A] * np.abs(w + vertex) * (w + vertex)


def bisection(left, right):
    """u* and p* where the two curves cross; both are monotone, so there is one place.

    In long double: about its vertex a curve loses the digits of weak waves.
    """
    left, right = left.astype(np.longdouble), right.astype(np.longdouble)

    def gap(u):
        return curve(right, u - right[:, U]) - curve(left, left[:, U] - u)

    middle, half = 0.5 * (left[:, U] + right[:, U]), 0.5 * np.abs(left[:, U] - right[:, U])
    half += sum(side[:, C] / side[:, A] for side in (left, right))
    half += np.sqrt(
        np.abs(left[:, P] - right[:, P]) / np.minimum(*(side[:, RHO] * side[:, A] for side in (left, right)))
    )
    low, high = middle - half, middle + half
    assert (gap(low) <= 0.0).all() and (gap(high) >= 0.0).all()
    for _ in range(130):
        u = 0.5 * (low + high)
        below = gap(u) < 0.0
        low, high = np.where(below, u, low), np.where(below, high, u)
    return u, 0.5 * (curve(right, u - right[:, U]) + curve(left, left[:, U] - u))


def scales(left, right):
    """Velocities and pressures against which the rounding of u* and p* is to be seen."""
    jump = np.abs(left[:, U] - right[:, U])
    u = np.max([np.abs(s[:, U]) for s in (left, right)], axis=0)
    p = np.max(
        [np.abs(s[:, P]) + s[:, RHO] * (s[:, C] + s[:, A] * jump) * jump for s in (left, right)], axis=0
    )
    return u + p / np.min([s[:, RHO] * s[:, C] for s in (left, right)], axis=0), p


def swapped(left, right):
    """The same problem seen from the other side."""
    turn = np.array([-1.0, 1.0, 1.0, 1.0, 1.0])
    return right * turn, left * turn


@pytest.mark.parametrize("name", SOLVERS)
def test_both_orders_of_a_pair_give_the_same_state(name, precision, eps, device):
    """What conserves momentum and energy: the pair's two threads must find one u* and one p*."""
    left, right = states(5000, wp.dtype_to_numpy(precision.real))
    u, p = star(precision, name, left, right, device)
    u_back, p_back = star(precision, name, *swapped(left, right), device)
    u_scale, p_scale = scales(left, right)
    assert (np.abs(u + u_back) < 30 * eps * u_scale).all()
    assert (np.abs(p - p_back) < 30 * eps * p_scale).all()


@pytest.mark.parametrize("name", SOLVERS)
def test_a_contact_stays(name, precision, eps):
    """Equal velocities and pressures: nothing happens, whatever the materials."""
    left, right = states(1000, wp.dtype_to_numpy(precision.real))
    right[:, [U, P]] = left[:, [U, P]]
    u, p = star(precision, name, left, right)
    np.testing.assert_allclose(u, left[:, U], rtol=4 * eps)
    np.testing.assert_allclose(p, left[:, P], rtol=4 * eps)


def test_acoustic_waves_keep_their_invariants(precision, eps):
    """p + Z u stays on the way from the left, p - Z u on the way from the right."""
    left, right = states(1000, wp.dtype_to_numpy(precision.real))
    u, p = star(precision, "acoustic", left, right)
    for side, sign in ((left, 1.0), (right, -1.0)):
        Z = sign * side[:, RHO] * side[:, C]
        scale = np.abs(p) + np.abs(Z) * (np.abs(u) + np.abs(side[:, U])) + np.abs(side[:, P])
        worst = np.abs(p + Z * u - side[:, P] - Z * side[:, U]) / (scale + scales(left, right)[1])
        assert worst.max() < 10 * eps


def test_halves_of_an_elastic_bar(precision, eps):
    """Two halves of aluminium that meet with 10 m/s: σ* = -89.815101737 MPa at their face."""
    rho, c = 2785.0, math.sqrt((79.06e9 + 4.0 / 3.0 * 27.6e9) / 2785.0)
    u, p = star(precision, "acoustic", [5.0, 0.0, rho, c, 1.0], [-5.0, 0.0, rho, c, 1.0])
    assert p[0] == pytest.approx(89815101.73684601, rel=4 * eps)
    assert u[0] == 0.0


@pytest.mark.parametrize("size", [1e-2, 1e-4, 1e-6])
def test_weak_waves_are_acoustic(size):
    """The two solvers differ by A w/c of the stronger wave's jump w, and no more."""
    left, right = states(1000)
    rng = np.random.default_rng(1)
    for side in (left, right):
        side[:, U] = size * rng.normal(size=1000)
        side[:, P] = size * side[:, RHO] * side[:, C] * rng.normal(size=1000)
    (u, p), (u_weak, p_weak) = (star(DOUBLE, name, left, right) for name in ("two-shock", "acoustic"))
    jump = np.max([np.abs(u_weak - s[:, U]) for s in (left, right)], axis=0)
    strength = jump * np.max([s[:, A] / s[:, C] for s in (left, right)], axis=0)
    Z = np.max([s[:, RHO] * s[:, C] for s in (left, right)], axis=0)
    weak = strength < 0.1
    assert weak.mean() > 0.5
    assert (np.abs(u - u_weak) < 1.5 * strength * jump + 1e-15 * size)[weak].all()
    assert (np.abs(p - p_weak) < 3.0 * strength * Z * jump + 1e-15 * size * Z)[weak].all()


def test_two_shock_equals_the_bisection_of_its_curves(precision, eps, device):
    """Any jump: two shocks, a shock and an expansion, two expansions, each also beyond the vertex of its curve."""
    left, right = states(4000, wp.dtype_to_numpy(precision.real))
    u, p = bisection(left, right)
    shares = [
        np.mean(w < -s[:, C] / (2 * s[:, A])) for s, w in ((left, left[:, U] - u), (right, u - right[:, U]))
    ]
    assert min(shares) > 0.1, "strong expansions are among them"
    found_u, found_p = star(precision, "two-shock", left, right, device)
    u_scale, p_scale = scales(left, right)
    np.testing.assert_array_less(np.abs(found_p - p) / p_scale, 30 * eps)
    # at a vertex a curve is flat, so that u* is only as good as the root of the rounding of p
    steep = np.max(
        [s[:, RHO] * np.abs(0.5 * s[:, C] + s[:, A] * w) for s, w in ((left, left[:, U] - u), (right, u - right[:, U]))],
        axis=0,
    )  # fmt: skip
    np.testing.assert_array_less(np.abs(found_u - u), 30 * eps * (u_scale + p_scale / steep))


def shocked(name, speed):
    """A material of `SHOCKS` at rest in its reference state, or in flight."""
    rho, c, S = SHOCKS[name]
    return np.array([speed, 0.0, rho, c, S])


def impedance_match(left, right):
    """u* and p* of ρ_l (c_l + S_l (v - u)) (v - u) = ρ_r (c_r + S_r u) u, the exact solution of two shocks."""
    v = left[U]
    a, b, Z_l, Z_r = left[RHO] * left[A], right[RHO] * right[A], left[RHO] * left[C], right[RHO] * right[C]
    k0, k1 = (Z_l + a * v) * v, Z_l + Z_r + 2.0 * a * v
    u = 2.0 * k0 / (k1 + math.sqrt(k1**2 + 4.0 * (b - a) * k0))
    return u, right[RHO] * (right[C] + right[A] * u) * u


@pytest.mark.parametrize(
    ("left", "right", "speed", "u_star", "p_star"),
    [
        ("aluminium", "aluminium", 3100.0, 1550.0, 31.952152e9),
        ("copper", "aluminium", 1000.0, 692.717837, 12.066989e9),
        ("steel", "beryllium", 800.0, 492.218367, 12.190232e9),
        ("aluminium", "copper", 20.0, 5.938058, 0.209395e9),
    ],
)
def test_shocks_into_the_reference_state_match_impedances(left, right, speed, u_star, p_star, precision, eps):
    """Us = c0 + S up is the whole Hugoniot: the two-shock solution is exact, the acoustic one up to 28 % low."""
    left, right = shocked(left, speed), shocked(right, 0.0)
    assert impedance_match(left, right) == (pytest.approx(u_star, abs=1e-6), pytest.approx(p_star, abs=1e3))
    u, p = star(precision, "two-shock", left, right)
    assert (u[0], p[0]) == pytest.approx(impedance_match(left, right), rel=10 * eps)
    assert star(precision, "acoustic", left, right)[1][0] < p[0]


def gas(u, p, rho=1.0, gamma=1.4):
    """A row of states of an ideal gas."""
    u, p = np.broadcast_arrays(np.asarray(u, float), p)
    A = 0.5 * (gamma + 1.0)
    return np.stack([u, p, np.full(u.shape, rho), np.sqrt(gamma * p / rho), np.full(u.shape, A)], axis=-1)


@pytest.mark.parametrize("gamma", [1.1, 1.4, 5.0 / 3.0])
def test_shocks_of_a_gas_are_within_the_known_error(gamma, precision, eps):
    """Gas against gas at ± u.

    Exact: Us = s/2 + sqrt((s/2)² + c²), s = A u; taken for it: c + s. The ratio is 1 for weak and for strong
    shocks, and at most 5/4, at s = 3/2 c.
    """
    c = math.sqrt(gamma)
    s = c * np.array([1e-3, 1e-2, 0.1, 0.5, 1.5, 5.0, 100.0, 1e4])
    speed = 2.0 * s / (gamma + 1.0)
    u, p = star(precision, "two-shock", gas(speed, 1.0, gamma=gamma), gas(-speed, 1.0, gamma=gamma))
    exact = 1.0 + speed * (0.5 * s + np.sqrt(0.25 * s**2 + c**2))
    np.testing.assert_allclose(u, 0.0, atol=4 * eps * speed.max())
    np.testing.assert_allclose(p, 1.0 + speed * (c + s), rtol=10 * eps)
    excess = (p - 1.0) / (exact - 1.0) - 1.0
    assert (excess > -20 * eps / speed).all() and excess.max() == pytest.approx(0.25, abs=20 * eps)
    assert excess[0] < 1e-3 and excess[-1] < 2e-4


def test_shocks_of_cold_gas_are_exact(precision, eps):
    """Without a sound speed p* = ρ A u², the exact pressure of an infinitely strong shock; A = (γ + 1)/2."""
    side = gas([1.0, -1.0], 0.0, gamma=5.0 / 3.0)
    side[:, C] = 1e-6  # its floor
    u, p = star(precision, "two-shock", side[0], side[1])
    assert abs(u[0]) < eps and p[0] == pytest.approx(4.0 / 3.0, rel=2e-6)
    for left, right in ((side[0], side[0]), (side[1], side[0])):  # at rest to each other, and receding
        u, p = star(precision, "two-shock", left, right)
        assert np.isfinite(u) and np.isfinite(p) and p[0] <= 0.0


@pytest.mark.parametrize(
    "eos",
    [
        lib.IsothermalMieGrueneisen(c0=5000.0, S1=0.0),
        lib.ShockMieGrueneisen(c0=5000.0, S1=0.0, Gamma0=2.0),
        lib.Polynomial(k1=7e10, k2=-2e11),
    ],
)
def test_a_material_that_does_not_stiffen_is_acoustic(eos, precision):
    """A shock slope of 0 or less has no vertex: it is held just above."""
    row = lib.pack([lib.Material("soft", 2700.0, eos, lib.Fluid())], precision, "cpu").numpy()
    A = float(row["A_shock"][0])
    assert 0.0 < A < 0.01
    for speed in (10.0, -10.0):
        pair = [np.array([s * speed, 1e9, 2700.0, 5000.0, A]) for s in (1.0, -1.0)]
        found, weak = (star(precision, name, *pair) for name in ("two-shock", "acoustic"))
        np.testing.assert_allclose(found[1], weak[1], rtol=1e-4)


@pytest.mark.parametrize(("bears", "lowest"), [(True, -np.inf), (False, 0.0)])
def test_an_interface_that_bears_no_tension(bears, lowest):
    real = DOUBLE.real
    side, interface = make_interface(DOUBLE, "two-shock")

    @wp.func
    def made(values: wp.array[real]):
        return side(values[0], values[1], values[2], values[3], values[4])

    @wp.kernel(module="unique", enable_backward=False)
    def sample(left: wp.array[real], right: wp.array[real], whole: wp.bool, out: wp.array[real]):
        u, p = interface(made(left), made(right), whole)
        out[0] = u
        out[1] = p

    for speed in (-10.0, 10.0):
        pair = [shocked("aluminium", s * speed) for s in (1.0, -1.0)]
        found = wp.zeros(2, dtype=real, device="cpu")
        wp.launch(
            sample, 1, [*(wp.array(s, dtype=real, device="cpu") for s in pair), bears, found], device="cpu"
        )
        u, p = star(DOUBLE, "two-shock", *pair)
        np.testing.assert_array_equal(found.numpy(), [u[0], max(p[0], lowest)])
