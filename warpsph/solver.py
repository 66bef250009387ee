"""The controller: owns the device state, runs steps in batches, rebuilds neighbour rows, watches for trouble."""

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import warp as wp

from .clock import Clock, Reading
from .contact import contact_constants
from .device.blocks import CUDA_STEP_BLOCKS, Blocks, total
from .device.compilation import compile_modules, kernels_of
from .device.copies import fits, host_shape, make_room, to_device, to_host
from .device.launch import Command, Launcher
from .device.program import Program
from .kernels.kernel_type import ERODED, EULERIAN
from .kernels.ledger import MAXIMA, SUMS
from .kernels.sort import make_sort
from .kernels.spec import Spec
from .kernels.timestep import COLLAPSED, INSIDE_OUT, NON_FINITE, RUNNING, STALE
from .materials import pack
from .memory.admission import admit
from .memory.need import estimate
from .memory.policy import Policy, policy_of
from .messages import restarts, values
from .particles import Particles
from .scene import SceneData
from .schemes.factory import make_scheme
from .search.neighbours import Neighbours
from .search.reference import Reference
from .state import State
from .watching.magnitudes import check_magnitudes
from .watching.penetration import interpenetration
from .watching.trouble import explain
from .watching.watch import Watch

MAX_BATCH = 32
"""Steps between two readings of the device's clock, at most: the documented synchronisation interval."""

BATCH_PARTICLES = {False: 4_000_000, True: 400_000_000}
"""Particle-steps between two readings at most, on a CPU and on CUDA: a few seconds, for a run that is told to stop."""

PRECISIONS = {
    "float32": (wp.float32, wp.float32),
    "float64": (wp.float64, wp.float64),
    "mixed": (wp.float32, wp.float64),
}
"""Scalar types, and those of positions, by name."""


class Solver:
    """A scene in motion on one device.

    Attributes:
        data: The finalised scene.
        need: What it was estimated to need of memory.
        launcher: The device and its threads.
        particles: The state.
        neighbours: The neighbour rows.
        program: The launches of a step.
        watch: The guards.
        reading: The clock at the last reading.
    """

    def __init__(
        self,
        data: SceneData,
        *,
        device: str = "cpu",
        precision: str = "float64",
        threads: int | None = None,
        policy: Policy | None = None,
        copies: int = 0,
        say: Callable[[str], None] | None = None,
    ):
        """Allocate everything, if it fits; no step allocates afterwards, except neighbour rows that outgrow their storage.

        Args:
            data: The finalised scene.
            device: Name of the device.
            precision: One of `PRECISIONS`.
            threads: CPU threads; None: as many as there are cores.
            policy: What memory may be spent on; None: the device's.
            copies: Copies of the state on the host that outputs may take at a time: to be held against its memory too.
            say: Takes one line, what all of this needs of memory, before anything is allocated.

        Raises:
            InputError: No such device or precision, no memory for it (says what would fit), or the scene's numbers do not
                fit into the precision.
        """
        if precision not in PRECISIONS:
            raise values.unknown("precision", precision, PRECISIONS)
        self.data, self.precision = data, precision
        self.launcher = Launcher(device, threads)
        self._policy = policy or policy_of(self.launcher.device)
        self._spec = Spec(data.dim, *PRECISIONS[precision], lanes=self._policy.lanes)
        check_magnitudes(data, self._spec, precision)
        h = data.h
        self._scheme = make_scheme(data, self._spec)
        self.need = estimate(data, self._spec, self._scheme, self._policy, self.launcher.device, copies)
        admit(data, self.need, self._spec, self.launcher.device, say)
        self.particles = Particles(data, self._spec, self.launcher, self._scheme.groups, self._scheme.parts)
        n, cuda = self.particles.n, self.launcher.device.is_cuda
        self._blocks, self._step_blocks = Blocks(n, cuda), Blocks(n, cuda, CUDA_STEP_BLOCKS if cuda else None)
        self._clock = Clock(self._spec, self.launcher, self._step_blocks)
        self.neighbours = Neighbours(
            self.particles,
            self.launcher,
            data.planes,
            self._policy,
            x=data.x,
            spacing=data.spacing,
            support=self._scheme.support * h,
            skin=data.numerics.skin * h,
            selective="lagrangian" in self._scheme.groups,
            erosion=data.numerics.erosion,
            searching=self._scheme.searching,
        )
        self.reference = self._find_reference()
        self._constants = SimpleNamespace(h=h, spacing=data.spacing, cfl=data.numerics.cfl)
        self._work = self._allocate_work()
        self.program = Program(self.launcher, self._spec)
        self.watch = Watch(
            data, self.particles, groups=self._scheme.groups, reach=self.neighbours.radius,
            bind=self._bind, blocks=self._blocks.count,
        )  # fmt: skip
        self._bound = -1
        self._batch = 1  # steps until the next reading of the clock
        self.neighbours.block.let_go = self._drop_step
        self._initialise()
        self.reading = self._clock.read()

    def _find_reference(self) -> Reference | None:
        """Give the scheme its reference neighbours, if it has Lagrangian particles."""
        if "lagrangian" not in self._scheme.groups:
            return None
        s = self._scheme
        s.reference = Reference(
            self.particles, self.launcher, self.neighbours, s.smoothing, s.reference_correction, self._policy
        )
        return s.reference

    def _allocate_work(self) -> SimpleNamespace:
        """Arrays that live from one launch to the next but are no state."""
        with wp.ScopedDevice(self.launcher.device):
            modulus, scale = contact_constants(self.data)
            young = [material.young_modulus for material in self.data.materials]
            return SimpleNamespace(
                stiffness=wp.array(young, dtype=self._spec.real),
                contact_modulus=wp.array(modulus, dtype=self._spec.real),
                contact_scale=scale,
                materials=pack(self.data.materials, self._spec, self.launcher.device),
                partial=wp.zeros((self._blocks.count, len(SUMS) + len(MAXIMA)), dtype=wp.float64),
                **self._scheme.arrays(self.particles.n),
            )

    def _bind(self, kernel, blocks: int | None = None, **named: object) -> Command:
        """Bind a launch over all particles, or over ``blocks`` threads, to the solver's arrays."""
        return self.launcher.bind(
            kernel, blocks or self.particles.n,
            self.particles, self._work, self.neighbours, self.neighbours.tiles, self.reference,
            self._clock, self._blocks, self._constants, self._scheme,
            particles=self.particles.n, **named,
        )  # fmt: skip

    def _initialise(self) -> None:
        """Make the dependent fields agree with the scene; the first step then starts from a whole state."""
        compile_modules(self._kernels(), self.launcher.device)
        if "switch" in self._scheme.groups:
            self.particles.av_switch.fill_(self._scheme.first_switch)
        self.neighbours.build()
        if self.reference is not None:
            self.reference.build()
        self._run_still(self._scheme.settle(self._bind))
        self._check_laws()
        self._run_still(self._scheme.derive(self._bind) + self._scheme.listed(self._bind))
        self._run_still(self._scheme.probe(self._bind))

    def _check_laws(self) -> None:
        """Refuse a start for which an equation of state has no answer.

        Raises:
            InputError: Names the body, its material and the state.
        """
        beyond = self.particles.clipped.numpy() > 0
        if beyond.any():
            data, k = self.data, int(self.particles.id.numpy()[beyond].min())
            material = data.materials[data.mat[k]].name
            raise values.beyond_law(data.bodies[data.body[k]], material, data.rho[k], data.e[k])

    def _kernels(self) -> set[wp.Kernel]:
        """The kernels of this run, launched or of one module with those that are."""
        found = kernels_of(self, self._scheme, self.neighbours.cells, self.watch, self.program) | set(
            make_sort(self._spec).values()
        )
        if self.reference is not None:
            found |= kernels_of(self.reference)
        search = kernels_of(self.neighbours, self.neighbours.tiles)
        return found | search if self._scheme.searching else found - search

    def _run_still(self, commands: list[Command]) -> None:
        """Run launches outside of a step, with the velocity gradient as it is (zero at the start)."""
        self._clock.dt.fill_(1.0)
        for command in commands:
            command()
        self._clock.dt.fill_(0.0)

    def relist(self) -> None:
        """Rebuild the neighbour rows now."""
        moved = self.neighbours.build()  # particles, in memory
        self._run_still((self._scheme.derive(self._bind) if moved else []) + self._scheme.listed(self._bind))

    def prepare(self) -> None:
        """Compile and load every kernel of a step, without taking one."""
        self.advance(self.reading.time)
        self._run_steps(1)

    def mean_neighbours(self) -> float:
        """Mean number of neighbours within the kernel's support, the particle itself left out.

        With Lagrangian particles that is the number of reference neighbours.
        """
        if self.reference is not None:
            return self.reference.mean_count
        mean = self.neighbours.mean_count()
        self.relist()
        return mean

    def advance(self, t_stop: float, on_batch: Callable[[Reading], bool] | None = None) -> None:
        """Step until ``t_stop`` [s], which the last step hits exactly.

        ``on_batch`` sees the clock after every batch of steps; True stops there.

        Raises:
            RunError: A particle's state is not finite, the time step collapsed, or a guard ends the run; names the
                particle.
        """
        self._clock.stop_at(t_stop)
        self.watch.begin()
        now = self._plan()
        while now.status in (RUNNING, STALE):
            if now.status == STALE:
                self.relist()
                now = self._plan()
                continue
            before = now
            self._run_steps(min(self._batch, self.watch.allowed(before.steps)))
            now = self.reading = self._clock.read()
            self._batch = self._predict(before, now)
            self.watch.look(before, now)
            if on_batch is not None and on_batch(now):
                break
        self.reading = now
        if now.status in (COLLAPSED, NON_FINITE, INSIDE_OUT):
            raise explain(now, self.particles, self.data, self._scheme)

    def _bind_step(self) -> None:
        """Bind the launches of a step again if neighbour rows have moved in memory."""
        if self._bound != self.neighbours.generation:
            plan = self._scheme.plan(self._bind, self._step_blocks, self.neighbours.tiles)
            self.program.bind(self._scheme.step(self._bind), plan)
            self._bound = self.neighbours.generation

    def _drop_step(self) -> None:
        """Let go of the launches of a step, and of the arrays that they are bound to."""
        self._bound = -1
        self.program.bind([], [])

    def _plan(self) -> Reading:
        """Let the device judge the next step, without having taken one."""
        self._bind_step()
        self._clock.dt.zero_()
        self.program.plan()
        return self._clock.read()

    def _run_steps(self, count: int) -> None:
        self._bind_step()
        self.program.run(count)

    def _predict(self, before: Reading, now: Reading) -> int:
        """Steps until the skin is used up, judged by the last batch: a wrong guess costs idle steps, nothing else."""
        steps, worn = now.steps - before.steps, now.wear - before.wear
        if now.status != RUNNING or steps < 1 or worn <= 0.0:
            return 1
        left = (1.0 - now.wear) * steps / worn
        most = BATCH_PARTICLES[self.launcher.device.is_cuda] // self.particles.n
        return int(max(min(left, MAX_BATCH, most), 1.0))

    def ledger(self) -> dict[str, float]:
        """Conserved quantities and extremes of all particles (see `kernels.ledger` for names and units)."""
        self._bind(self._scheme.ledger, self._blocks.count)()
        partial = self._work.partial.numpy()
        sums = {name: total(partial[:, k]) for k, name in enumerate(SUMS)}
        maxima = {name: float(partial[:, len(SUMS) + k].max()) for k, name in enumerate(MAXIMA)}
        return sums | maxima

    def tally(self) -> dict[str, float]:
        """What became of Lagrangian particles, and how deep bodies are in each other; only what the run has.

        ``converted_share``: share of all particles that have turned Eulerian; ``eroded``: particles that have left all
        lists; ``inverted``: how often a deformation gradient was not physical; ``interpenetration``: the deepest so
        far, in spacings (`warpsph.watching.penetration`).
        """
        p, data, found = self.particles, self.data, {}
        if self.reference is not None:
            kernel_type = p.kernel_type.numpy()
            converted = int((kernel_type == EULERIAN).sum()) - int(data.eulerian.sum())
            found |= {"converted_share": converted / p.n, "eroded": int((kernel_type == ERODED).sum())}
            found["inverted"] = int(p.inverted.numpy().sum())
        if data.numerics.contact is not None:
            cover = float(p.cover.numpy().max())
            found["interpenetration"] = interpenetration(
                cover, data.numerics.kernel, data.dim, data.h, data.spacing
            )
        return found

    def owners(self) -> dict[str, object]:
        """Everything that holds device arrays as attributes, by name (see `warpsph.memory.usage.usage`)."""
        found = {"particles": self.particles, "work": self._work, "clock": self._clock}
        found |= {"neighbours": self.neighbours, "tiles": self.neighbours.tiles}
        found |= {"cells": self.neighbours.cells, "search": self.neighbours.search, "watch": self.watch}
        if self.reference is not None:
            found["reference"] = self.reference
        return found

    def state(self, arrays: dict[str, np.ndarray] | None = None) -> State:
        """Copy the particles to the host, in id order; with ``arrays`` of `save`, each field when it is asked for."""
        host = None if arrays is None else arrays.__getitem__
        return self.particles.state(self.reading.time, self.reading.steps, host)

    def glance(self) -> State:
        """See the particles as they are, in id order; a field is copied when it is asked for.

        Raises:
            RuntimeError: On a look at a field after the run has gone on.
        """
        then = (self.reading, self.neighbours.builds)

        def host(name: str) -> np.ndarray:
            if (self.reading, self.neighbours.builds) != then:
                raise RuntimeError(f"field {name!r} is read from a state that is over; keep copies of fields")
            return getattr(self.particles, name).numpy()

        return self.particles.state(self.reading.time, self.reading.steps, host)

    def lasting(self) -> dict[str, wp.array]:
        """The arrays that a step leaves to the next one; all others are found again from them."""
        work = {name: getattr(self._work, name) for name in self._scheme.lasting}
        clock = {"clock": self._clock.clock, "count": self._clock.count}
        return self.particles.lasting() | self.neighbours.lasting() | work | clock

    def room(self) -> dict[str, wp.array]:
        """Memory of the host for what `save` copies, to be filled again and again."""
        return make_room(self.lasting())

    def save(self, room: dict[str, wp.array] | None = None) -> tuple[dict[str, np.ndarray], dict]:
        """Everything a restart needs, between any two batches: arrays in memory order, in ``room`` if given, and plain values."""
        return to_host(self.lasting(), room), {
            "precision": self.precision, "cuda": self.launcher.device.is_cuda, "batch": self._batch,
            "builds": self.neighbours.builds, "tile_width": self.neighbours.tiles.width,
            "watch": self.watch.save(),
        }  # fmt: skip

    def restore(self, arrays: dict[str, np.ndarray], info: dict) -> None:
        """Go on from what `save` gave: bit for bit, but in another precision or on another kind of device.

        There the arrays are converted, and the neighbour rows are those of the present positions.

        Raises:
            InputError: The checkpoint is of another number of particles, or lacks a field.
        """
        missing = [name for name in self.lasting() if name not in arrays]
        if missing:
            raise restarts.no_arrays(missing)
        if len(arrays["id"]) != self.particles.n:
            raise restarts.other_number(len(arrays["id"]), self.particles.n)
        for name, array in self.lasting().items():
            if not fits(array, arrays[name]):
                raise restarts.wrong_array(name, arrays[name], host_shape(array))
        self.particles.restore(arrays)
        self._clock.clock.assign(arrays["clock"])
        self._clock.count.assign(arrays["count"])
        self.neighbours.builds = info["builds"]
        if (self.precision, self.launcher.device.is_cuda) == (info["precision"], info["cuda"]):
            self.neighbours.recall(arrays, info["tile_width"])
            self._batch = info["batch"]
        else:
            self.neighbours.build()
        self.watch.restore(info["watch"])
        if self.reference is not None:
            self.reference.build()
        self._bound = -1  # arrays may have moved in memory
        self._run_still(self._scheme.derive(self._bind) + self._scheme.listed(self._bind))
        for name in self._scheme.lasting:
            to_device(getattr(self._work, name), arrays[name])
        self.reading = self._clock.read()
