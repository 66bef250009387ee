"""Where the time of a step goes: by kernel, timed on the host (CPU) or by the driver (CUDA)."""

import time
from collections import defaultdict
from collections.abc import Callable

import warp as wp

from warpsph.solver import Solver

ROWS, REST = "neighbour rows", "everything else"
"""Names of what is no launch of a step: rebuilding the rows; the host, its readings and idle threads."""


def kernel_times(solver: Solver, work: Callable[[], None]) -> dict[str, float]:
    """Time the launches of a solver while ``work`` steps it.

    Args:
        solver: The solver.
        work: Steps the solver.

    Returns:
        Wall time [s] by kernel, longest first, with `ROWS` and `REST`; on CUDA the driver's kernel times instead.
    """
    spent = _driver_times(work) if solver.launcher.device.is_cuda else _host_times(solver, work)
    return dict(sorted(spent.items(), key=lambda item: -item[1]))


def _host_times(solver: Solver, work: Callable[[], None]) -> dict[str, float]:
    """Time each launch around the call: on a CPU a launch returns when it is done."""
    spent: dict[str, float] = defaultdict(float)
    launcher, neighbours = solver.launcher, solver.neighbours
    execute, build = launcher.execute, neighbours.build
    building = False

    def timed_execute(slices):
        start = time.perf_counter()
        execute(slices)
        if not building:
            spent[short_name(slices[0].kernel.key)] += time.perf_counter() - start

    def timed_build():
        nonlocal building
        building, start = True, time.perf_counter()
        build()
        building = False
        spent[ROWS] += time.perf_counter() - start

    launcher.execute, neighbours.build = timed_execute, timed_build
    start = time.perf_counter()
    try:
        work()
    finally:
        del launcher.execute, neighbours.build  # the methods of the class again
    spent[REST] = time.perf_counter() - start - sum(spent.values())
    return spent


def _driver_times(work: Callable[[], None]) -> dict[str, float]:
    """Sum the driver's times by kernel."""
    spent: dict[str, float] = defaultdict(float)
    wp.timing_begin(cuda_filter=wp.TIMING_ALL)
    try:
        work()
    finally:
        results = wp.timing_end()
    for result in results:
        spent[short_name(result.name)] += 1e-3 * result.elapsed
    return spent


def short_name(key: str) -> str:
    """Name of a kernel as its file has it: ``momentum`` for ``make_momentum__locals__momentum``."""
    return key.removeprefix("forward kernel ").rpartition("__locals__")[2]
