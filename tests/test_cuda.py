"""A GPU gives the physics of the CPU, and the same bits every time."""

import numpy as np
import pytest
import warp as wp
from tools import REALS, by_id, collision, run

from warpsph.config import Contact, Conversion
from warpsph.running.balance import energy
from warpsph.schemes import SCHEMES
from warpsph.solver import Solver

pytestmark = pytest.mark.gpu


@pytest.fixture
def cuda():
    """Name of a CUDA device."""
    if not wp.is_cuda_available():
        pytest.skip("this machine has no CUDA device")
    return "cuda:0"


@pytest.mark.parametrize(
    ("dim", "scheme"),
    [
        (1, "sav1"),
        (2, "sav1"),
        (3, "sav1"),
        (2, "pm"),
        (2, "ts2"),
        (3, "ts2-mixed"),
        (2, "tl"),
        (3, "adaptle-mixed-as"),
    ],
)
@pytest.mark.parametrize("real", [*REALS, "mixed"])
def test_same_physics(cuda, dim, scheme, real):
    """Sums are taken in another order: after a few dozen steps the states still agree to many digits."""
    here, there = (
        run(collision(dim, scheme=scheme), 2e-6, precision=real, **where) for where in ({}, {"device": cuda})
    )
    tolerance = {"float64": 1e-9, "float32": 2e-3, "mixed": 2e-3}[real]
    for name in ("x", "v", "rho", "p"):
        a, b = by_id(here, name), by_id(there, name)
        np.testing.assert_allclose(b, a, atol=tolerance * np.abs(a).max(), rtol=0, err_msg=name)


@pytest.mark.parametrize(
    "scheme", [name for name, settings in SCHEMES.items() if getattr(settings, "exact_energy", True)]
)
def test_energy_and_momentum(cuda, scheme):
    solver = run(collision(2, scheme=scheme), 0.0, device=cuda)
    before = solver.ledger()
    solver.advance(2e-6)
    after = solver.ledger()
    assert energy(after) == pytest.approx(energy(before), rel=1e-13)
    assert after["momentum_x"] == pytest.approx(before["momentum_x"], rel=1e-13)


@pytest.mark.parametrize(
    ("scheme", "options"),
    [("tl", {"hourglass": 5.0}), ("adaptle-mixed-as", {"conversion": Conversion(strain=0.1)})],
)
def test_contact_and_conversion(cuda, scheme, options):
    """The same particles convert, energy and momentum are kept, and two runs give the same bits."""
    made = collision(2, speed=900.0, scheme=scheme, contact=Contact(stiffness=0.25), **options)
    here, there, again = (run(made, 4e-6, **where) for where in ({}, {"device": cuda}, {"device": cuda}))
    np.testing.assert_array_equal(by_id(here, "kernel_type"), by_id(there, "kernel_type"))
    np.testing.assert_allclose(by_id(there, "v"), by_id(here, "v"), atol=1e-6 * 900.0)
    start, end = energy(Solver(made.finalize()).ledger()), energy(there.ledger())
    assert end == pytest.approx(start, rel=1e-13)
    for name, values in there.particles.arrays().items():
        np.testing.assert_array_equal(values, again.particles.arrays()[name], err_msg=name)


@pytest.mark.parametrize("scheme", ["sav1", "pm", "ts2", "tl", "adaptle"])
def test_twice_the_same_bits(cuda, scheme):
    first, second = (run(collision(3, scheme=scheme), 2e-6, device=cuda).particles.arrays() for _ in range(2))
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name], err_msg=name)


@pytest.mark.parametrize("scheme", ["sav1-as", "ts2", "adaptle-mixed-as"])
def test_a_restart_between_batches_gives_the_same_bits(cuda, scheme):
    """And one from the CPU's checkpoint goes on, as near as two devices are."""
    options = {"conversion": Conversion(strain=0.1)} if scheme.startswith("adaptle") else {}
    made, saved = collision(2, speed=900.0, scheme=scheme, **options), []
    straight, here = Solver(made.finalize(), device=cuda), Solver(made.finalize())
    straight.advance(3e-6, lambda now: saved.append(straight.save()) and None)
    here.advance(1.5e-6)
    moved = Solver(made.finalize(), device=cuda)
    moved.restore(*here.save())
    for solver in (here, moved):
        solver.advance(3e-6)
    np.testing.assert_allclose(by_id(moved, "v"), by_id(here, "v"), atol=1e-6 * 900.0)
    for arrays, info in saved[::5]:
        restarted = Solver(made.finalize(), device=cuda)
        restarted.restore(arrays, info)
        restarted.advance(3e-6)
        assert restarted.reading == straight.reading
        for name, values in straight.particles.arrays().items():
            np.testing.assert_array_equal(values, restarted.particles.arrays()[name], err_msg=name)


@pytest.mark.parametrize("scheme", ["sav1", "ts2", "tl", "adaptle-mixed-as"])
def test_a_graph_is_captured_and_gives_the_bits_of_plain_launches(cuda, scheme):
    replayed, plain = (Solver(collision(3, scheme=scheme).finalize(), device=cuda) for _ in range(2))
    plain.program.captured = False
    for solver in (replayed, plain):
        solver.advance(2e-6)
    assert replayed.program.captured and replayed.program._scores
    assert replayed.reading == plain.reading
    after = plain.particles.arrays()
    for name, values in replayed.particles.arrays().items():
        np.testing.assert_array_equal(values, after[name], err_msg=name)
