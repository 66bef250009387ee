"""Repeated measurements of the step loop: how a case is computed, and what it cost."""

import time
from dataclasses import dataclass, field
from statistics import median

from warpsph.scene import SceneData
from warpsph.solver import Solver

WARM_UP, STEPS = 20, 80
"""Steps before the clock starts, and steps that it then measures."""

HEADER = (
    "case", "window", "particles", "precision", "threads", "ns per particle-step: median", "min", "max",
    "neighbours", "ns per pair", "steps per rebuild",
)  # fmt: skip
"""Columns of the first table."""


@dataclass(frozen=True)
class Variant:
    """One way to compute a case.

    Attributes:
        device: Name of the Warp device.
        precision: ``float64`` or ``float32``.
        threads: CPU threads.
    """

    device: str
    precision: str
    threads: int | None

    def solver(self, data: SceneData) -> Solver:
        """Make a solver that is ready to step."""
        made = Solver(data, device=self.device, precision=self.precision, threads=self.threads)
        made.prepare()
        return made


@dataclass
class Series:
    """Repeated measurements of one case in one window of its time.

    Attributes:
        case: Name of the case.
        window: Which steps were measured.
        variant: How it was computed.
        particles: Number of particles.
        ns: Wall time per particle and step [ns], one for each repetition.
        neighbours: Mean neighbours within the support, the particle itself left out.
        steps: Steps of a repetition.
        builds: Rebuilds of the neighbour rows in them.
    """

    case: str
    window: str
    variant: Variant
    particles: int
    ns: list[float] = field(default_factory=list)
    neighbours: float = 0.0
    steps: int = 0
    builds: int = 0

    def cells(self) -> list[str]:
        """Row of the table."""
        middle = median(self.ns)
        return [
            self.case, self.window, f"{self.particles:,}", self.variant.precision, str(self.variant.threads or "-"),
            f"{middle:.4g}", f"{min(self.ns):.4g}", f"{max(self.ns):.4g}", f"{self.neighbours:.1f}",
            f"{middle / self.neighbours:.3g}", f"{self.steps / max(self.builds, 1):.1f}",
        ]  # fmt: skip


def first_steps(row: Series, data: SceneData) -> None:
    """Add one measurement of `STEPS` steps after `WARM_UP` steps."""
    solver = row.variant.solver(data)
    advance(solver, WARM_UP)
    next_steps(row, solver)
    row.neighbours = row.neighbours or solver.mean_neighbours()


def next_steps(row: Series, solver: Solver) -> None:
    """Add one measurement of the next `STEPS` steps of a solver."""
    steps, builds, start = solver.reading.steps, solver.neighbours.builds, time.perf_counter()
    advance(solver, STEPS)
    wall = time.perf_counter() - start
    row.steps, row.builds = solver.reading.steps - steps, solver.neighbours.builds - builds
    row.ns.append(1e9 * wall / (row.steps * row.particles))


def advance(solver: Solver, count: int) -> None:
    """Take ``count`` steps, and those that were under way then: batches are not cut."""
    target = solver.reading.steps + count
    solver.advance(float("inf"), lambda now: now.steps >= target)
