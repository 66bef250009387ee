"""Extreme physics: the trial in short, and each mend by itself."""

from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp
from tools import ELASTIC, REALS, SPACING, body, by_id, forces, jittered, scene

from warpsph import materials as lib
from warpsph.errors import InputError
from warpsph.kernels.spec import Spec
from warpsph.kernels.timestep import NON_FINITE
from warpsph.quality.torture import extreme
from warpsph.quality.torture.trial import Means
from warpsph.running.balance import Balance
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.solver import PRECISIONS, Solver
from warpsph.watching.magnitudes import check_magnitudes
from warpsph.watching.trouble import explain


def test_what_the_trial_tries_holds(tmp_path):
    found = extreme.run(Means(tmp_path, True, lambda line: None))
    assert found.failed == []
    assert len(found.rows) == len(extreme.CASES)


def test_the_hugoniot_is_that_of_the_equation_of_state():
    wave, pressure = extreme.hugoniot(1e4)
    eos, rho0 = extreme.ALUMINIUM.eos, extreme.ALUMINIUM.density
    rho, e = rho0 * wave / (wave - 1e4), 0.5e8
    assert pressure == pytest.approx(eos.c0**2 * (rho - rho0) + (eos.gamma0 - 1.0) * rho * e, rel=1e-12)


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("scheme", ["sav1", "pm", "ts2", "ts2-mixed"])
def test_particles_at_one_place_have_finite_forces_that_add_up_to_none(scheme, precision):
    x = jittered(2, 5, 0.1)
    v = np.random.default_rng(1).normal(size=x.shape) * 100.0 * (np.arange(3) < 2)
    solver = body(2, x, v, precision=precision, scheme=scheme)
    ids, moved = solver.particles.id.numpy(), x.copy()
    moved[3], moved[4] = moved[1], moved[2] + 1e-12 * SPACING
    solver.particles.x.assign(moved[ids].astype(solver.particles.x.numpy().dtype))
    solver.relist()
    a, power = forces(solver)
    assert np.isfinite(a).all() and np.isfinite(power).all()
    eps = np.finfo(precision).eps
    assert (
        np.abs((solver.data.m[:, None] * a).sum(axis=0)).max()
        < 500 * eps * np.abs(solver.data.m[:, None] * a).max()
    )


def test_a_fragment_has_plain_gradients_and_a_lattice_corrected_ones():
    def correction(points, apart=1.0):
        solver = body(2, points, scheme="sav1-mixed")
        solver.particles.x.assign(apart * solver.particles.x.numpy())
        solver.relist()
        forces(solver)
        return solver._work.K.numpy(), solver._work.G.numpy()

    K, G = correction(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]) * SPACING, apart=2.2)
    np.testing.assert_array_equal(K, np.broadcast_to(np.eye(3), (3, 3, 3)))
    np.testing.assert_array_equal(G, 0.0)
    K, _ = correction(jittered(2, 6, 0.0))
    assert (np.abs(K - np.eye(3)).max(axis=(1, 2)) > 1e-3).all()


@pytest.mark.parametrize(("spacing", "dim", "precision", "allowed"), [
    (1e-9, 3, "float32", False), (1e-9, 3, "mixed", False), (1e-9, 3, "float64", True), (1e-9, 2, "float32", False),
    (1e-6, 3, "float32", True), (1e-15, 3, "float64", True), (1e6, 3, "float32", True), (1e9, 3, "float32", False),
])  # fmt: skip
def test_numbers_beyond_the_precision_are_refused(spacing, dim, precision, allowed):
    made = Scene("test", dim=dim, spacing=spacing, until=1.0)
    made.add_body("a", np.zeros((1, 3)), ELASTIC)
    spec = Spec(dim, *PRECISIONS[precision])
    if allowed:
        check_magnitudes(made.finalize(), spec, precision)
        return
    with pytest.raises(
        InputError, match=r"does not go with precision .* kernel's gradient .*; allowed: precision 'float64'"
    ):
        Solver(made.finalize(), precision=precision)


def test_positions_that_single_precision_rounds_away_are_refused():
    made = scene(2)
    made.add_body("a", np.array([(1e6 * SPACING, 0.0, 0.0)]), ELASTIC)
    with pytest.raises(
        InputError, match=r"rounded to 0.12 spacings; allowed: up to 0.01 spacings, with precision 'mixed'"
    ):
        Solver(made.finalize(), precision="float32")
    check_magnitudes(made.finalize(), Spec(2, wp.float32, wp.float64), "mixed")


def test_errors_of_what_starts_without_energy_have_a_scale_without_units():
    """A block under tension, of a material whose energy is not that of its stress, starts with E0 = 0 and no momentum."""
    made = scene(2)
    made.add_body("block", Box((0.0, 0.0), (5 * SPACING, 5 * SPACING)), ELASTIC, density=2750.0)
    solver = Solver(made.finalize())
    balance = Balance(solver.data, solver.ledger())
    ledger = solver.ledger() | {"kinetic_energy": 8.0, "momentum_x": 3.0}
    balance.update(ledger)
    balance.update(ledger | {"kinetic_energy": 2.0})
    assert balance.energy_error == 1.0
    assert balance.momentum_error == pytest.approx(3.0 / np.sqrt(2.0 * solver.data.m.sum() * 8.0))
    again = Balance(solver.data, balance.start)
    again.restore(balance.save())
    assert again.kinetic == 8.0


def test_a_stop_says_that_the_equation_of_state_had_left_its_range():
    solver = body(2, jittered(2, 3), material="aluminium")
    e = np.where(np.arange(9) == 4, np.nan, 0.0)
    clipped = np.full(9, 7, dtype=np.int32)
    for name, values in (("e", e), ("clipped", clipped)):
        getattr(solver.particles, name).assign(values[solver.particles.id.numpy()])
    now = SimpleNamespace(status=NON_FINITE, time=0.0, steps=0)
    said = str(explain(now, solver.particles, solver.data, solver._scheme))
    assert "its equation of state had left its range in 7 steps; a pressure_cutoff" in said


def test_materials_without_strength_are_fluids():
    """Yield stress and shear modulus of zero are refused: `Fluid` is what they mean."""
    for law, constants in ((lib.PerfectlyPlastic, {"G": 27e9, "Y": 0.0}), (lib.Elastic, {"G": 0.0})):
        with pytest.raises(InputError, match="out of range; allowed: positive"):
            law(**constants)
    solver = body(
        2, jittered(2, 4), material=lib.Material("fluid", 1000.0, lib.LinearElastic(K=2e9), lib.Fluid())
    )
    solver.advance(1e-7)
    assert not by_id(solver, "tau").any()
