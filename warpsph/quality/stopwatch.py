"""Where the time of a step goes: by kernel, timed on the host (CPU) or by the driver (CUDA)."""

import contextlib
import re
import time
from collections import defaultdict
from collections.abc import Callable, Iterator

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
        Wall time [s] by kernel, longest first, with `ROWS` and `REST`; on CUDA a kernel's is the driver's.
    """
    timed = _driver_times if solver.launcher.device.is_cuda else _host_times
    spent: dict[str, float] = defaultdict(float)
    start = time.perf_counter()
    with timed(solver, spent):
        work()
    spent[REST] = time.perf_counter() - start - sum(spent.values())
    return dict(sorted(spent.items(), key=lambda item: -item[1]))


@contextlib.contextmanager
def _host_times(solver: Solver, spent: dict[str, float]) -> Iterator[None]:
    """Time each launch around the call: on a CPU a launch returns when it is done."""
    launcher, neighbours = solver.launcher, solver.neighbours
    execute, build = launcher.execute, neighbours.build
    building = False

    def timed_execute(slices, *options):
        start = time.perf_counter()
        execute(slices, *options)
        if not building:
            spent[short_name(slices[0].kernel.key)] += time.perf_counter() - start

    def timed_build():
        nonlocal building
        building, start = True, time.perf_counter()
        build()
        building = False
        spent[ROWS] += time.perf_counter() - start

    launcher.execute, neighbours.build = timed_execute, timed_build
    try:
        with one_by_one(solver):
            yield
    finally:
        del launcher.execute, neighbours.build  # the methods of the class again


@contextlib.contextmanager
def _driver_times(solver: Solver, spent: dict[str, float]) -> Iterator[None]:
    """Sum the driver's times by kernel between rebuilds; a rebuild is timed as a whole, from idle to idle."""
    neighbours, device = solver.neighbours, solver.launcher.device
    build = neighbours.build

    def collect():
        for result in wp.timing_end():
            spent[short_name(result.name)] += 1e-3 * result.elapsed

    def timed_build():
        collect()
        start = time.perf_counter()
        build()
        wp.synchronize_device(device)
        spent[ROWS] += time.perf_counter() - start
        wp.timing_begin(cuda_filter=wp.TIMING_ALL)

    neighbours.build = timed_build
    wp.timing_begin(cuda_filter=wp.TIMING_ALL)
    try:
        with one_by_one(solver):
            yield
    finally:
        collect()
        del neighbours.build


@contextlib.contextmanager
def one_by_one(solver: Solver) -> Iterator[None]:
    """Launch the kernels of a step one by one, not as a captured graph in which they cannot be told apart."""
    graphs = [part for part in vars(solver).values() if getattr(part, "captured", False) is True]
    for graph in graphs:
        graph.captured = False
    try:
        yield
    finally:
        for graph in graphs:
            graph.captured = True


def short_name(key: str) -> str:
    """Name of a kernel as its file has it: ``momentum`` for ``make_momentum__locals__momentum`` with the driver's hash."""
    name = key.removeprefix("forward kernel ").rpartition("__locals__")[2]
    return re.sub(r"_[0-9a-f]{8}$", "", name)
