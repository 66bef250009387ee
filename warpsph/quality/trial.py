"""One case of the benchmark in one precision: everything that is measured of it."""

import contextlib
import tempfile
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import warp as wp

from warpsph import library
from warpsph.kernels.kernel_type import EULERIAN
from warpsph.memory.usage import of_search, usage
from warpsph.scene import SceneData
from warpsph.solver import Solver
from warpsph.storage import snapshot

from . import block, series
from .stopwatch import ROWS, kernel_times
from .traffic import Pairs, Traffic, touched_by, traffic

WARM_UP, STEPS, REPEATS = 10, 30, 3
"""Steps before the clock starts, steps of a repetition, and repetitions."""

LARGEST_SNAPSHOT = 4_000_000
"""Particles of which a snapshot is timed, at most: of more it takes longer than everything else."""

SCHEMES = {
    "eulerian": "sav1", "eulerian-mixed": "sav1-mixed", "tl": "tl", "adaptle": "adaptle", "ts2": "ts2", "pm": "pm",
}  # fmt: skip
"""Schemes of the cases on the block."""

SCENES = ("hvi_2d", "debris_3d")
"""Bundled scenes that are cases as they are."""


@dataclass(frozen=True)
class Case:
    """A case.

    Attributes:
        name: Its name on the command line.
        dim: Space dimension.
        scheme: Scheme of a case on the block; None for a scene as it is.
    """

    name: str
    dim: int
    scheme: str | None = None


CASES = {
    f"{name}-{dim}d": Case(f"{name}-{dim}d", dim, scheme)
    for dim in (2, 3)
    for name, scheme in SCHEMES.items()
} | {name: Case(name, int(name[-2])) for name in SCENES}
"""Every case by its name."""


def build(case: Case, particles: int | None) -> tuple[SceneData, float]:
    """Build the scene of a case, with about so many particles on the block.

    Returns:
        The scene, which all cases of a dimension share but for `with_scheme`, and how long that took [s].
    """
    start = time.perf_counter()
    scene = block.block(case.dim, particles) if case.scheme else library.load(case.name).build()
    return scene.finalize(), time.perf_counter() - start


def with_scheme(data: SceneData, case: Case) -> SceneData:
    """Give the block the case's scheme, and Eulerian particles where it couples them with others."""
    if case.scheme is None:
        return data
    eulerian = block.half(data.x) if case.scheme == "adaptle" else data.eulerian
    return replace(data, numerics=replace(data.numerics, scheme=case.scheme), eulerian=eulerian)


def measure(data: SceneData, *, device: str, precision: str, threads: int | None) -> dict[str, Any]:
    """Measure a scene.

    Returns:
        Scheme, particles, threads; ``ns_per_particle_step`` (of each repetition), rates per second; neighbours,
        Eulerian share, steps per rebuild; bytes per particle; ``kernels``, a list; times of solver and snapshot [s].
    """
    start = time.perf_counter()
    solver = Solver(data, device=device, precision=precision, threads=threads)
    solver.prepare()
    ready = time.perf_counter() - start
    touched = touched_by(solver, lambda: series.advance(solver, WARM_UP))
    n, steps, builds = len(data.x), solver.reading.steps, solver.neighbours.builds
    ns = [_repetition(solver) for _ in range(REPEATS)]
    steps, builds = solver.reading.steps - steps, solver.neighbours.builds - builds
    used = usage(solver)
    eulerian = float((solver.particles.kernel_type.numpy() == EULERIAN).mean())
    last = solver.reading.steps
    spent = kernel_times(solver, lambda: series.advance(solver, STEPS))
    timed = solver.reading.steps - last
    pairs = Pairs(neighbours=solver.mean_neighbours(), eulerian=eulerian)
    models = {name: traffic(name, solver, touched.get(name, 0), pairs) for name in spent}
    rate, whole = 1e9 / median(ns), sum(spent.values())
    return {
        "scheme": data.numerics.scheme, "dim": data.dim, "particles": n, "precision": precision,
        "threads": solver.launcher.threads, "ns_per_particle_step": ns, "particle_steps_per_s": rate,
        "pairs_per_s": rate * pairs.neighbours, "mean_neighbours": pairs.neighbours, "eulerian_share": eulerian,
        "steps_per_rebuild": steps / builds if builds else None, "search_share": spent.get(ROWS, 0.0) / whole,
        "bytes_per_particle": sum(used.values()) / n, "list_bytes_per_particle": of_search(used) / n,
        "kernels": [
            {"name": name, "ns_per_particle_step": 1e9 * s / (timed * n), "share": s / whole}
            | _rates(models[name], s / timed)
            for name, s in spent.items()
        ],
        "solver_s": ready, "snapshot_s": _snapshot(solver),
    }  # fmt: skip


def _repetition(solver: Solver) -> float:
    """Wall time per particle and step [ns]."""
    wp.synchronize_device(solver.launcher.device)
    steps, start = solver.reading.steps, time.perf_counter()
    series.advance(solver, STEPS)
    wp.synchronize_device(solver.launcher.device)
    wall = time.perf_counter() - start
    return 1e9 * wall / ((solver.reading.steps - steps) * solver.particles.n)


def _rates(model: Traffic, seconds: float) -> dict[str, float]:
    """What a kernel that takes so long in a step moves and computes per second; 0 where the model does not say."""
    per_second = 1.0 / seconds if seconds > 0.0 else 0.0
    return {f"{name}_per_s": value * per_second for name, value in asdict(model).items()}


def _snapshot(solver: Solver) -> float | None:
    """Wall time of a snapshot, copy from the device included [s]; None of too many particles, or where h5py is missing."""
    if solver.particles.n > LARGEST_SNAPSHOT:
        return None
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(ImportError):
        start = time.perf_counter()
        snapshot.write(Path(folder, "block.vtkhdf"), solver.state())
        return time.perf_counter() - start
    return None
