"""Energy, momentum and angular momentum, for every scheme, with constraints and symmetry planes."""

import numpy as np
import pytest
from tools import DENSITY, ELASTIC, FLUID, REALS, SPACING, by_id, collision, jittered, run, scene

from warpsph.config import Contact, Conversion
from warpsph.running.balance import Balance, energy
from warpsph.schemes import SCHEMES, LagrangianSettings
from warpsph.shapes import Box
from warpsph.solver import Solver

TIME = 5e-6
EXACT = [name for name, settings in SCHEMES.items() if getattr(settings, "exact_energy", True)]
AHEAD = np.array([13.5 * SPACING, 0.0, 0.0])


def balanced(made, time, **options):
    """Run a scene; its balance at the end, and the solver."""
    solver = Solver(made.finalize(), **options)
    balance = Balance(solver.data, solver.ledger())
    solver.advance(time)
    assert solver.reading.steps > 20
    balance.update(solver.ledger())
    return balance, solver


@pytest.mark.parametrize("scheme", EXACT)
def test_a_collision_conserves(scheme):
    balance, solver = balanced(collision(scheme=scheme), TIME)
    now = solver.ledger()
    assert now["internal_energy"] > 0.05 * energy(balance.start), "they have hit each other"
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13


@pytest.mark.parametrize("scheme", sorted(SCHEMES.keys() - EXACT))
def test_explicit_energies_drift(scheme):
    """The papers' own stepping, to compare with: momentum is exact, energy is not."""
    balance, _ = balanced(collision(scheme=scheme), TIME)
    assert 1e-5 < balance.energy_error < 0.1
    assert balance.momentum_error < 1e-13


@pytest.mark.parametrize(
    ("dim", "scheme"), [(1, "sav1-mixed-as"), (3, "sav1-mixed-as"), (1, "ts2"), (3, "pm"), (3, "ts2-mixed")]
)
def test_a_collision_conserves_in_1d_and_3d(dim, scheme):
    balance, _ = balanced(collision(dim, scheme=scheme, radius=3.6), TIME)
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13


@pytest.mark.parametrize("riemann", ["acoustic", "two-shock"])
@pytest.mark.parametrize("limiter", ["minmod", "mc"])
def test_every_solver_conserves(riemann, limiter):
    balance, _ = balanced(collision(scheme="ts2", riemann=riemann, limiter=limiter, limit_jump=True), TIME)
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13


@pytest.mark.parametrize("scheme", ["sav1", "pm", "ts2"])
def test_single_precision_conserves_to_its_own_rounding(scheme):
    balance, _ = balanced(collision(scheme=scheme), TIME, precision="float32")
    assert balance.energy_error < 1e-5
    assert balance.momentum_error < 1e-5


def spinning(held, **numerics):
    """A patch of fluid that spins and hits another; ``held``: some particles cannot move as they would."""
    made = scene(2, **numerics)
    spin = 2e4 * np.array([0.0, 0.0, 1.0])
    made.add_body("spinning", jittered(2, 12), FLUID, velocity=lambda x: np.cross(spin, x - 5.5 * SPACING))
    made.add_body("hit", jittered(2, 6, seed=1) + AHEAD, FLUID, velocity=(-300.0, 50.0, 0.0))
    if held:
        made.fix("hit", lambda x: x[:, 1] < 1.5 * SPACING)
        made.fix("spinning", lambda x: x[:, 0] < 1.5 * SPACING, components="x")
    return made


@pytest.mark.parametrize(("scheme", "held"), [("sav1", False), ("sav1", True), ("pm", False), ("pm", True)])
def test_a_fluid_keeps_its_angular_momentum(scheme, held):
    """Its pair forces are central as long as gradients are plain; what constraints give is booked."""
    balance, solver = balanced(spinning(held, scheme=scheme), 2e-5)
    now = solver.ledger()
    assert np.abs(by_id(solver, "v") - solver.data.v).max() > 50.0
    assert (abs(now["twist_z"]) > 0.01 * abs(balance.start["angular_momentum_z"])) == held
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13
    assert balance.angular_momentum_error < 1e-13


@pytest.mark.parametrize("scheme", ["ts1", "ts2"])
def test_the_mean_drift_of_the_time_split_costs_angular_momentum(scheme):
    """Its particles move with (v + v')/2, so that every step adds dt²/2 Σ v × F: the error falls with the step."""
    errors = []
    for cfl in (0.5, 0.125):
        balance, _ = balanced(spinning(False, scheme=scheme, cfl=cfl), 2e-5)
        assert balance.energy_error < 1e-13 and balance.momentum_error < 1e-13
        errors.append(balance.angular_momentum_error)
    assert errors[0] < 2e-3 and errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize("scheme", ["sav1", "sav1-mixed-as", "pm", "ts2-mixed"])
def test_the_ledger_closes_with_constraints(scheme):
    """A block is clamped at one face, driven at the other and in one direction only along a third, and hit."""
    made = scene(2, scheme=scheme)
    made.add_body("block", Box((0.0, 0.0), (12 * SPACING, 8 * SPACING)), "aluminium")
    made.fix("block", lambda x: x[:, 0] > 10.6 * SPACING)
    made.fix("block", lambda x: x[:, 1] < SPACING, components="y")
    made.add_body(
        "ram", Box((-6 * SPACING, 0.0), (-2 * SPACING, 8 * SPACING)), "aluminium", velocity=(300.0, 40.0)
    )
    made.fix("ram", lambda x: x[:, 0] < -5 * SPACING, components="x")
    balance, solver = balanced(made, 2 * TIME)
    data, now = solver.data, solver.ledger()
    held = np.stack([data.fixed >> axis & 1 for axis in range(3)], axis=1) == 1
    np.testing.assert_array_equal(by_id(solver, "v")[held], data.v[held])
    assert now["work"] > 0.01 * energy(balance.start), "the drive does work"
    assert abs(now["impulse_x"]) > 0.01 * balance.start["momentum_x"]
    assert abs(now["impulse_y"]) > 0.0
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13


def test_work_of_a_piston_is_force_times_way():
    """A piston that drives a cold bar sends a wave of known stress: σ = ρ c_l u, so that the work is known."""
    u, time = 10.0, 6e-6
    made = scene(1, scheme="sav1-mixed", smoothing_ratio=1.4)
    made.add_body("bar", Box(0.0, 60 * SPACING), ELASTIC)
    made.add_body("piston", Box(-6 * SPACING, 0.0), ELASTIC, velocity=(u,))
    made.fix("piston")
    solver = run(made, time)
    stress = DENSITY * ELASTIC.longitudinal_speed * u
    assert solver.ledger()["work"] == pytest.approx(stress * u * time, rel=0.05)


@pytest.mark.parametrize(
    ("axes", "scheme"),
    [("x", "sav1-mixed-as"), ("xy", "sav1-mixed-as"), ("xy", "pm-mixed"), ("x", "ts2"), ("xy", "ts2-mixed")],
)
def test_a_symmetry_plane_conserves_energy(axes, scheme):
    made = scene(2, scheme=scheme)
    made.add_body(
        "block", Box((0.0, 0.0), (10 * SPACING, 8 * SPACING)), "aluminium", velocity=(-200.0, -100.0)
    )
    for axis in axes:
        made.add_symmetry_plane(axis, 0.0)
    balance, solver = balanced(made, TIME)
    now = solver.ledger()
    assert now["internal_energy"] > 0.05 * energy(balance.start), "it has hit its image"
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13  # along the plane, where there is one only
    assert (by_id(solver, "x")[:, ["xy".index(a) for a in axes]] > 0.0).all()


LAGRANGIAN = [name for name, settings in SCHEMES.items() if isinstance(settings, LagrangianSettings)]
CONVERSION, CONTACT = Conversion(strain=0.08), Contact(stiffness=0.25)


def lopsided(dim, **options):
    """A collision with half of one ball of another material: no symmetry keeps its momentum."""
    made = collision(dim, **options)
    axis = min(dim, 2) - 1
    made.set_material("right", "steel", lambda x: x[:, axis] > x[:, axis].mean())
    return made


@pytest.mark.parametrize("contact", [None, CONTACT], ids=["kernel contact", "contact"])
@pytest.mark.parametrize("scheme", LAGRANGIAN)
def test_lagrangian_particles_conserve(scheme, contact):
    """Converting while they collide, with zero-energy control, in contact or not."""
    converts = {"conversion": CONVERSION} if "adaptle" in scheme else {}
    made = lopsided(2, scheme=scheme, speed=900.0, contact=contact, hourglass=5.0, **converts)
    balance, solver = balanced(made, TIME)
    assert solver.ledger()["internal_energy"] > 0.05 * energy(balance.start)
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13
    if converts:
        assert 0.1 < solver.tally()["converted_share"] < 1.0
    if contact:
        assert solver.ledger()["contact_work"] != 0.0


@pytest.mark.parametrize(
    ("dim", "scheme"), [(1, "tl"), (1, "adaptle-mixed-as"), (3, "tl"), (3, "adaptle-as")]
)
def test_lagrangian_particles_conserve_in_1d_and_3d(dim, scheme):
    converts = {"conversion": Conversion(strain=0.02)} if "adaptle" in scheme else {}
    made = lopsided(dim, scheme=scheme, radius=3.6, speed=900.0, contact=CONTACT, **converts)
    balance, solver = balanced(made, TIME)
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13
    assert (solver.tally()["converted_share"] > 0.0) == bool(converts)


@pytest.mark.parametrize("scheme", ["tl", "adaptle-as"])
def test_lagrangian_particles_conserve_to_single_precision(scheme):
    converts = {"conversion": CONVERSION} if "adaptle" in scheme else {}
    made = lopsided(2, scheme=scheme, speed=900.0, contact=CONTACT, **converts)
    balance, _ = balanced(made, TIME, precision="float32")
    assert balance.energy_error < 1e-5
    assert balance.momentum_error < 1e-5


@pytest.mark.filterwarnings("ignore:energy_error")  # which "eulerian" does not conserve
@pytest.mark.parametrize("stress", ["both", "none", "eulerian"])
def test_artificial_stress_at_the_interface(stress):
    """On both members of a pair, or on none, it conserves; on the Eulerian one alone it cannot."""
    made = scene(2, scheme="adaptle-as", interface_stress=stress)
    x = jittered(2, 12)
    made.add_body("body", x, ELASTIC, velocity=lambda x: 2e4 * (x - x.mean(axis=0)))
    made.make_eulerian("body", lambda x: x[:, 0] > 5.5 * SPACING)
    balance, solver = balanced(made, 4e-6)
    assert solver.ledger()["artificial_stress_work"] != 0.0
    assert (balance.momentum_error < 1e-13) == (stress != "eulerian")
    assert (balance.energy_error < 1e-13) == (stress != "eulerian")


def test_the_printed_coupling_does_not_conserve():
    """Each particle of a pair sums in a configuration of its own: momentum and energy drift where they are strained."""
    errors = []
    for coupling in ("printed", "conservative"):
        made = lopsided(2, scheme="adaptle", speed=900.0, conversion=CONVERSION, coupling=coupling)
        balance, solver = balanced(made, TIME)
        assert solver.tally()["converted_share"] > 0.1
        errors.append((balance.energy_error, balance.momentum_error))
    assert min(errors[0]) > 1e-4 and max(errors[0]) < 0.2
    assert max(errors[1]) < 1e-13


def turning(scheme, **numerics):
    """A disordered elastic patch that spins and is stretched."""
    made = scene(2, scheme=scheme, viscosity_alpha=0.0, viscosity_beta=0.0, **numerics)
    spin, squeeze = 2e4 * np.array([0.0, 0.0, 1.0]), np.diag([1e4, -2e4, 0.0])
    made.add_body(
        "patch", jittered(2, 12), ELASTIC, velocity=lambda x: np.cross(spin, x - 5.5 * SPACING) + x @ squeeze
    )
    return made


@pytest.mark.parametrize("hourglass", [0.0, 10.0])
def test_corrected_gradients_keep_angular_momentum(hourglass):
    """F is then the gradient of the positions, P Fᵀ is symmetric, and the control's forces are central; plain ones lose it."""
    errors = []
    for scheme in ("tl", "tl-plain"):
        balance, _ = balanced(turning(scheme, hourglass=hourglass), 1e-5)
        assert balance.energy_error < 1e-13 and balance.momentum_error < 1e-13
        errors.append(balance.angular_momentum_error)
    assert errors[0] < 1e-13
    assert errors[1] > 0.01


@pytest.mark.parametrize(
    ("scheme", "axes"), [("tl", "x"), ("tl", "xy"), ("adaptle-as", "x"), ("adaptle-mixed", "xy")]
)
def test_lagrangian_particles_conserve_energy_at_a_plane(scheme, axes):
    converts = {"conversion": Conversion(strain=0.03)} if "adaptle" in scheme else {}
    made = scene(2, scheme=scheme, hourglass=5.0, **converts)
    made.add_body(
        "block", Box((0.0, 0.0), (10 * SPACING, 8 * SPACING)), "aluminium", velocity=(-200.0, -100.0)
    )
    for axis in axes:
        made.add_symmetry_plane(axis, 0.0)
    balance, solver = balanced(made, TIME)
    assert solver.ledger()["internal_energy"] > 0.05 * energy(balance.start), "it has hit its image"
    assert balance.energy_error < 1e-13
    assert balance.momentum_error < 1e-13  # along the plane, where there is one only
    assert (by_id(solver, "x")[:, ["xy".index(a) for a in axes]] > 0.0).all()
    assert (not converts) or solver.tally()["converted_share"] > 0.0


@pytest.mark.parametrize("precision", REALS)
def test_mass_stays(precision):
    solver = run(collision(), TIME, precision=precision)
    np.testing.assert_allclose(
        by_id(solver, "m"), solver.data.m, rtol=1e-6 if precision == "float32" else 0.0
    )
