"""Lagrangian and Eulerian particles of one body: what the interface between them does."""

import numpy as np
import pytest
import warp as wp
from tools import DENSITY, DOUBLE, ELASTIC, SPACING, G, K, by_id, forces, jittered, overwrite, scene

from warpsph.kernels.coupling import ALL, ARTIFICIAL_STRESS, FORCE, Coupling, make_coupling
from warpsph.kernels.kernel_type import EULERIAN, LAGRANGIAN
from warpsph.schemes import SCHEMES, EulerianSettings, LagrangianSettings
from warpsph.solver import Solver

COUNT = {1: 24, 2: 14, 3: 13}
STIFF = K + 4.0 * G / 3.0


def half(dim, scheme="adaptle", amount=0.0, precision="float64", **numerics):
    """A block whose upper half along x is Eulerian."""
    made, n = scene(dim, scheme=scheme, **numerics), COUNT[dim]
    made.add_body("block", jittered(dim, n, amount), ELASTIC)
    made.make_eulerian("block", lambda x: x[:, 0] > (0.5 * n - 0.75) * SPACING)
    return Solver(made.finalize(), precision=precision)


def strained(solver, strain, dim):
    """Uniform strain along the axes, and the stress that goes with it; forces of particles far from the boundary."""
    F = np.eye(3)
    F[:dim, :dim] += strain * np.diag([1.0, -0.4, 0.7][:dim])
    J, n = np.linalg.det(F), solver.particles.n
    sig = np.tile(STIFF * strain * np.diag([1.0, 0.5, -0.3]), (n, 1, 1))
    X = solver.data.x
    overwrite(
        solver, x=X @ F.T, F=np.tile(F, (n, 1, 1)), sig=sig, rho=np.full(n, DENSITY / J),
        vol=np.full(n, SPACING**dim * J), v=np.zeros((n, 3)),
    )  # fmt: skip
    solver.relist()
    index = np.round(X[:, :dim] / SPACING)
    inside = ((index >= 4) & (index <= COUNT[dim] - 5)).all(axis=1)
    assert inside.any() and len(np.unique(by_id(solver, "kernel_type")[inside])) == 2
    return np.abs(forces(solver)[0][inside]).max() * DENSITY * SPACING / (STIFF * strain)


@pytest.mark.parametrize("scheme", ["adaptle", "adaptle-plain", "adaptle-mixed"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_printed_coupling_under_uniform_strain(dim, scheme):
    """Every particle sums one configuration's neighbours of both types: on a regular lattice nothing remains."""
    assert strained(half(dim, scheme, coupling="printed"), 0.02, dim) < 1e-12


@pytest.mark.parametrize("scheme", ["adaptle-plain", "adaptle-mixed"])
@pytest.mark.parametrize("dim", DOUBLE)
def test_conservative_coupling_under_uniform_strain(dim, scheme):
    """Pair forces of two configurations meet in one sum: they miss each other by strain, so that the force is O(ε²)."""
    coarse, fine = (strained(half(dim, scheme), strain, dim) for strain in (0.02, 0.01))
    assert 0.3 * 0.02 < coarse < 0.7 * 0.02
    assert fine == pytest.approx(0.5 * coarse, rel=0.1)  # over a stress that is halved too


@pytest.mark.parametrize("dim", DOUBLE)
def test_two_kinds_of_gradient_miss_each_other(dim):
    """Corrected gradients on one side and plain ones on the other: what those are wrong by on a lattice remains."""
    solver = half(dim, "adaptle")
    assert 0.005 < strained(solver, 1e-5, dim) < 0.03


@pytest.mark.parametrize("coupling", ["conservative", "printed"])
def test_no_strain_no_difference(coupling):
    """In the reference state both forms are one: a mixed lattice has the forces of a Lagrangian one."""
    found = []
    for scheme in ("adaptle-plain", "tl-plain"):
        options = {"coupling": coupling} if scheme != "tl-plain" else {}
        if scheme == "tl-plain":
            made = scene(2, scheme=scheme)
            made.add_body("block", jittered(2, COUNT[2], 0.2), ELASTIC)
            solver = Solver(made.finalize())
        else:
            solver = half(2, scheme, 0.2, **options)
        rng = np.random.default_rng(1)
        sig = 1e9 * rng.normal(size=(solver.particles.n, 3, 3)) * (np.arange(3) < 2)
        sig = (sig + sig.swapaxes(1, 2)) * (np.arange(3) < 2)[:, None] * (np.arange(3) < 2)
        v = rng.uniform(-100.0, 100.0, size=(solver.particles.n, 3)) * (np.arange(3) < 2)
        overwrite(solver, sig=sig, v=v)
        found.append(forces(solver))
    for one, two in zip(*found, strict=True):
        np.testing.assert_allclose(one, two, atol=1e-12 * np.abs(two).max())


@pytest.mark.parametrize("dim", DOUBLE)
def test_interface_particles_keep_their_deformation_gradient(dim, monkeypatch):
    """Eulerian particles with a Lagrangian reference neighbour follow an affine motion; the others' F stays as it was."""
    gradient = LagrangianSettings(EulerianSettings("monaghan", 0.0, 0.0), True, 0.0, 0.0)
    monkeypatch.setitem(SCHEMES, "exact", gradient)
    made, n = scene(dim, scheme="exact"), COUNT[dim]
    A = np.zeros((3, 3))
    dt = 1e-3 * SPACING / 6000.0
    A[:dim, :dim] = np.random.default_rng(1).uniform(-1.0, 1.0, size=(dim, dim)) * 0.02 / dt
    made.add_body("block", jittered(dim, n), ELASTIC, velocity=lambda x: x @ A.T)
    made.fix("block")
    made.make_eulerian("block", lambda x: x[:, 0] > (0.5 * n - 0.75) * SPACING)
    solver = Solver(made.finalize())
    solver.advance(dt)
    assert solver.reading.steps == 1
    F, X, kind = by_id(solver, "F"), solver.data.x, by_id(solver, "kernel_type")
    lagrangian = kind == LAGRANGIAN
    near = (np.linalg.norm(X[:, None] - X[lagrangian], axis=-1) < 2.0 * solver.data.h).any(axis=1)
    np.testing.assert_allclose(F[near], np.broadcast_to(np.eye(3) + dt * A, F[near].shape), atol=1e-11)
    np.testing.assert_array_equal(F[~near], np.broadcast_to(np.eye(3), F[~near].shape))
    assert (near & (kind == EULERIAN)).any() and (~near).any()


def bits(form, stress, separate=False):
    """Terms of every combination of types: (i's type, j's type, same body, reference neighbours)."""
    terms, real, vec = (
        make_coupling(DOUBLE[2], Coupling(form, stress, separate)),
        DOUBLE[2].real,
        DOUBLE[2].vec,
    )

    @wp.kernel(module="unique", enable_backward=False)
    def sample(kinds: wp.array2d[wp.int32], out: wp.array[wp.int32]):
        k = wp.tid()
        apart = real(0.5) if kinds[k, 3] == 1 else real(3.0)
        out[k] = terms(
            kinds[k, 0], kinds[k, 1], kinds[k, 2] == 1, vec(apart, real(0.0), real(0.0)), real(2.0)
        )

    cases = [(i, j, same, close) for i in (0, 1, 2) for j in (0, 1, 2) for same in (0, 1) for close in (0, 1)]
    out = wp.zeros(len(cases), dtype=wp.int32, device="cpu")
    wp.launch(sample, len(cases), [wp.array(cases, dtype=wp.int32, device="cpu"), out], device="cpu")
    return dict(zip(cases, out.numpy().tolist(), strict=True))


@pytest.mark.parametrize("stress", ["both", "none", "eulerian"])
def test_terms_of_a_pair(stress):
    E, L, X = 0, 1, 2
    on_e, on_l = {"both": (True, True), "none": (False, False), "eulerian": (True, False)}[stress]
    art_e, art_l = on_e * ARTIFICIAL_STRESS, on_l * ARTIFICIAL_STRESS
    for form in ("printed", "conservative"):
        found = bits(form, stress)
        for close in (0, 1):
            assert found[E, E, 1, close] == ALL
            assert found[L, L, 1, close] == 0
            lagrangian = form == "conservative" and close
            assert found[E, L, 1, close] == art_e | (0 if lagrangian else FORCE)
            assert found[L, E, 1, close] == art_l | (FORCE if form == "conservative" and not close else 0)
            for a, b in ((E, L), (L, E), (E, E), (L, L)):
                assert found[a, b, 0, close] == ALL, "kernel contact"
            for other in (E, L, X):
                assert found[X, other, 1, close] == found[other, X, 0, close] == 0
    apart = bits("conservative", stress, separate=True)
    assert not any(value for (_, _, same, _), value in apart.items() if not same)
