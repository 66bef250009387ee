"""One run in progress: what is due when, what goes to the disk, and how it ends."""

import contextlib
import copy
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import warp as wp

from warpsph import __version__
from warpsph.clock import Reading
from warpsph.errors import DiskError, Ended, RunError
from warpsph.kernels.parts import PARTS
from warpsph.memory import exhaustion
from warpsph.messages import output, remarks, stops
from warpsph.messages.values import printable
from warpsph.progress import Progress
from warpsph.scene import SceneData
from warpsph.solver import Solver
from warpsph.storage import checkpoint, folder, snapshot
from warpsph.storage import summary as summaries
from warpsph.storage.history import History
from warpsph.storage.writer import Writer

from . import origin
from .balance import Balance, energy
from .signals import Stop
from .walltime import Deadline

HISTORY_ROWS = 200
"""Rows of history.csv over a whole run, about; a row is written after the first batch of steps past its time."""

LEDGER_COLUMNS = (
    ("kinetic_energy", "J"), ("internal_energy", "J"),
    ("momentum_x", "N s"), ("momentum_y", "N s"), ("momentum_z", "N s"),
    ("angular_momentum_x", "N m s"), ("angular_momentum_y", "N m s"), ("angular_momentum_z", "N m s"),
    ("work", "J"), *((name, "J") for name in PARTS), ("pressure_max", "Pa"), ("speed_max", "m/s"), ("density_max", "kg/m^3"),
    ("internal_energy_max", "J/kg"),
)  # fmt: skip
"""Columns of history.csv that come from the ledger as they are, with units."""

OWN_COLUMNS = (
    ("time", "s"), ("step", "1"), ("dt", "s"), ("total_energy", "J"), ("energy_error", "1"),
    *LEDGER_COLUMNS, ("pressure_min", "Pa"), ("density_min", "kg/m^3"),
)  # fmt: skip
"""Columns of history.csv that every run has; a measure of the same name takes the column's place."""


class Job:
    """A solver at work for an output folder.

    Call `begin` or `go_on`, then `finish`.
    """

    def __init__(
        self, solver: Solver, out: Path, until: float, parameters: dict, progress: Progress,
        stop: Stop, deadline: Deadline, frames: bool,
    ):  # fmt: skip
        self.solver, self.out, self.until, self.progress = solver, out, until, progress
        self.frames = frames
        self._stop, self._deadline = stop, deadline
        self._ending: Ended | None = None  # what has ended the steps before their time
        self.parameters = json.loads(json.dumps(parameters, default=str))
        self.data: SceneData = solver.data
        solver.watch.say = lambda text: progress.message(f"warning: {text}")
        self.step_wall, self.wall = 0.0, 0.0
        self.next_snapshot, self.next_row = 0, 0.0
        self.interval, self.row_interval = until / self.data.snapshots, until / HISTORY_ROWS
        self.ends, self.due = [until], 0  # ends so far, and how many intervals until the next output
        self.remarks: list[str] = []  # what was to be said when the run was gone on with
        self.warnings: list[str] = []
        self.peaks = {name: -math.inf for name, measure in self.data.measures.items() if measure.peak}
        self._started = time.perf_counter()
        self._mark = (0.0, 0)
        self._row_time = self._output_time = -1.0
        self._writer = Writer()
        self._rooms: list[dict[str, wp.array]] = []  # host memory of outputs that are written
        self._times: dict[str, float] = {}  # of snapshots, by name

    def begin(self) -> None:
        """Start from the scene's initial state."""
        self.balance = Balance(self.data, self.solver.ledger())
        self.history = History(self.out / "history.csv", _columns(self.data))
        self.neighbours = [self.solver.mean_neighbours()]
        self._row()
        self._output()

    def go_on(self, found: checkpoint.Found) -> None:
        """Start from a checkpoint: files are as they were then, and the next batch of steps is the one that was due.

        Raises:
            InputError: If the checkpoint, the history or a snapshot before it cannot be read.
            DiskError: If a file cannot be written.
        """
        info, self.balance = found.info, Balance(self.data, self.solver.ledger())
        if (
            info["job"]["peaks"].keys() != self.peaks.keys()
            or info["balance"]["start"].keys() != self.balance.start.keys()
        ):
            raise LookupError("its peaks or its ledger are not those of the scene")
        self._times = snapshot.times(self.out, info["job"]["next_snapshot"])
        self.solver.restore(found.arrays, info["solver"])
        self.balance.restore(info["balance"])
        self.history = History.reopen(self.out / "history.csv", info["row_time"])
        checkpoint.go_on_from(found.path)
        for name in origin.KEPT:
            setattr(self, name, info["job"][name])
        self.ends = sorted({*self.ends, self.until})
        self._row_time = info["row_time"]
        said = found.remarks + origin.differences(info, origin.header(self.solver, self.out))
        if self.history.last != info["row_time"]:
            said.append(remarks.history_lost(self.history.path, self.history.last, info["row_time"]))
        said = list(map(printable, said))  # a folder may have any name
        self.remarks = self.remarks + said
        self.warnings += self.remarks
        for line in said:
            self.progress.message(line)
        self._output_time = info["time"]
        snapshot.drop(self.out, self.next_snapshot, self._times)  # of what is done again

    def finish(self) -> dict[str, Any]:
        """Run to the end, whatever ends it, and write the summary.

        Raises:
            RunError: The run had to stop.
            Ended: It was asked to stop, or its wall time is up; it can go on from its checkpoint.
        """
        self.progress.start(self.until, self.solver.reading.time)
        try:
            with exhaustion.told():
                with self._writer:
                    self._steps()
                if self.solver.reading.time < self.until:
                    raise self._pause()
                self.history.close()
                self._rooms.clear()  # there are no more outputs, and drawing takes as much
                return self._summary("done")
        except RunError as error:
            raise self._stopped(error) from error
        finally:
            self.progress.stop()

    def _pause(self) -> Ended:
        """Leave what is needed to go on from here; gives the end with what goes on."""
        now = self.solver.reading
        ended = stops.paused(self._ending, self.out, now.time, self.until, now.steps - self._mark[1])
        self._last_words(str(ended), str(self._ending), going_on=True)
        self.history.close()
        return ended

    def _stopped(self, error: RunError) -> RunError:
        """Leave last words, as far as the disk takes them; gives the error with what is there of the run."""
        lost = None
        try:
            with exhaustion.told():
                self._last_words(str(error), "failed", whole=not isinstance(error, DiskError))
        except Exception as another:  # whatever it is must not hide why the run stopped
            lost = another if str(another) != str(error) else None
        with contextlib.suppress(DiskError):
            self.history.close()
        try:
            last = (snapshot.find(self.out) or [None])[-1]
            goes_on = bool(folder.checkpoints(self.out))
        except OSError:
            last, goes_on = None, False
        if isinstance(error, DiskError):
            return output.stopped(error, self._stop.asked or self._ending, last, self.out, goes_on)
        return stops.stopped(error, lost, last)

    def _must_end(self) -> bool:
        """Whether to take no more steps: a signal asks for it, or the wall time will soon be up."""
        if self._ending is None:
            self._ending = self._stop.asked or (stops.time_is_up() if self._deadline.is_near() else None)
        return self._ending is not None

    def _steps(self) -> None:
        self.solver.prepare()  # compile before the clock runs
        self._mark = (time.perf_counter(), self.solver.reading.steps)
        while self.solver.reading.time < self.until and not self._must_end():
            start = self._batch_start = time.perf_counter()
            self._paused = 0.0
            target = self._target()
            self.solver.advance(target, self._on_batch)
            self.step_wall += time.perf_counter() - start - self._paused
            if self.solver.reading.time >= target:
                self._row()
                self._output()

    def _target(self) -> float:
        """The next output time [s]: a multiple of the interval, or an end of the run, also one that it had before."""
        ends = [end for end in self.ends if self.solver.reading.time < end]
        due = min(self.due * self.interval, ends[0])
        return ends[0] if ends[0] - due < 1e-6 * self.interval else due

    def _on_batch(self, now: Reading) -> bool:
        """Write what is due between two batches of steps; tells the solver whether to stop."""
        start = time.perf_counter()
        self._deadline.batch(start - self._batch_start)
        self._writer.check()
        if now.time >= self.next_row:
            self._row()
        rate = (now.steps - self._mark[1]) * len(self.data.x) / max(start - self._mark[0], 1e-9)
        self.progress.update(
            time=now.time, step=now.steps, dt=now.dt, energy_error=self.balance.energy_error, rate=rate
        )
        self._batch_start = time.perf_counter()
        self._paused += self._batch_start - start
        return self._must_end()

    def _row(self) -> None:
        """Write a row of the history, one for each time, and compare the ledger with the first one."""
        now = self.solver.reading
        if now.time == self._row_time:
            return
        self._row_time, ledger = now.time, self.solver.ledger()
        self.balance.update(ledger)
        values = [now.time, now.steps, now.dt, energy(ledger), self.balance.energy_error]
        values += [ledger[name] for name, _ in LEDGER_COLUMNS]
        values += [-ledger["tension_max"], -ledger["rarefaction_max"]]
        own = dict(zip((name for name, _ in OWN_COLUMNS), values, strict=True))
        self.history.write(list((own | self._measures()).values()))
        while self.next_row <= now.time:
            self.next_row += self.row_interval

    def _measures(self) -> dict[str, float]:
        """The scene's measures of the present state.

        Raises:
            RunError: If one of them fails; names it.
        """
        if not self.data.measures:
            return {}
        state, found = self.solver.glance(), {}
        for name, measure in self.data.measures.items():
            try:
                found[name] = float(measure.function(state))
            except (MemoryError, RunError):
                raise
            except Exception as error:  # code of the scene
                raise stops.measure_failed(name, self.solver.reading.time, error) from error
        for name, highest in self.peaks.items():
            found[name] = self.peaks[name] = max(highest, found[name])
        return found

    def _output(self) -> None:
        """Hand a snapshot and a checkpoint to the writer's thread."""
        number, self.next_snapshot = self.next_snapshot, self.next_snapshot + 1
        if self.solver.reading.time > (self.due - 1e-6) * self.interval:
            self.due += 1
        self._output_time = self.solver.reading.time
        self._writer.submit(lambda: self._take(number))

    def _take(self, number: int, going_on: bool = True) -> Callable[[], None]:
        """Copy the state to the host; gives what writes it: a snapshot, then the checkpoint that counts on it."""
        start = time.perf_counter()
        room = self._rooms.pop() if self._rooms else self.solver.room()
        arrays, solver = self.solver.save(room)
        state, info = self.solver.state(arrays), self._info(solver)
        path = self.out / "snapshots" / f"{self.data.name}_{number:04d}.vtkhdf"
        copied = time.perf_counter() - start

        def write() -> None:
            start = time.perf_counter()
            snapshot.write(path, state)
            self._times[path.name] = state.time
            snapshot.series(path.parent, self._times)
            self.history.sync()
            if going_on:
                checkpoint.save_newest(self.out, arrays, info)
            self._rooms.append(room)
            self._deadline.output(copied + time.perf_counter() - start)

        return write

    def _info(self, solver: dict) -> dict[str, Any]:
        """Everything a restart needs besides the arrays; nothing in it changes later."""
        own = copy.deepcopy({name: getattr(self, name) for name in origin.KEPT}) | {"wall": self._elapsed()}
        now = self.solver.reading
        return origin.header(self.solver, self.out) | {
            "parameters": self.parameters, "time": now.time, "step": now.steps, "until": self.until,
            "row_time": self._row_time, "solver": solver, "balance": self.balance.save(), "job": own,
            "frames": self.frames,
        }  # fmt: skip

    def _last_words(self, why: str, outcome: str, whole: bool = True, going_on: bool = False) -> None:
        """Leave what is needed to look at a run that stopped early, and to go on with one that was asked to.

        Only a ``whole`` one leaves more than the summary: a disk that takes no more has the run's checkpoint already.
        """
        if whole:
            self._writer.check()
            if not going_on or self.solver.reading.time > self._output_time:
                self._take(self.next_snapshot, going_on)()
        self.warnings.append(why)
        self._summary(outcome)

    def _elapsed(self) -> float:
        return self.wall + time.perf_counter() - self._started

    def _summary(self, outcome: str) -> dict[str, Any]:
        summary = {"outcome": outcome} | self._facts()
        summaries.write(self.out, summary)
        return summary

    def _facts(self) -> dict[str, Any]:
        """Everything summary.json says; ns_per_particle_step counts the step loop alone."""
        now, data, ledger = self.solver.reading, self.data, self.solver.ledger()
        self.balance.update(ledger)
        n, steps = len(data.x), max(now.steps, 1)
        counts = list(self.neighbours)
        with contextlib.suppress(RunError):  # rows that outgrew memory are not counted
            counts.append(self.solver.mean_neighbours())
        neighbours = sum(counts) / len(counts)
        measures = {}
        with contextlib.suppress(RunError):  # one that fails has ended the run
            measures = self._measures()
        per_step = 1e9 * self.step_wall / (n * steps)
        clipped = int(ledger["eos_clipped"])
        warnings = [*self.warnings, *self.solver.watch.warnings()]
        if clipped:
            warnings.append(f"the equation of state left its range in {clipped} particle-steps")
        return {
            "scene": data.name, "scheme": data.numerics.scheme, "parameters": self.parameters,
            "device": f"{self.solver.launcher.device.alias} ({self.solver.launcher.device.name})",
            "precision": self.solver.precision, "threads": self.solver.launcher.threads,
            "particles": n, "particles_per_body": {b: int((data.body == k).sum()) for k, b in enumerate(data.bodies)},
            "dim": data.dim, "steps": now.steps, "time": now.time, "dt_min": now.dt_min if now.steps else 0.0, "dt_max": now.dt_max,
            "wall_s": self._elapsed(), "step_wall_s": self.step_wall, "ns_per_particle_step": per_step,
            "mean_neighbours": neighbours, "ns_per_pair": per_step / neighbours if neighbours else 0.0,
            "neighbour_builds": self.solver.neighbours.builds,
            "energy_error": self.balance.energy_error, "momentum_error": self.balance.momentum_error,
            "angular_momentum_error": self.balance.angular_momentum_error,
            **self.solver.tally(), "guards": self.solver.watch.report(), "measures": measures, "warnings": warnings, "version": __version__,
        }  # fmt: skip


def _columns(data: SceneData) -> list[tuple[str, str]]:
    """Columns of the history with units."""
    return list((dict(OWN_COLUMNS) | {name: m.unit for name, m in data.measures.items()}).items())
