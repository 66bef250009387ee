"""Forces of the Total Lagrangian equations: by hand, against the Eulerian ones, and at what cost."""

import math

import numpy as np
import pytest
from by_hand import (
    cofactor,
    gradients,
    lagrangian_forces,
    lagrangian_powers,
    lagrangian_viscous_directions,
    viscous_forces,
)
from test_deformation import rotation, state
from tools import (
    DENSITY,
    DOUBLE,
    ELASTIC,
    REALS,
    SPACING,
    G,
    K,
    body,
    by_id,
    collision,
    forces,
    jittered,
    one_step,
    overwrite,
    run,
    scene,
)

from warpsph.config import Contact
from warpsph.kernels.parts import VISCOUS
from warpsph.schemes import SCHEMES
from warpsph.solver import Solver

EPS = {"float64": 2.2e-16, "float32": 1.2e-7}
COUNT = {1: 20, 2: 8, 3: 5}
SPEED = 300.0


def noise(dim, n, seed=4):
    """Random velocities [m/s], shape [n, 3]."""
    v = np.zeros((n, 3))
    v[:, :dim] = np.random.default_rng(seed).uniform(-SPEED, SPEED, size=(n, dim))
    return v


def stirred(dim, scheme, precision="float64"):
    """A disordered body in a made-up state, and its forces, by hand and the engine's."""
    X = jittered(dim, COUNT[dim])
    solver = body(dim, X, scheme=scheme, precision=precision)
    F, sig = state(solver, dim)
    x, v = X + 0.05 * jittered(dim, COUNT[dim], seed=7), noise(dim, len(X))
    overwrite(solver, x=x, v=v)
    settings, V0 = SCHEMES[scheme], np.full(len(X), SPACING**dim)
    g = gradients(X, V0, dim, solver.data.h, settings.correction)
    P = sig @ cofactor(F)
    m, cs = (by_id(solver, name).astype(float) for name in ("m", "cs"))
    J = np.linalg.det(F)
    overwrite(solver, rho=DENSITY / J, vol=V0 * J)  # as a step leaves them
    q = lagrangian_viscous_directions(g, F)
    viscous = viscous_forces(x, v, m, DENSITY / J, cs, solver.data.h, settings.alpha, settings.beta, q)
    stress = lagrangian_forces(g, V0, P)
    vji = v[None] - v[:, None]
    power = lagrangian_powers(g, V0, P, v) + 0.5 * np.einsum("abi,abi->a", viscous, vji)
    return solver, stress, viscous, power


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("scheme", ["tl", "tl-plain"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_momentum_and_energy_by_hand(dim, scheme, precision):
    """Random F, σ and v on a disordered body: stress and the viscous form of section 4 under a known F."""
    solver, stress, viscous, power = stirred(dim, scheme, precision)
    m = by_id(solver, "m").astype(float)
    accelerations, dedt = forces(solver)
    total = (stress + viscous).sum(axis=1)
    size, v = np.abs(stress).sum(axis=1).max(), SPEED
    assert np.abs(viscous).sum() > 0.01 * np.abs(stress).sum()
    np.testing.assert_allclose(accelerations * m[:, None], total, atol=3e3 * EPS[precision] * size)
    np.testing.assert_allclose(dedt * m, power, atol=3e3 * EPS[precision] * size * v)
    part = solver._work.part_a.numpy()[np.argsort(solver.particles.id.numpy()), VISCOUS]
    np.testing.assert_allclose(part * m[:, None], viscous.sum(axis=1), atol=3e3 * EPS[precision] * size)


@pytest.mark.parametrize("dim", DOUBLE)
def test_viscosity_equals_the_eulerian_one_in_the_reference_state(dim):
    """The same disordered body without stress, the same velocities, F = I: plain gradients give the same to round-off."""
    X, found = jittered(dim, COUNT[dim]), []
    for scheme in ("tl-plain", "sav1"):
        found.append(forces(body(dim, X, noise(dim, len(X)), scheme=scheme)))
    for one, two in zip(*found, strict=True):
        np.testing.assert_allclose(one, two, atol=1e-12 * np.abs(two).max())
        assert np.abs(two).max() > 1e5


@pytest.mark.parametrize("dim", [2, 3])
def test_viscosity_turns_with_the_body(dim):
    """Rotated as a whole, F included, a body's accelerations are rotated: the form of section 4 is objective."""
    X, turn = jittered(dim, COUNT[dim]), rotation(dim, 1.1)
    v, found = noise(dim, len(X)), []
    for Q in (np.eye(3), turn):
        solver = body(dim, X, v @ Q.T, scheme="tl")
        overwrite(solver, x=X @ Q.T, F=np.tile(Q, (len(X), 1, 1)))
        found.append(forces(solver)[0])
    np.testing.assert_allclose(found[1], found[0] @ turn.T, atol=1e-11 * np.abs(found[0]).max())


@pytest.mark.parametrize("dim", DOUBLE)
def test_the_two_kernel_types_agree_for_small_strain(dim):
    """One step of the same body from the same motion, then the same affine strain ε: stresses and forces differ by O(ε)."""
    x = jittered(dim, COUNT[dim] + 2, 0.0)
    A = np.zeros((3, 3))
    A[:dim, :dim] = np.random.default_rng(2).uniform(-1.0, 1.0, size=(dim, dim))
    wave = (
        np.sin(x[:, :1] / (2.0 * SPACING)) * x @ A.T / np.abs(x @ A.T).max()
    )  # strain that varies: there are forces
    differences = []
    for strain in (1e-3, 2.5e-4):
        found = []
        for scheme in ("tl", "sav1-mixed"):
            options = {"viscosity_alpha": 0.0, "viscosity_beta": 0.0}
            solver = body(dim, x, scheme=scheme, **options)
            dt = 1e-3 * SPACING / 6000.0
            overwrite(solver, v=strain * SPACING / dt * wave)
            solver.advance(dt)
            overwrite(solver, v=0.0 * wave)
            found.append((by_id(solver, "sig"), forces(solver)[0]))
        (s1, f1), (s2, f2) = found
        assert np.abs(s2).max() > 0.1 * strain * G
        differences.append(
            (np.abs(s1 - s2).max() / np.abs(s2).max(), np.abs(f1 - f2).max() / np.abs(f2).max())
        )
    for coarse, fine in zip(*differences, strict=True):
        assert coarse < 20 * 1e-3
        assert fine < 0.35 * coarse


def names(solver):
    """Kernels of a step and of its planning."""
    kernels = []

    def note(kernel, n=None, **_):
        kernels.append(kernel.key)

    scheme = solver._scheme
    for part in (scheme.step, lambda bind: scheme.plan(bind, solver._step_blocks, solver.neighbours.tiles)):
        part(note)
    return kernels


def test_a_pure_lagrangian_step_searches_for_nothing():
    """No search, no rows, no test of their wear, however far the body flies and turns."""
    spin = 2e4 * np.array([0.0, 0.0, 1.0])
    solver = body(2, jittered(2, 10), lambda x: np.cross(spin, x) + np.array([5e3, 0.0, 0.0]), scheme="tl")
    solver.advance(2e-5)
    assert solver.reading.steps > 100
    assert by_id(solver, "x")[:, 0].min() > 50 * SPACING
    assert solver.neighbours.builds == 1
    assert not solver.neighbours.n_neigh.numpy().any(), "not even at the start"
    assert not any("tiles" in name or "momentum_eulerian" in name for name in names(solver))
    assert not any(
        name.endswith(("motion", "wear", "velocity_gradient", "contact")) for name in names(solver)
    )


def test_bodies_in_contact_search_near_each_other_only():
    solver = run(collision(radius=8, scheme="tl", contact=Contact(stiffness=0.25)), 1e-6)
    role, count = solver.neighbours.role.numpy(), solver.neighbours.n_neigh.numpy()
    assert any(name.endswith("wear") for name in names(solver))
    assert 0.0 < (role > 0).mean() < 0.8
    assert not count[role == 0].any() and count[role > 0].all()


@pytest.mark.parametrize("scheme", ["tl", "tl-plain"])
def test_kernel_contact_of_lagrangian_bodies(scheme):
    """Without a contact algorithm bodies meet through the Eulerian sums over current neighbours.

    F knows nothing of the other body, so that stress builds up late and half of the momentum passes over, no more.
    """
    solver = Solver(collision(scheme=scheme, speed=200.0, material=ELASTIC).finalize())
    left = solver.data.body == 0
    solver.advance(1e-5)
    v, m = by_id(solver, "v"), by_id(solver, "m")
    assert m[~left] @ v[~left, 0] > 0.4 * 200.0 * m[left].sum()
    assert (by_id(solver, "kernel_type") == 1).all()
    assert by_id(solver, "x")[left, 0].max() < by_id(solver, "x")[~left, 0].max()


@pytest.mark.parametrize("dim", DOUBLE)
def test_zero_energy_control_feels_no_affine_motion(dim):
    """And drives back what F does not see: a checkerboard has no other force."""
    X = jittered(dim, COUNT[dim], 0.0)
    solver = body(dim, X, scheme="tl", hourglass=10.0)
    F = np.eye(3)
    F[:dim, :dim] += np.random.default_rng(3).uniform(-0.2, 0.2, size=(dim, dim))
    overwrite(solver, x=X @ F.T, F=np.tile(F, (len(X), 1, 1)))
    young = 9.0 * K * G / (3.0 * K + G)
    quiet = np.abs(forces(solver)[0]).max()
    assert quiet < 1e-9 * young / DENSITY / SPACING
    u = np.zeros_like(X)
    u[:, 0] = 0.05 * SPACING * (1.0 - 2.0 * (np.round(X / SPACING).sum(axis=1) % 2))
    overwrite(solver, x=X + u, F=np.tile(np.eye(3), (len(X), 1, 1)))
    restoring = forces(solver)[0]
    assert (restoring * u).sum(axis=1).max() < 0.0
    assert np.abs(restoring).max() > 1e-3 * young / DENSITY / SPACING


def test_a_bar_stretched_far_follows_its_modulus():
    """1D, to twice its length: σ = (4/3 G) ln F - K (1/F - 1), as the deviator is hypoelastic and p = K (ρ/ρ0 - 1)."""
    made = scene(1, scheme="tl")
    made.add_body("bar", jittered(1, 20, 0.0), ELASTIC, velocity=lambda x: 1e3 * x / (19 * SPACING))
    made.fix("bar", lambda x: (x[:, 0] < 0.5 * SPACING) | (x[:, 0] > 18.5 * SPACING))
    solver = Solver(made.finalize())
    solver.advance(19 * SPACING / 1e3)
    J, stress = by_id(solver, "F")[:, 0, 0], by_id(solver, "sig")[:, 0, 0]
    assert np.log(J).mean() == pytest.approx(math.log(2.0), rel=0.05)
    np.testing.assert_allclose(stress, 4.0 / 3.0 * G * np.log(J) - K * (1.0 / J - 1.0), rtol=1e-4)


def test_a_step_is_taken_in_order():
    """Elastic quantities follow the new velocity: after one step x = X + dt v' and F is the gradient of x."""
    X = jittered(2, 8)
    solver = one_step(body(2, X, noise(2, len(X)), scheme="tl-plain"))
    dt = solver.reading.time
    np.testing.assert_allclose(by_id(solver, "x"), X + dt * by_id(solver, "v"), atol=1e-16)
    g = gradients(X, np.full(len(X), SPACING**2), 2, solver.data.h, False)
    v = by_id(solver, "v")
    rate = SPACING**2 * np.einsum("abi,abj->aij", v[None] - v[:, None], g)
    np.testing.assert_allclose(by_id(solver, "F"), np.eye(3) + dt * rate, atol=1e-14)
