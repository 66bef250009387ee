"""Godunov schemes: the pair sums against an independent one, what they conserve, and what they leave exact."""

import math

import numpy as np
import pytest
from tools import DENSITY, ELASTIC, FLUID, REALS, SPACING, G, K, by_id, jittered, overwrite, scene

from warpsph import materials as lib
from warpsph.schemes import SCHEMES, GodunovSettings
from warpsph.shapes import Box
from warpsph.solver import Solver

EPS = {"float64": 2.2e-16, "float32": 1.2e-7}
H = 1.2 * SPACING
C, CL, CT = (math.sqrt(M / DENSITY) for M in (K, K + 4.0 * G / 3.0, G))
STABLE = 0.3 * H / CL
SIZE = {1: 24, 2: 7, 3: 4}
FAMILIES = ("pm", "ts1", "ts2")
ALL = (*FAMILIES, *(f"{name}-mixed" for name in FAMILIES))


def random_state(dim, seed=0):
    """Jittered particles of two materials with random velocities, stresses, densities, energies and sound speeds.

    Returns:
        Particle fields by name, [n], [n, 3] and [n, 3, 3], and the indices of the second material's particles.
    """
    rng = np.random.default_rng(seed)
    x = jittered(dim, SIZE[dim], 0.2, seed)
    n, fluid = len(x), x[:, 0] > 0.55 * x[:, 0].max()
    v = np.where(np.arange(3) < dim, rng.normal(size=(n, 3)), 0.0) * 100.0
    tau = rng.normal(size=(n, 3, 3)) * 1e9
    tau = 0.5 * (tau + tau.swapaxes(1, 2))
    for axis in range(dim, 3):  # no shear out of a line or a plane
        tau[:, axis, :axis] = tau[:, :axis, axis] = 0.0
    tau -= np.trace(tau, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    tau[fluid] = 0.0
    rho = np.where(fluid, FLUID.density, DENSITY) * rng.uniform(0.9, 1.1, n)
    cs = np.where(fluid, FLUID.bulk_speed, C) * rng.uniform(0.9, 1.1, n)
    fields = {"x": x, "v": v, "rho": rho, "e": rng.uniform(0.0, 1e4, n), "tau": tau, "cs": cs}
    fields["p"] = rng.normal(size=n) * 1e9
    fields["cl"] = np.sqrt(cs**2 + np.where(fluid, 0.0, 4.0 / 3.0 * G / rho))
    return fields, fluid


def solver_of(dim, scheme, fields, second=None, precision="float64", first=ELASTIC, **numerics):
    """Solver in a given state; ``second`` tells which particles are of the fluid."""
    made = scene(dim, scheme=scheme, **numerics)
    second = np.zeros(len(fields["x"]), dtype=bool) if second is None else second
    order = np.concatenate([np.flatnonzero(~second), np.flatnonzero(second)])
    made.add_body("solid", fields["x"][~second], first)
    if second.any():
        made.add_body("fluid", fields["x"][second], FLUID)
    solver = Solver(made.finalize(), precision=precision)
    solver.order = order
    values = {name: np.asarray(array)[order] for name, array in fields.items()}
    values.setdefault("rho", by_id(solver, "rho"))
    values["vol"] = by_id(solver, "m") / values["rho"]
    zero = np.zeros((len(order), 3, 3))
    values["sig"] = values.get("tau", zero) - values.get("p", zero[:, 0, 0])[:, None, None] * np.eye(3)
    overwrite(solver, **values)
    return solver


def step(solver, dt):
    """One step of any length [s], stable or not."""
    solver._clock.dt.fill_(dt)
    for command in solver._scheme.step(solver._bind):
        command()
    solver._clock.dt.fill_(0.0)
    return solver


def probe(solver, dt):
    """Pair sums without a step."""
    solver._clock.dt.fill_(dt)
    for command in solver._scheme.probe(solver._bind):
        command()
    solver._clock.dt.fill_(0.0)
    return solver


def of(solver, name):
    """A field, or an array of the scheme, in the order of the state that was given."""
    if hasattr(solver.particles, name):
        values = by_id(solver, name)
    else:
        values = getattr(solver._work, name).numpy()[np.argsort(solver.particles.id.numpy())]
    return values[np.argsort(solver.order)].astype(np.float64)


def pairs(x):
    """Every ordered pair within the support: a, b, the unit vector e from b to a, r and dW/dr of the cubic spline."""
    dim = 3 if np.ptp(x[:, 2]) else 2 if np.ptp(x[:, 1]) else 1
    sigma = {1: 2 / 3, 2: 10 / (7 * math.pi), 3: 1 / math.pi}[dim] / H ** (dim + 1)
    for a in range(len(x)):
        for b in range(len(x)):
            r = np.linalg.norm(x[a] - x[b])
            if a != b and r < 2.0 * H:
                q = r / H
                slope = -3.0 * q + 2.25 * q**2 if q < 1.0 else -0.75 * (2.0 - q) ** 2
                yield a, b, (x[a] - x[b]) / r, r, sigma * slope


def frame(e, dim):
    """Orthonormal R, S, T with R along e; those that move in the problem."""
    if dim == 1:
        return [e]
    S = np.cross([0.0, 0.0, 1.0], e) if dim == 2 else np.cross(e, np.array([0.3, -0.2, 0.9]))
    S /= np.linalg.norm(S)
    return [e, S, np.cross(e, S)][:dim]


def acoustic(Z_l, u_l, s_l, Z_r, u_r, s_r):
    """u* and σ* of a linear wave problem; without impedance on either side nothing is passed on."""
    if Z_l + Z_r == 0.0:
        return 0.5 * (u_l + u_r), 0.0
    return (
        (Z_l * u_l + Z_r * u_r + s_r - s_l) / (Z_l + Z_r),
        (Z_r * s_l + Z_l * s_r + Z_l * Z_r * (u_r - u_l)) / (Z_l + Z_r),
    )


def reference_pm(dim, s, m, shear):
    """dv/dt, de/dt and L of section 10, each wave in the rotated frame."""
    n = len(m)
    dvdt, dedt, L = np.zeros((n, 3)), np.zeros(n), np.zeros((n, 3, 3))
    sig = s["tau"] - s["p"][:, None, None] * np.eye(3)
    for a, b, e, _, dW in pairs(s["x"]):
        v, t = np.zeros(3), np.zeros(3)
        for k, axis in enumerate(frame(e, dim)):
            c = s["cl"] if k == 0 else np.sqrt(shear / s["rho"])
            sides = [(s["rho"][i] * c[i], s["v"][i] @ axis, axis @ sig[i] @ e) for i in (b, a)]
            v_k, t_k = acoustic(*sides[0], *sides[1])
            v, t = v + v_k * axis, t + t_k * axis
        f = 2.0 * m[b] / (s["rho"][a] * s["rho"][b]) * t * dW
        dvdt[a] += f
        dedt[a] += f @ (v - s["v"][a])
        L[a] += 2.0 * m[b] / s["rho"][b] * np.outer(v - s["v"][a], dW * e)
    return dvdt, dedt, L


def superbee(r):
    return max(0.0, min(2.0 * r, 1.0), min(r, 2.0))


def reference_ts(s, m, dt, order):
    """v', e' and ρ' after both stages of section 10, with Riemann problems on v before them, and L of v'."""
    n, rho, x = len(m), s["rho"], s["x"]
    A, B, grads = np.zeros((n, 3)), np.zeros(n), {"p": np.zeros((n, 3)), "rho": np.zeros((n, 3))}
    for a, b, e, _, dW in pairs(x):
        f = m[b] / (rho[a] * rho[b]) * (s["tau"][a] + s["tau"][b]) @ e * dW
        A[a] += f
        B[a] += f @ (s["v"][a] + s["v"][b]) / 2.0
        for name, grad in grads.items():
            grad[a] += m[b] / rho[b] * (s[name][b] - s[name][a]) * dW * e

    def kick(v, u):
        return v + dt * A, u + dt * (B - np.sum(A * (v + 0.5 * dt * A), axis=1))

    def gradient(v):
        L = np.zeros((n, 3, 3))
        for a, b, e, _, dW in pairs(x):
            L[a] += m[b] / rho[b] * np.outer(v[b] - v[a], dW * e)
        return L

    v, u = kick(s["v"], s["e"])
    L = gradient(s["v"])
    A, B, div = np.zeros((n, 3)), np.zeros(n), np.zeros(n)
    for a, b, e, r, dW in pairs(x):
        states = {}
        for i, sign in ((b, 1.0), (a, -1.0)):
            values = {"u": s["v"][i] @ e, "p": s["p"][i], "rho": rho[i]}
            if order == 2:
                slopes = [
                    {"u": e @ L[k] @ e, "p": grads["p"][k] @ e, "rho": grads["rho"][k] @ e}
                    for k in ((a, b) if i == a else (b, a))
                ]
                for name in values:
                    own, other = slopes[0][name], slopes[1][name]
                    phi = superbee(other / own) if own != 0.0 else 0.0
                    over, swept = r * phi * own, s["cl"][i] * dt / r
                    arrives = over
                    if name == "u":  # only what changes the volume
                        dilation = 0.5 * r * (np.trace(L[a]) + np.trace(L[b]))
                        arrives = np.clip(dilation, min(over, 0.0), max(over, 0.0))
                    values[name] += sign * 0.5 * (over - swept * arrives)
            states[i] = (values["rho"] * s["cs"][i], values["u"], -values["p"])
        u_star, s_star = acoustic(*states[b], *states[a])
        f = 2.0 * m[b] / (rho[a] * rho[b]) * s_star * dW * e
        A[a] += f
        B[a] += f @ e * u_star
        div[a] += 2.0 * m[b] / rho[b] * (u_star - s["v"][a] @ e) * dW
    v, u = kick(v, u)
    return v, u, rho * np.exp(-dt * div), gradient(v)


def assert_close(found, expected, tolerance, message=""):
    """Equal to within a share of the largest value."""
    np.testing.assert_allclose(
        found, expected, rtol=0.0, atol=tolerance * np.abs(expected).max(), err_msg=message
    )


CASES = [(dim, "float64") for dim in (1, 2, 3)] + [(2, "float32")]


@pytest.mark.parametrize(("dim", "precision"), CASES)
def test_parshikov_medin_equals_its_equations(dim, precision):
    fields, fluid = random_state(dim)
    solver = probe(solver_of(dim, "pm", fields, fluid, precision), STABLE)
    expected = reference_pm(dim, fields, of(solver, "m"), np.where(fluid, 0.0, G))
    for name, values in zip(("dvdt", "dedt", "dvdx"), expected, strict=True):
        assert_close(of(solver, name), values, 200 * EPS[precision], name)


@pytest.mark.parametrize(("dim", "precision"), CASES)
@pytest.mark.parametrize("order", [1, 2])
def test_the_time_split_equals_its_equations(dim, precision, order):
    fields, fluid = random_state(dim)
    solver = solver_of(dim, f"ts{order}", fields, fluid, precision, limiter="superbee")
    v, e, rho, L = reference_ts(fields, of(solver, "m"), STABLE, order)
    step(probe(solver, STABLE), STABLE)  # the slope of v is left by the step before
    assert_close(of(solver, "v"), v, 500 * EPS[precision], "v")
    assert_close(of(solver, "e") - fields["e"], e - fields["e"], 500 * EPS[precision], "e")
    assert_close(of(solver, "rho"), rho, 100 * EPS[precision], "rho")
    assert_close(of(solver, "dvdx"), L, 100 * EPS[precision], "dvdx")
    mean = fields["x"] + 0.5 * STABLE * (fields["v"] + v)
    assert_close(of(solver, "x"), mean, 10 * EPS[precision], "x")


def totals(solver):
    """Energy and momentum, and the sums of their parts' sizes."""
    m, v, e = (of(solver, name) for name in ("m", "v", "e"))
    parts = 0.5 * m * np.sum(v**2, axis=1), m * e
    momentum = m[:, None] * v
    return (
        math.fsum(np.concatenate(parts)),
        np.array([math.fsum(c) for c in momentum.T]),
        sum(np.abs(part).sum() for part in parts),
        np.abs(momentum).sum(),
    )


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("scheme", ALL)
def test_energy_and_momentum_are_exact_for_any_step(dim, scheme):
    """Whatever the state and however long the step: also far beyond the stable one."""
    for seed, stride in enumerate((1e-3, 1.0, 300.0)):
        fields, fluid = random_state(dim, seed)
        solver = solver_of(dim, scheme, fields, fluid)
        energy, momentum, *_ = totals(solver)
        after = totals(step(solver, stride * STABLE))
        assert np.abs(of(solver, "v") - fields["v"]).max() > 1e-3
        assert abs(after[0] - energy) < 1e-13 * after[2]
        assert np.abs(after[1] - momentum).max() < 1e-13 * after[3]


@pytest.mark.parametrize("scheme", ["pm-explicit", "av-explicit"])
def test_explicit_steps_do_not_conserve(scheme):
    """What the velocity centring of the energy is for: without it every step adds dt²/2 Σ m A²."""
    fields, fluid = random_state(2)
    solver = solver_of(2, scheme, fields, fluid)
    energy, *_ = totals(solver)
    after, *_ = totals(step(solver, STABLE))
    m, dv = of(solver, "m"), of(solver, "v") - fields["v"]
    assert after - energy == pytest.approx(0.5 * np.sum(m * np.sum(dv**2, axis=1)), rel=1e-9)
    assert after > energy * (1.0 + 1e-6)


def turn(dim):
    """An arbitrary rotation of the plane or of space."""
    if dim == 2:
        c, s = math.cos(0.7), math.sin(0.7)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    Q, R = np.linalg.qr(np.random.default_rng(11).normal(size=(3, 3)))
    Q *= np.sign(np.diag(R))
    return Q * np.linalg.det(Q)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("scheme", FAMILIES)
def test_a_rotated_problem_has_the_rotated_solution(dim, scheme):
    fields, fluid = random_state(dim)
    Q = turn(dim)
    rotated = {name: values @ Q.T if values.ndim == 2 else values for name, values in fields.items()}
    rotated["tau"] = Q @ fields["tau"] @ Q.T
    straight, turned = (step(solver_of(dim, scheme, f, fluid), STABLE) for f in (fields, rotated))
    for name in ("v", "e", "rho", "dvdx", "tau", "ep"):
        expected = of(straight, name)
        if expected.ndim > 1:
            expected = expected @ Q.T if expected.ndim == 2 else Q @ expected @ Q.T
        assert_close(of(turned, name), expected, 1e-12, name)


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("scheme", ["pm", "pm-mixed", "ts2", "ts2-mixed"])
def test_a_uniform_state_stays(scheme, precision):
    """In flight and under pressure: no particle deforms, and none within a lattice accelerates."""
    v = np.array([123.0, -45.0, 0.0])
    x = jittered(2, 13, 0.0)
    n, p, eps = len(x), 1e9, EPS[precision]
    rho = np.full(n, DENSITY * (1.0 + p / K))
    inside = (np.abs(x[:, :2] - 6.0 * SPACING) < 1.5 * SPACING).all(axis=1)
    assert inside.sum() == 9
    state = {"x": x, "v": np.tile(v, (n, 1)), "p": np.full(n, p), "rho": rho}
    solver = solver_of(2, scheme, state, precision=precision)
    probe(solver, STABLE)
    accelerations = of(solver, "dvdt")
    outward = p / (DENSITY * H)
    assert np.abs(accelerations[inside]).max() < 50 * eps * outward
    assert np.abs(accelerations[~inside]).max() > 0.1 * outward, "its faces are free"
    # along a jittered edge the sums are no sums over a lattice: there it is the differences that vanish
    state["x"] = jittered(2, 13, 0.2)
    solver = solver_of(2, scheme, state, precision=precision)
    probe(solver, STABLE)
    spread = np.linalg.norm(v) / H
    assert np.abs(of(solver, "dvdx")).max() < 50 * eps * spread
    if scheme.startswith("ts"):
        assert np.abs(of(solver, "div")).max() < 50 * eps * spread
    # the work of uniform pressure on a uniform flow: none
    assert np.abs(of(solver, "dedt")).max() < 50 * eps * p * spread / DENSITY


def unlimited(monkeypatch, order):
    """Register a corrected time-split scheme whose gradients are never limited."""
    settings = GodunovSettings(split=True, order=order, correction=True, gradient_ratio=math.nan)
    monkeypatch.setitem(SCHEMES, f"exact{order}", settings)
    return f"exact{order}"


@pytest.mark.parametrize(("dim", "precision"), CASES)
def test_linear_fields_are_reconstructed_exactly(dim, precision, monkeypatch):
    """As the step vanishes both states of a pair are the field at its middle.

    A velocity without shock then meets no dissipation, and its divergence is exact, on disordered particles and at
    boundaries; a linear pressure has no jump that would drive u*. First order has both.
    """
    x, eps = jittered(dim, SIZE[dim], 0.2), EPS[precision]
    n, rate, tiny = len(x), 100.0, 1e-15 * STABLE
    L = np.zeros((3, 3))
    L[:dim, :dim] = rate * np.random.default_rng(5).uniform(-1.0, 1.0, size=(dim, dim))
    speeds = {"cs": np.full(n, C), "cl": np.full(n, CL)}
    moving = {"x": x, "v": x @ L.T, **speeds}
    slope = np.where(np.arange(3) < dim, [3e11, -2e11, 1e11], 0.0)
    pressed = {"x": x, "p": x @ slope, **speeds}
    for name, limiter, jump in (
        ("exact1", "superbee", False),
        ("exact2", "superbee", False),
        ("exact2", "mc", True),
    ):
        scheme = unlimited(monkeypatch, int(name[-1]))
        options = {"limiter": limiter, "limit_jump": jump}
        flow = probe(solver_of(dim, scheme, moving, precision=precision, **options), tiny)
        np.testing.assert_allclose(of(flow, "div"), np.trace(L), atol=3e3 * eps * rate)
        push = np.abs(of(flow, "dvdt")).max()
        dissipation = C * rate
        still = probe(solver_of(dim, scheme, pressed, precision=precision, **options), tiny)
        div, driven = np.abs(of(still, "div")).max(), np.abs(slope).max() / (DENSITY * C)
        if name == "exact1":
            assert push > 0.1 * dissipation and div > 0.1 * driven
        else:
            assert push < 3e3 * eps * dissipation and div < 3e3 * eps * driven


def test_failed_particles_are_not_reconstructed():
    fields, _ = random_state(2)
    fields["D"] = np.ones(len(fields["x"]))
    ceramic = {"first": lib.get("sic")}
    first, second = (step(solver_of(2, scheme, fields, **ceramic), STABLE) for scheme in ("ts1", "ts2"))
    for name in ("v", "e", "rho"):
        assert_close(of(second, name), of(first, name), 1e-14, name)
    fields["D"][:] = 0.99
    whole = step(solver_of(2, "ts2", fields, **ceramic), STABLE)
    assert np.abs(of(whole, "v") - of(first, "v")).max() > 1.0


# --- one pair, whose interface state can be read off its force


R = 0.9 * SPACING
DIRECTION = {1: [1.0, 0.0, 0.0], 2: [0.6, 0.8, 0.0], 3: [0.48, 0.64, 0.6]}


def pair(dim, scheme, v, precision="float64", materials=(ELASTIC, ELASTIC), **fields):
    """Two particles, the second in DIRECTION of the first, with velocities v; after the pair sums."""
    x = np.array([np.zeros(3), R * np.array(DIRECTION[dim])])
    second = np.array([False, materials[1] is FLUID])
    state = {"x": x, "v": np.array(v, dtype=float), **fields}
    return probe(solver_of(dim, scheme, state, second, precision, first=materials[0]), STABLE)


def traction(dim, solver):
    """The traction on the face between the pair, of the second particle on the first [Pa]."""
    m, vol = of(solver, "m"), of(solver, "vol")
    q, sigma = R / H, {1: 2 / 3, 2: 10 / (7 * math.pi), 3: 1 / math.pi}[dim]
    slope = sigma / H ** (dim + 1) * (2.25 * q**2 - 3.0 * q)
    force = m[:, None] * of(solver, "dvdt")
    np.testing.assert_allclose(force[0], -force[1], atol=1e-6 * np.abs(force).max())
    return force[0] / (-2.0 * vol[0] * vol[1] * slope)


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_interface_of_two_elastic_halves(dim, precision):
    """Aluminium halves that meet with 10 m/s: -89.815 MPa along e, ρ c_t Δv/2 across, and nothing else."""
    aluminium = lib.Material("al", 2785.0, lib.LinearElastic(K=79.06e9), lib.Elastic(G=27.6e9))
    e = np.array(DIRECTION[dim])
    found = traction(dim, pair(dim, "pm", [5.0 * e, -5.0 * e], precision, (aluminium, aluminium)))
    np.testing.assert_allclose(found, -89815101.73684601 * e, atol=20 * EPS[precision] * 9e7)
    if dim > 1:
        s = np.cross(e, [0.0, 0.0, 1.0])
        s /= np.linalg.norm(s)
        found = traction(dim, pair(dim, "pm", [-5.0 * s, 5.0 * s], precision, (aluminium, aluminium)))
        c_t = math.sqrt(27.6e9 / 2785.0)
        np.testing.assert_allclose(found, 2785.0 * c_t * 5.0 * s, atol=20 * EPS[precision] * 9e7)


@pytest.mark.parametrize("scheme", FAMILIES)
@pytest.mark.parametrize("materials", [(FLUID, FLUID), (ELASTIC, FLUID)], ids=["fluid", "solid-fluid"])
def test_a_fluid_passes_no_shear_on(scheme, materials):
    e, s = np.array(DIRECTION[2]), np.array([-0.8, 0.6, 0.0])
    solver = pair(2, scheme, [300.0 * s, -300.0 * s], materials=materials)
    assert not np.abs(of(solver, "dvdt") @ s).max() > 1e-12 * 300.0 * C / H
    assert np.abs(of(solver, "dvdt") @ e).max() < 1e-12 * 300.0 * C / H
    assert np.abs(of(solver, "dedt")).max() < 1e-12 * 300.0**2 * C / H


@pytest.mark.parametrize("scheme", ALL)
@pytest.mark.parametrize("damage", [(1.0, 1.0), (1.0, 0.3)])
def test_failed_pairs_carry_no_tension(scheme, damage):
    """Pulled apart, a failed ceramic: no force and no work; an intact one and a metal hold; pushed together all resist."""
    e, damage, speed = np.array(DIRECTION[2]), np.array(damage), 50.0
    ceramic = (lib.get("sic"), lib.get("sic"))
    parting, rounding = [-speed * e, speed * e], 1e-15 * speed * CL / H
    for p in (0.0, -1e8):
        torn = pair(2, scheme, parting, materials=ceramic, D=damage, p=np.full(2, p))
        assert np.abs(of(torn, "dvdt")).max() < rounding and np.abs(of(torn, "dedt")).max() < rounding * speed
    for materials, D in ((ceramic, np.array([0.9, 0.3])), ((ELASTIC, ELASTIC), damage)):
        whole = of(pair(2, scheme, parting, materials=materials, D=D), "dvdt") @ e
        assert whole[0] > 1e9 * rounding and whole[1] < -1e9 * rounding, "they hold each other back"
    met = pair(2, scheme, [speed * e, -speed * e], materials=ceramic, D=damage)
    force = of(met, "dvdt") @ e
    assert force[0] < -1e9 * rounding and force[1] > 1e9 * rounding and of(met, "dedt").sum() > 0.0


def test_a_shear_wave_runs_at_its_speed():
    """Two halves that slide along each other: between fronts at ± c_t t the stress is ρ c_t Δv/2, at the speed of both."""
    speed, until = 5.0, 10 * SPACING / CT
    made = scene(2, scheme="pm")
    made.add_body(
        "block",
        Box((-24 * SPACING, -28 * SPACING), (24 * SPACING, 28 * SPACING)),
        ELASTIC,
        velocity=lambda x: np.stack([0 * x[..., 0], speed * np.sign(x[..., 0]), 0 * x[..., 0]], axis=-1),
    )
    solver = Solver(made.finalize())
    solver.advance(until)
    x, v, tau = (by_id(solver, name) for name in ("x", "v", "tau"))
    row = np.abs(x[:, 1]) < SPACING  # which the free ends have not reached
    middle = row & (np.abs(x[:, 0]) < 4 * SPACING)
    np.testing.assert_allclose(tau[middle, 0, 1], DENSITY * CT * speed, rtol=0.02)
    np.testing.assert_allclose(v[middle, 1], 0.0, atol=0.02 * speed)
    assert np.abs(v[row, 0]).max() < 0.02 * speed
    right = row & (x[:, 0] > 0.0)
    order = np.argsort(x[right, 0])
    front = np.interp(0.5 * speed, v[right, 1][order], x[right, 0][order])
    assert front == pytest.approx(CT * until, abs=SPACING)
