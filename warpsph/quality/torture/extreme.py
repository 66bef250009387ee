"""Extreme physics: particles alone, in twos, in lines, at one place; 20 km/s; a million in density; units huge and tiny."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from warpsph import materials as lib
from warpsph.config import Contact, Numerics
from warpsph.errors import RunError
from warpsph.scene import Scene
from warpsph.shapes import Box
from warpsph.solver import Solver

from .trial import Findings, Means

SPACING = 1e-3
"""Particle spacing of every scene [m], in its own units."""

ALUMINIUM = lib.Material(
    "aluminium", 2785.0, lib.StiffenedGas(c0=5328.0, gamma0=2.0), lib.PerfectlyPlastic(G=27.6e9, Y=0.3e9)
)
ELASTIC = lib.Material("elastic", 2700.0, lib.LinearElastic(K=80e9), lib.Elastic(G=27e9))
LIGHT = lib.Material("light", 2.7e-3, lib.LinearElastic(K=80e3), lib.Elastic(G=27e3))

CONTACT = "adaptle, contact"
"""Name of the scheme with contact in the tables."""

FAMILIES = (
    "sav1", "sav1-as", "sav1-mixed", "sav1-mixed-as", "bal", "mon", "av", "pm", "pm-mixed", "ts1", "ts2", "ts2-mixed",
    "tl", "tl-plain", "adaptle", "adaptle-mixed", CONTACT, "av-explicit", "pm-explicit",
)  # fmt: skip
"""Schemes that the cases run with, one for each family of kernels and more."""

QUICK = ("sav1", "sav1-mixed", "pm", "ts2", "tl", CONTACT)
"""Those of the tests."""

SPLIT_MIXED = ("ts1-mixed", "ts2-mixed")
"""Time-split schemes with correction: fragments at a kilometre per second are beyond them."""

GODUNOV = tuple(scheme for scheme in FAMILIES if scheme[:2] in ("pm", "ts"))
"""Those with Riemann problems in place of a viscosity: their density follows the interfaces, and lags in strong shocks."""

VISCOUS = tuple(scheme for scheme in FAMILIES if scheme not in GODUNOV)
"""Those with an artificial viscosity."""

FASTEST = tuple(scheme for scheme in FAMILIES if scheme not in (*SPLIT_MIXED, CONTACT))
"""Schemes that bear 50 km/s: with contact Total Lagrangian particles turn over."""

UNBALANCED = ("sav1-mixed-as", "bal", "mon", "ts1", *SPLIT_MIXED)
"""Schemes that do not bear a density ratio of a million."""

ROUND_OFF = {"float64": 1e-11, "float32": 2e-4, "mixed": 2e-4}
"""What errors of energy and momentum may come to over a run."""


@dataclass(frozen=True)
class Outcome:
    """What a run came to.

    Attributes:
        finite: Every number of its state is.
        energy: Error of energy over the total.
        momentum: Error of momentum over Σ m |v| at the start.
        figure: What the case is about.
    """

    finite: bool
    energy: float
    momentum: float
    figure: float


@dataclass(frozen=True)
class Case:
    """Something extreme.

    Attributes:
        name: What it is.
        run: Makes the run of a scheme in a dimension and a precision.
        figure: What its figure is.
        largest: The largest figure that is sensible.
        schemes: Schemes that it is for.
        dims: Dimensions.
    """

    name: str
    run: Callable[[str, int, str], Outcome]
    figure: str
    largest: float
    schemes: tuple[str, ...] = FAMILIES
    dims: tuple[int, ...] = (1, 2, 3)


def run(means: Means) -> Findings:
    """Run every case with every scheme that it is for; quick: a few schemes, two dimensions, double precision."""
    found = Findings(
        ("case", "runs", "finite", "energy", "momentum", "what is looked at", "found", "sensible up to")
    )
    found.notes.append(
        "Largest errors and figures of all runs of a case: schemes of every family, in one, two and three dimensions and "
        "in double precision, in 2D in single precision too. Errors of energy are without the `-explicit` schemes, which "
        "lose it as published; energy and momentum are those of double precision."
    )
    found.notes.append(
        f"Not tried, for they do not bear it: fragments of one to three particles that hit each other at a kilometre per "
        f"second, and 50 km/s, with {' and '.join(SPLIT_MIXED)}; 50 km/s with Total Lagrangian particles in contact; a "
        f"density ratio of a million in the equations of motion with {', '.join(UNBALANCED)}."
    )
    for case in CASES:
        runs = [
            (scheme, dim, precision)
            for precision in (("float64",) if means.quick else ("float64", "float32"))
            for dim in (
                case.dims if precision == "float64" and not means.quick else (min(2, max(case.dims)),)
            )
            for scheme in case.schemes
            if not means.quick or scheme in QUICK
        ]
        means.say(f"{case.name}: {len(runs)} runs")
        found.rows.append(_judge(case, runs, found.failed))
    return found


def _judge(case: Case, runs: Sequence[tuple[str, int, str]], failed: list[str]) -> tuple[str, ...]:
    """Make the runs of a case; the row of the table, and what did not hold."""
    energy, momentum, figure, finite = 0.0, 0.0, 0.0, 0
    for scheme, dim, precision in runs:
        what = f"{case.name}, {scheme} in {dim}D, {precision}"
        try:
            outcome = case.run(scheme, dim, precision)
        except RunError as error:
            failed.append(f"{what}: {error}")
            continue
        explicit, limit = "explicit" in scheme, ROUND_OFF[precision]
        finite += outcome.finite
        if precision == "float64":
            energy = max(energy, 0.0 if explicit else outcome.energy)
            momentum = max(momentum, outcome.momentum)
        figure = max(figure, outcome.figure)
        if not outcome.finite:
            failed.append(f"{what}: not finite")
        if (outcome.energy > limit and not explicit) or outcome.momentum > limit:
            failed.append(
                f"{what}: energy is off by {outcome.energy:.1e}, momentum by {outcome.momentum:.1e}"
            )
        if not outcome.figure <= case.largest:
            failed.append(f"{what}: {case.figure} is {outcome.figure:.3g}, sensible is {case.largest:g}")
    errors = (f"{energy:.1e}", f"{momentum:.1e}")
    return case.name, str(len(runs)), str(finite), *errors, case.figure, f"{figure:.2g}", f"{case.largest:g}"


def lone(scheme: str, dim: int, precision: str) -> Outcome:
    """A particle alone at 20 km/s: how far off its straight line, and its density off the first one."""
    scene = _scene(scheme, dim)
    scene.add_body("lone", _points(dim, (0.3, 0.2, 0.1)), ALUMINIUM, velocity=_along(dim, 2e4))
    time = 1e-6
    return _outcome(
        scene, precision, time, lambda s, x, v: float(np.abs(x - s.data.x - time * s.data.v).max()) / SPACING
    )


def two(scheme: str, dim: int, precision: str) -> Outcome:
    """Two particles that meet at 1 km/s: how far the one is from being the mirror image of the other."""
    scene = _scene(scheme, dim)
    apart = 0.5 * (1.0 if scheme != CONTACT else 3.0)
    line = np.array(_along(dim, 1.0))
    scene.add_body("a", -apart * SPACING * line[None, :], ALUMINIUM, velocity=500.0 * line)
    scene.add_body("b", apart * SPACING * line[None, :], ALUMINIUM, velocity=-500.0 * line)
    return _outcome(
        scene, precision, 3e-6, lambda s, x, v: float(np.abs(v[0] + v[1]).max() + np.abs(x[0] + x[1]).max())
    )


def bullet(scheme: str, dim: int, precision: str) -> Outcome:
    """A body of one particle hits a block at 3 km/s: its speed at the end over that at the start."""
    scene = _scene(scheme, dim)
    scene.add_body("block", _block(dim, 0, 8), ALUMINIUM)
    scene.add_body("bullet", _points(dim, (-2.5, 2.7, 2.6)), ALUMINIUM, velocity=(3000.0, 0.0, 0.0))
    return _outcome(scene, precision, 4e-6, lambda s, x, v: float(np.linalg.norm(v[-1])) / 3000.0)


def coincident(scheme: str, dim: int, precision: str) -> Outcome:
    """Two pairs of particles come to one place: the largest acceleration over c²/h while they are there."""
    scene = _scene(scheme, dim)
    x = _lattice(dim, 5)
    v = np.random.default_rng(1).normal(size=x.shape) * 100.0 * (np.arange(3) < dim)
    scene.add_body("block", x, ELASTIC, velocity=v)
    solver = Solver(scene.finalize(), precision=precision)
    ids, moved = solver.particles.id.numpy(), x.copy()
    moved[3], moved[4] = x[1], x[2] + 1e-12 * SPACING * (np.arange(3) < dim)
    solver.particles.x.assign(moved[ids])
    solver.relist()
    solver.advance(1e-9)
    largest = float(np.linalg.norm(solver.particles.dvdt.numpy(), axis=1).max())
    return _after(solver, 1e-6, lambda s, x, v: largest * s.data.h / 6000.0**2)


def line(scheme: str, dim: int, precision: str) -> Outcome:
    """Particles in a line, in 3D in a sheet, are stretched and turned: the highest speed over that at the start."""
    scene = _scene(scheme, dim)
    x = _lattice(dim - 1, 6) if dim > 2 else np.arange(8.0)[:, None] * SPACING * np.array(_along(dim, 1.0))
    v = 1e5 * x + np.cross((0.0, 0.0, 1e5), x) * (dim > 1)
    scene.add_body("line", x, ELASTIC, velocity=v)
    fastest = float(np.linalg.norm(v, axis=1).max())
    return _outcome(scene, precision, 4e-6, lambda s, x, v: float(np.linalg.norm(v, axis=1).max()) / fastest)


def fragments(scheme: str, dim: int, precision: str) -> Outcome:
    """Fragments of one to three particles meet at 1 km/s: what the coldest has lost over the kinetic energy at the start."""
    scene, draw = _scene(scheme, dim), np.random.default_rng(3)
    shape = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0) if dim > 1 else (2.0, 0.0, 0.0)])
    for k in range(12):
        place = (
            np.array((3.0 * (k % 4), 3.0 * (k // 4), 2.4 * (k % 3)))
            if dim > 1
            else np.array((5.0 * k, 0.0, 0.0))
        )
        x = (place * (np.arange(3) < dim) + shape[: k % 3 + 1]) * SPACING
        scene.add_body(f"f{k}", x, ALUMINIUM, velocity=draw.normal(size=3) * 800.0 * (np.arange(3) < dim))

    def lost(s: Solver, x: np.ndarray, v: np.ndarray) -> float:
        kinetic = float(np.sum(s.data.m * (s.data.v**2).sum(axis=1)) / (2.0 * s.data.m.sum()))
        return max(0.0, -float(s.particles.e.numpy().min())) / kinetic

    return _outcome(scene, precision, 1e-5, lost)


def fast(scheme: str, dim: int, precision: str) -> Outcome:
    """Aluminium hits aluminium at 20 km/s: how far the pressure behind the shocks is from that of the Hugoniot [-]."""
    speed, n = 2e4, 100
    riemann = "two-shock" if scheme in GODUNOV else "acoustic"  # which is for weak shocks
    scene = _scene(scheme, 1, riemann=riemann)
    scene.add_body("left", Box((-1.5 - n) * SPACING, -1.5 * SPACING), ALUMINIUM, velocity=(speed, 0.0, 0.0))
    scene.add_body("right", Box(1.5 * SPACING, (1.5 + n) * SPACING), ALUMINIUM)
    wave, exact = hugoniot(0.5 * speed)
    time = 3.0 * SPACING / speed + 0.5 * n * SPACING / wave

    def off(s: Solver, x: np.ndarray, v: np.ndarray) -> float:
        p = s.particles.p.numpy()[np.argsort(s.particles.id.numpy())]
        return abs(float(np.median(np.concatenate((p[n - 20 : n - 4], p[n + 4 : n + 20])))) / exact - 1.0)

    return _outcome(scene, precision, time, off)


def faster(scheme: str, dim: int, precision: str) -> Outcome:
    """A small block hits another at 50 km/s: the highest speed of a particle over that."""
    scene = _scene(scheme, dim)
    scene.add_body("left", _block(dim, -8, 0), ALUMINIUM, velocity=(5e4, 0.0, 0.0))
    scene.add_body("right", _block(dim, 3, 11), ALUMINIUM)
    return _outcome(scene, precision, 2.5e-7, lambda s, x, v: float(np.linalg.norm(v, axis=1).max()) / 5e4)


def ratio(scheme: str, dim: int, precision: str) -> Outcome:
    """A body hits one a million times lighter at 500 m/s: how far the light one is in the heavy one, in its length."""
    scene = _scene(scheme, dim)
    scene.add_body("light", _block(dim, -8, 0), LIGHT)
    scene.add_body("heavy", _block(dim, 3, 11), ELASTIC, velocity=(-500.0, 0.0, 0.0))

    def depth(s: Solver, x: np.ndarray, v: np.ndarray) -> float:
        light = s.data.body == 0
        return max(0.0, float(x[light, 0].max() - x[~light, 0].min()) / (8.0 * SPACING))

    return _outcome(scene, precision, 1e-5, depth)


def rest(scheme: str, dim: int, precision: str) -> Outcome:
    """A block at rest, its particles off the lattice: how far any of them has moved in 200 steps."""
    scene = _scene(scheme, dim)
    x = _lattice(dim, 5)
    x += SPACING * np.random.default_rng(2).uniform(-0.2, 0.2, x.shape) * (np.arange(3) < dim)
    scene.add_body("block", x, ELASTIC)
    solver = Solver(scene.finalize(), precision=precision)
    start = solver.state().x.copy()
    return _after(solver, 2e-5, lambda s, x, v: float(np.abs(x - start).max() + np.abs(v).max()))


def units(scheme: str, dim: int, precision: str) -> Outcome:
    """An impact in other units and sizes, from nanometres to 1000 km: how far the velocities are from those in SI units."""
    single = precision != "float64"
    sizes = [(1e3, 1e6, 1e6), (1e-3, 1e-3, 1e-9), (1e9, 1e9, 1e27)] + [(1e-6, 1e-6, 1e-18)] * (not single)
    runs = [_impact(scheme, dim, precision, *size) for size in [(1.0, 1.0, 1.0), *sizes]]
    apart = max(float(np.abs(other - runs[0][1]).max()) for _, other in runs[1:]) / 1500.0
    return replace(runs[0][0], figure=apart / (1.0 if single else 1e-9 / 1e-4))


def far(scheme: str, dim: int, precision: str) -> Outcome:
    """The same impact 1e6 spacings from the origin in mixed precision: how far the velocities are from those at it."""
    (_, here), (there, moved) = (_impact(scheme, dim, "mixed", 1.0, 1.0, 1.0, by) for by in (0.0, 1e6))
    return replace(there, figure=float(np.abs(moved - here).max()) / 1500.0, energy=0.0, momentum=0.0)


def hugoniot(jump: float) -> tuple[float, float]:
    """Speed [m/s] and pressure [Pa] of a shock into `ALUMINIUM` at rest that jumps the velocity by ``jump`` [m/s].

    p = ρ0 Us u, ρ = ρ0 Us/(Us - u) and e = u²/2 in p = c0² (ρ - ρ0) + (γ0 - 1) ρ e: Us² - (γ0 + 1)/2 u Us - c0² = 0.
    """
    c0, half = ALUMINIUM.eos.c0, 0.25 * (ALUMINIUM.eos.gamma0 + 1.0) * jump
    wave = half + math.sqrt(half**2 + c0**2)
    return wave, ALUMINIUM.density * wave * jump


def _impact(
    scheme: str, dim: int, precision: str, length: float, time: float, mass: float, off: float = 0.0
) -> tuple[Outcome, np.ndarray]:
    """Two blocks meet at 1.5 km/s, with units that much smaller; velocities are given in SI units, shape [n, 3]."""
    pressure, velocity = mass / (length * time**2), length / time
    strength = lib.PerfectlyPlastic(G=27.6e9 * pressure, Y=0.3e9 * pressure)
    eos = lib.StiffenedGas(c0=5328.0 * velocity, gamma0=2.0)
    material = lib.Material("aluminium", 2785.0 * mass / length**3, eos, strength)
    scene = _scene(scheme, dim, length)
    for name, cells, speed in (("left", (-6, 0), 1500.0), ("right", (3, 9), 0.0)):
        x = _lattice(dim, 6 if dim < 3 else 4)
        x[:, 0] += (cells[0] + off) * SPACING
        scene.add_body(name, x * length, material, velocity=(speed * velocity, 0.0, 0.0))
    solver = Solver(scene.finalize(), precision=precision)
    outcome = _after(solver, 2e-6 * time, lambda s, x, v: 0.0)
    return outcome, solver.state().v / velocity


def _scene(scheme: str, dim: int, length: float = 1.0, riemann: str = "acoustic") -> Scene:
    """Start a scene in a unit of length that much smaller than a metre."""
    contact = Contact(stiffness=0.25) if scheme == CONTACT else None
    numerics = Numerics(scheme=scheme.split(",", maxsplit=1)[0], contact=contact, riemann=riemann)
    return Scene("extreme", dim=dim, spacing=SPACING * length, until=1.0, numerics=numerics)


def _outcome(scene: Scene, precision: str, time: float, figure: Callable) -> Outcome:
    return _after(Solver(scene.finalize(), precision=precision), time, figure)


def _after(solver: Solver, time: float, figure: Callable) -> Outcome:
    """Run to a time [s] and look; ``figure`` is of the solver, the positions [m] and velocities [m/s]."""
    before = solver.ledger()
    solver.watch.say = lambda text: None  # what is sensible is for the case to say
    solver.advance(time)
    now, state = solver.ledger(), solver.state()
    total = [sum(ledger[f"{kind}_energy"] for kind in ("kinetic", "internal")) for ledger in (before, now)]
    push = np.array([now[f"momentum_{a}"] - before[f"momentum_{a}"] for a in "xyz"])
    carried = float(np.sum(solver.data.m * np.linalg.norm(solver.data.v, axis=1)))
    fields = (state.x, state.v, state.rho, state.e, state.p, state.tau)
    return Outcome(
        finite=all(bool(np.isfinite(values).all()) for values in fields),
        energy=abs(total[1] - total[0]) / (abs(total[0]) or 1.0),
        momentum=float(np.linalg.norm(push)) / (carried or 1.0),
        figure=figure(solver, state.x, state.v),
    )


def _along(dim: int, speed: float) -> tuple[float, ...]:
    """A vector of that length, off the axes."""
    direction = np.array((1.0, 0.5, 0.25)) * (np.arange(3) < dim)
    return tuple(speed * direction / np.linalg.norm(direction))


def _points(dim: int, place: Sequence[float]) -> np.ndarray:
    """A point given in spacings [m], shape [1, 3]."""
    return SPACING * (np.array(place) * (np.arange(3) < dim))[None, :]


def _lattice(dim: int, n: int) -> np.ndarray:
    """Points of a lattice of n^dim [m], shape [n^dim, 3]."""
    x = np.zeros((n**dim, 3))
    x[:, :dim] = np.stack(np.meshgrid(*[np.arange(n)] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    return SPACING * x


def _block(dim: int, low: int, high: int) -> np.ndarray:
    """A block between two places on the x axis, in spacings, and five wide [m], shape [n, 3]."""
    x = np.array([(i, *cross) for i in range(low, high) for cross in np.ndindex(*[5] * (dim - 1))])
    return SPACING * np.pad(x + 0.5, ((0, 0), (0, 3 - dim)))


CASES = (
    Case("one particle, 20 km/s", lone, "off the straight line [spacings]", 1e-2),
    Case("two particles meet", two, "off each other's mirror image", 0.0),
    Case("a body of one particle hits a block", bullet, "speed left", 0.6),
    Case("particles at one place", coincident, "largest acceleration over c²/h", 2.0),
    Case("a line, a sheet, stretched and turned", line, "highest speed over that at the start", 1.05),
    Case(
        "fragments of one to three particles", fragments, "energy lost over kinetic energy", 8.0,
        tuple(scheme for scheme in FAMILIES if scheme not in SPLIT_MIXED),
    ),
    Case("20 km/s, viscosity", fast, "pressure off the Hugoniot", 0.05, VISCOUS, (1,)),
    Case("20 km/s, Riemann problems", fast, "pressure off the Hugoniot", 0.2, GODUNOV, (1,)),
    Case("50 km/s", faster, "highest speed over that of the impact", 2.0, FASTEST),
    Case(
        "a density ratio of a million", ratio, "light one in the heavy one [its lengths]", 1.0,
        tuple(scheme for scheme in FAMILIES if scheme not in UNBALANCED),
    ),
    Case("at rest for 200 steps", rest, "movement", 0.0),
    Case("other units: mm-mg-µs, µm, nm, 1000 km", units, "off SI units [1e-9; float32: 1e-4]", 1e-4),
    Case("1e6 spacings from the origin, mixed", far, "off the origin", 1e-4, ("sav1", "pm", "tl"), (2,)),
)  # fmt: skip
"""The cases, in the order of the table."""
