"""The guards at work: one look at all particles every so many steps, and what has been found so far."""

import copy
import math
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import warp as wp

from warpsph.clock import Reading
from warpsph.device.blocks import total
from warpsph.device.launch import Command
from warpsph.guards import Action, Guards
from warpsph.kernels.guards import (
    COLUMNS,
    CONSTRAINED,
    CONTACT,
    FINDINGS,
    GUARDS,
    LAGRANGIAN,
    SUMS,
    make_guards,
)
from warpsph.kernels.timestep import DONE, RUNNING, STALE
from warpsph.messages import stops
from warpsph.particles import Particles
from warpsph.scene import SceneData

from .penetration import cover_at, interpenetration
from .trouble import broken_fields, name_culprit

EVERY = 64
"""Steps between two looks: trouble is found within as many."""

FAR = 1e30
"""A corner of the domain where it has no end [m]."""


@dataclass(frozen=True)
class Glance:
    """What one look saw.

    Attributes:
        kinetic: Kinetic energy [J].
        internal: Internal energy [J].
        work: Work of constraints so far [J].
        particles: Particles beyond the limit, by guard.
        blocks: `warpsph.kernels.guards.FINDINGS` of each block and guard, shape [blocks, guards, findings].
    """

    kinetic: float
    internal: float
    work: float
    particles: dict[str, int]
    blocks: np.ndarray

    @property
    def energy(self) -> float:
        """What stays the same: the energy less the work of constraints [J]."""
        return self.kinetic + self.internal - self.work

    def energy_error(self, start: float) -> float:
        """Change of the energy from the start [J], over the largest energy that there is."""
        scale = max(abs(start), self.kinetic, abs(self.kinetic + self.internal))
        return abs(self.energy - start) / (scale or 1.0)

    def worst(self, guard: str) -> tuple[float, int]:
        """The largest value of a guard, and where in memory the first particle with it is."""
        _, value, index = self.blocks[:, GUARDS.index(guard)].T
        return float(value.max()), int(index[value == value.max()].min())


class Watch:
    """Looks after a run: ends it, or says so and counts, where there is trouble.

    It looks after the same steps however often a run is stopped and gone on with.

    Attributes:
        kernel: The kernel of a look.
        every: Steps between two looks.
        say: Takes a line about trouble that does not end the run.
        found: What there was, by guard, as summary.json has it.
    """

    def __init__(
        self,
        data: SceneData,
        particles: Particles,
        *,
        groups: frozenset[str],
        reach: float,
        bind: Callable[..., Command],
        blocks: int,
    ):
        """Prepare; nothing is launched before `begin`.

        Args:
            data: The scene.
            particles: The particles.
            groups: Groups of fields that the run has.
            reach: Reach of neighbour rows [m].
            bind: Binds a launch to the solver's arrays.
            blocks: Threads that share a look.
        """
        self._data, self._particles, self._bind, self._blocks = data, particles, bind, blocks
        self.every = EVERY
        self.say: Callable[[str], None] = lambda text: warnings.warn(text, stacklevel=2)
        self.found: dict[str, dict[str, Any]] = {}
        self._start: float | None = None
        self.kernel = make_guards(particles.spec)
        ball = {1: 2.0, 2: math.pi, 3: 4.0 / 3.0 * math.pi}[data.dim]
        self._row = ball * (reach / data.spacing) ** data.dim
        flags = {"contact": CONTACT, "lagrangian": LAGRANGIAN, "constraint": CONSTRAINED}
        self._has = sum(flag for group, flag in flags.items() if group in groups)
        with wp.ScopedDevice(particles.x.device):
            self._seen = wp.zeros((blocks, COLUMNS), dtype=wp.float64)
        self._set(data.guards)

    def _set(self, guards: Guards) -> None:
        """Go by these guards from now on."""
        self._guards, self._command = guards, None
        self._limits = {
            "density": 0.0,
            "energy_error": guards.energy_limit(self._data.numerics),
            "interpenetration": guards.interpenetration,
            "domain": 0.0,
            "neighbours": guards.neighbours * self._row,
            "inverted": 0.0,
        }

    def change(self, energy_limit: float | None = None, on_trouble: Action | None = None) -> None:
        """Go by other guards, see `warpsph.guards.Guards.changed`.

        Raises:
            InputError: A value is not allowed.
        """
        self._set(self._guards.changed(energy_limit, on_trouble))

    def begin(self) -> None:
        """Take the energy of the start, before the first step."""
        if self._start is None:
            self._start = self.glance().energy

    def allowed(self, steps: int) -> int:
        """Steps that may be taken, after so many, before it is time to look."""
        return self.every - steps % self.every

    def look(self, before: Reading, now: Reading) -> None:
        """Look at the particles if it is time to, or if the time has come that they are wanted for.

        Raises:
            RunError: A guard that ends the run has found something; names the worst particle.
        """
        due = now.steps % self.every == 0 or now.status == DONE
        if not due or now.steps == before.steps or now.status not in (RUNNING, STALE, DONE):
            return
        seen = self.glance()
        if seen.particles["state"]:
            _, first = seen.worst("state")
            culprit = name_culprit(self._particles, self._data, first, now)
            raise stops.not_finite(culprit, broken_fields(self._particles, first))
        error = seen.energy_error(self._start)
        errors = []
        for guard, limit in self._limits.items():
            if seen.particles[guard] or (guard == "energy_error" and not error <= limit):
                worst, index = seen.worst(guard)
                value = error if guard == "energy_error" else self._value(guard, worst)
                errors += self._note(guard, seen.particles[guard], value, index, now)
        if errors:
            raise errors[0]

    def glance(self) -> Glance:
        """Look at all particles."""
        if self._command is None:
            self._command = self._bind_look()
        self._command()
        seen = self._seen.numpy()
        sums = (total(seen[:, k]) for k in range(len(SUMS)))
        blocks = seen[:, len(SUMS) :].reshape(-1, len(GUARDS), len(FINDINGS))
        counts = blocks[:, :, 0].sum(axis=0).astype(int).tolist()
        return Glance(*sums, dict(zip(GUARDS, counts, strict=True)), blocks)

    def _bind_look(self) -> Command:
        data, guards = self._data, self._guards
        low, high = np.full(3, -FAR), np.full(3, FAR)
        if guards.domain is not None:
            low[: data.dim], high[: data.dim] = guards.domain
        point = self._particles.spec.point
        return self._bind(
            self.kernel, self._blocks, found=self._seen, has=self._has,
            low=point(*low), high=point(*high), most_neighbours=self._limits["neighbours"],
            most_cover=cover_at(guards.interpenetration, data.numerics.kernel, data.dim, data.h, data.spacing),
        )  # fmt: skip

    def _value(self, guard: str, worst: float) -> float:
        """A value of the kernel in the unit of the guard's limit."""
        data = self._data
        if guard == "interpenetration":
            return interpenetration(worst, data.numerics.kernel, data.dim, data.h, data.spacing)
        return -worst if guard == "density" else worst

    def _note(self, guard: str, particles: int, value: float, index: int, now: Reading) -> list[Exception]:
        """Count what a guard has found; gives what ends the run, if anything does."""
        action = "stop" if guard in self._guards.stop else "warn"
        if guard == "inverted":  # where it is to end the run, the device has done so
            action = "convert"
        limit, entry = self._limits[guard], self.found.get(guard)
        worse = entry is None or abs(value) > abs(entry["worst"]["value"])
        if worse or action == "stop":
            culprit = name_culprit(self._particles, self._data, index, now)
            case = {"value": value, **asdict(culprit)}
        if entry is None:
            entry = self.found[guard] = {"looks": 0, "particles": 0, "first": case}
            if action == "warn":
                self.say(stops.warned(culprit, guard, value, limit, particles))
        entry |= {
            "limit": limit,
            "action": action,
            "looks": entry["looks"] + 1,
            "particles": max(entry["particles"], particles),
        }
        if worse:
            entry["worst"] = case
        return [stops.guarded(culprit, guard, value, limit, particles)] if action == "stop" else []

    def report(self) -> dict[str, dict[str, Any]]:
        """What was found, by guard, for summary.json."""
        return copy.deepcopy(self.found)

    def warnings(self) -> list[str]:
        """A line for each guard that has warned."""
        return [
            stops.counted(guard, entry) for guard, entry in self.found.items() if entry["action"] == "warn"
        ]

    def save(self) -> dict[str, Any]:
        """Plain values that `restore` takes up again."""
        return {"guards": asdict(self._guards), "start": self._start, "found": self.report()}

    def restore(self, saved: dict[str, Any]) -> None:
        """Go on from what `save` gave.

        Raises:
            InputError: A limit in it is not allowed.
        """
        self._set(Guards(**saved["guards"]))
        self._start, self.found = saved["start"], saved["found"]
