"""Every guard: trouble of its kind is brought about, and reported in time, with the particle; what watching costs."""

import random
import re
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpsph import library, materials
from warpsph.config import Contact, Numerics
from warpsph.errors import RunError
from warpsph.guards import Guards
from warpsph.quality import report
from warpsph.quality.block import block
from warpsph.scene import Scene
from warpsph.shapes import Box, Disc, Sphere
from warpsph.solver import Solver
from warpsph.watching.watch import EVERY

from .trial import Findings, Means

SPACING = 1e-3
"""Spacing of the scenes [m]."""

RADIUS = 4.5 * SPACING
"""Radius of the balls [m]."""

GIVE_UP = 1000
"""Steps after which trouble counts as not found."""

MOST = 0.02
"""Largest share of a step that looking may cost."""

REPORTED = re.compile(
    r"t = \S+ s, step \d+: particle \d+ of body '\w+' \(material '[\w-]+'\) at \([^)]*\) m: \S.*; \S"
)
"""What every report holds, in one line: when, who, where, what, and what to do or what becomes of it."""

ELASTIC = materials.Material(
    "elastic", 2700.0, materials.LinearElastic(K=80e9), materials.Elastic(G=27e9), source="none"
)
"""A solid without heat: its temperature and energy do not come back as pressure."""

WATER = materials.Material(
    "water", 1000.0, materials.StiffenedGas(c0=1480.0, gamma0=2.0), materials.Fluid(), source="none"
)
"""A fluid, which has a sound speed even at a density below zero."""


@dataclass(frozen=True)
class Case:
    """One kind of trouble.

    Attributes:
        guard: Entry in the summary; ``""`` for what the device finds at the next step.
        name: What it is.
        how: How it comes about.
        make: Builds the scene of a dimension.
        spoil: Makes the trouble, if the scene does not.
        actions: What the user may have chosen.
        start: When it is made [s].
    """

    guard: str
    name: str
    how: str
    make: Callable[[int, str], Scene]
    spoil: Callable[[Solver], None] | None = None
    actions: tuple[str, ...] = ("stop", "warn")
    start: float = 1e-6


@dataclass
class Outcome:
    """What came of a trouble.

    Attributes:
        made: Steps taken when it was made.
        step: Steps taken when it was reported; -1: never.
        text: The report.
        entry: Entry in the summary.
        times: How often it was said.
    """

    made: int = 0
    step: int = -1
    text: str = ""
    entry: dict[str, Any] = field(default_factory=dict)
    times: int = 0


def run(means: Means) -> Findings:
    """Bring about every trouble with every action, in 2D, and in 3D unless ``quick``; then measure what looking costs."""
    found = Findings(("trouble", "how", "", "action", "steps until it was reported", "at most", "report"))
    for dim in (2,) if means.quick else (2, 3):
        for case in CASES:
            for action in case.actions:
                means.say(f"{case.name}, {dim}D, {action}")
                _try(case, dim, action, found)
    found.notes.append(
        f"Steps are counted from the first after which the trouble is there, which looking after every step tells. The guards "
        f"look after every {EVERY}th step and before every output; what the device checks itself it finds at the next step. "
        "A report is whole if it has time, step, particle, body, material, position, value, and what to do."
    )
    if not means.quick:
        _costs(means, found)
    return found


def _try(case: Case, dim: int, action: str, found: Findings) -> None:
    """Bring one trouble about, seen at every step and as usual."""
    truth, seen = (_bring_about(case, dim, action, every) for every in (1, EVERY))
    steps = seen.step - (truth.step if case.guard else truth.made)
    bound = EVERY if case.guard else 1
    name = f"{case.name}, {dim}D, {action}"
    whole = _whole(case, action, seen)
    if seen.step < 0:
        found.failed.append(f"{name}: not found")
    elif not 0 <= steps <= bound:
        found.failed.append(f"{name}: found after {steps} steps, at most {bound} are allowed")
    if not whole:
        found.failed.append(f"{name}: report {seen.text!r}, {seen.times} times, entry {seen.entry}")
    found.rows.append(
        (
            case.name,
            case.how,
            f"{dim}D",
            action,
            str(steps),
            str(bound),
            "whole" if whole else "**not whole**",
        )
    )


def _whole(case: Case, action: str, seen: Outcome) -> bool:
    """Whether the user was told what there is to tell, once, and the summary has it too."""
    told = action == "convert" or (
        seen.times == 1 and bool(REPORTED.search(seen.text)) and "\n" not in seen.text
    )
    if not case.guard or case.guard == "state":
        return told
    keys = {"action", "limit", "looks", "particles", "first", "worst"}
    return told and seen.entry.keys() == keys and seen.entry["action"] == action


def _bring_about(case: Case, dim: int, action: str, every: int) -> Outcome:
    """Run a scene into trouble; what is reported, and when."""
    solver = Solver(case.make(dim, action).finalize())
    solver.watch.every = every
    said: list[str] = []
    solver.watch.say = said.append
    seen = Outcome()
    if case.spoil is not None:
        solver.advance(case.start)
        case.spoil(solver)
        seen.made = solver.reading.steps
    try:
        solver.advance(1.0, lambda now: case.guard in solver.watch.found or now.steps > GIVE_UP)
    except RunError as error:
        said.append(str(error))
        seen.step = solver.reading.steps
    seen.entry = solver.watch.report().get(case.guard, {})
    if seen.entry:
        seen.step = seen.entry["first"]["step"]
    seen.text, seen.times = "".join(said[:1]), len(said)
    return seen


def _guards(guard: str, action: str, **limits: Any) -> Guards:
    return Guards(stop=(guard,) if action == "stop" else (), **limits)


def _balls(
    dim: int,
    guards: Guards,
    velocity: tuple[float, ...] = (400.0,),
    material: materials.Material = ELASTIC,
    **numerics: Any,
) -> Scene:
    """A ball beside another, a support apart."""
    scene = Scene("balls", dim=dim, spacing=SPACING, until=1.0, numerics=Numerics(**numerics), guards=guards)
    ball, away = {2: Disc, 3: Sphere}[dim], RADIUS + 1.2 * SPACING
    rest = (0.0,) * (dim - 1)
    scene.add_body("left", ball(RADIUS, (-away, *rest)), material, velocity=(*velocity, 0.0, 0.0)[:dim])
    scene.add_body("right", ball(RADIUS, (away, *rest)), "aluminium")
    return scene


def _plain(dim: int, action: str) -> Scene:
    """Two balls; all guards do the same."""
    return _balls(dim, Guards().changed(on_trouble=action))


def _wet(dim: int, action: str) -> Scene:
    """The same, and one is of water."""
    return _balls(dim, Guards().changed(on_trouble=action), material=WATER)


def _soft(dim: int, action: str) -> Scene:
    """Balls so soft that one goes through the other."""
    contact = Contact(stiffness=1e-4)
    return _balls(dim, _guards("interpenetration", action), (1500.0,), contact=contact)


def _thrown(dim: int, action: str) -> Scene:
    """A ball that flies out of the domain."""
    reach = 2.0 * RADIUS + 3.0 * SPACING
    high = (reach, RADIUS + 3.0 * SPACING, reach)[:dim]
    guards = _guards("domain", action, domain=((-reach,) * dim, high))
    return _balls(dim, guards, (0.0, 500.0))


def _crowd(dim: int, action: str) -> Scene:
    """A ball all of whose particles are driven to its centre."""
    guards = _guards("neighbours", action, neighbours=1.5)
    scene = Scene("crowd", dim=dim, spacing=SPACING, until=1.0, guards=guards)
    shape = {2: Disc, 3: Sphere}[dim](RADIUS, (0.0,) * dim)
    scene.add_body("ball", shape, ELASTIC, velocity=lambda x: -2e4 * x)
    scene.fix("ball")
    return scene


def _crushed(dim: int, action: str) -> Scene:
    """A block whose particles are driven to a plane."""
    numerics = Numerics(scheme="adaptle", inverted=action)
    scene = Scene("crushed", dim=dim, spacing=SPACING, until=1.0, numerics=numerics)
    cube = Box((0.0,) * dim, (9.0 * SPACING,) * dim)
    scene.add_body(
        "block", cube, "aluminium", velocity=lambda x: -1e9 * (x - 4.5 * SPACING) * [1.0, 0.0, 0.0]
    )
    scene.fix("block")
    return scene


def _poke(name: str, change: Callable[[np.ndarray], object]) -> Callable[[Solver], None]:
    """Change a field of the particle in the middle of the ids of the first body."""

    def spoil(solver: Solver) -> None:
        particles = solver.particles
        place = np.flatnonzero(particles.id.numpy() == int((solver.data.body == 0).sum()) // 2)[0]
        array = getattr(particles, name)
        values = array.numpy().copy()
        values[place] = change(values[place])
        array.assign(values)

    return spoil


def _flatten(solver: Solver) -> None:
    """All but turn a particle over."""
    _poke("F", lambda F: np.diag([0.0101, 1.0, 1.0]))(solver)


CASES = (
    Case("", "velocity not finite", "set", _plain, _poke("v", lambda v: np.nan * v), ("stop",)),
    Case("state", "temperature not finite", "set", _plain, _poke("T", lambda T: np.nan), ("stop",)),
    Case("", "time step", "wave speed set to 1e20 m/s", _plain, _poke("cl", lambda cl: 1e20), ("stop",)),
    Case("density", "density below zero", "set to -700 kg/m³", _wet, _poke("rho", lambda rho: -700.0)),
    Case("energy_error", "energy error", "a particle heated", _plain, _poke("e", lambda e: e + 2e5)),
    Case("interpenetration", "interpenetration", "a contact too soft", _soft),
    Case("domain", "out of the domain", "a body thrown out", _thrown),
    Case("neighbours", "neighbours", "a body driven to a point", _crowd),
    Case("", "turned over (J <= 0)", "F set, driven on", _crushed, _flatten, ("stop",), 0.0),
    Case("inverted", "turned over (J <= 0)", "F set, driven on", _crushed, _flatten, ("convert",), 0.0),
)
"""Every trouble, with how it is brought about."""


def _costs(means: Means, found: Findings) -> None:
    """Process time of a look, and of steps with looks and without."""
    scenes = {
        "hvi_2d": lambda: library.load("hvi_2d").build(),
        "hvi_2d, spacing 0.4 mm": lambda: library.load("hvi_2d").build(spacing=4e-4),
        "block, 3D": lambda: block(3, 20000),
    }
    rows = []
    for name, make in scenes.items():
        means.say(f"cost: {name}")
        n, step, look, ratio = _cost(make())
        share = look / (EVERY * step)
        rows.append(
            (name, f"{n:,}", f"{1e3 * step:.3g}", f"{1e3 * look:.3g}", f"{share:.2%}", f"{ratio:.3f}")
        )
        if share > MOST:
            found.failed.append(f"{name}: looking costs {share:.1%} of a step, at most {MOST:.0%} is allowed")
    header = (
        "scene",
        "particles",
        "step [ms]",
        "look [ms]",
        "share of a step",
        "steps with looks over without",
    )
    found.notes.append(report.markdown(header, rows))
    found.notes.append(
        "All guards share one pass over the particles, so this is what one costs and what all cost together. Process time "
        "on one thread, float64; medians, the last column's of rounds of both in turn."
    )


def _cost(scene: Scene) -> tuple[int, float, float, float]:
    """Particles, process time of a step and of a look [s], and the ratio of steps with looks and without."""
    solver = Solver(scene.finalize(), threads=1)
    solver.prepare()
    looks = []
    for _ in range(50):
        start = time.process_time()
        solver.watch.glance()
        looks.append(time.process_time() - start)
    spent: dict[int, list[float]] = {EVERY: [], 10**9: []}
    order = list(spent)
    end = time.monotonic() + 25.0
    while time.monotonic() < end:
        random.Random(len(spent[EVERY])).shuffle(order)
        for every in order:
            solver.watch.every = every
            first, start = solver.reading.steps, time.process_time()
            solver.advance(1.0, lambda now, last=first + EVERY: now.steps >= last)
            spent[every].append((time.process_time() - start) / (solver.reading.steps - first))
    with_looks, without = (statistics.median(spent[every]) for every in (EVERY, 10**9))
    return solver.particles.n, without, statistics.median(looks), with_looks / without
