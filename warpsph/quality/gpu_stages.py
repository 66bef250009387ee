"""The stages of `gpu_check`: what is run on a GPU, and what counts as right."""

import contextlib
import datetime
import gc
import importlib.util
import multiprocessing
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import warp as wp

from warpsph import __version__
from warpsph.config import Contact, Conversion, Numerics
from warpsph.device.cores import count_cores
from warpsph.device.launch import find_device
from warpsph.running.balance import energy
from warpsph.scene import Scene
from warpsph.schemes import SCHEMES
from warpsph.shapes import Box, Disc, Sphere
from warpsph.solver import Solver

from . import ceilings, layouts, report
from .gpu_check import Sheet

FIRST = ("sav1", "ts2", "tl", "adaptle-mixed-as", "pm", "sav1-mixed-as", "ts1", "adaptle", "mon", "bal")
"""Schemes that are compared first; the others follow."""

EPS = {"float32": 2.0**-23, "float64": 2.0**-52}
"""Rounding units."""

UNTIL = 2.0e-6
"""Time that a comparison runs to [s]: some 30 steps, in which the bodies meet."""

AMPLIFIED = 200.0
"""A device may differ by so many times what the result changes with a start that differs by about one rounding unit:
multiply-adds round differently in every step and for every neighbour, that start does so once."""

WORST = {"float32": 1.0e-2, "float64": 1.0e-9}
"""It may never differ by more: then the scene is no good to compare with."""

COMPARED = ("x", "v", "rho", "p")
"""Fields of a comparison."""

ENERGY = {"float32": 1.0e-5, "float64": 1.0e-12}
"""Relative change of the total energy that is allowed to a scheme which conserves it."""


@dataclass(frozen=True)
class Stage:
    """A stage: ``run(sheet, device, quick, deadline)``, the deadline as `time.monotonic` has it."""

    title: str
    header: Sequence[str]
    run: Callable[[Sheet, str, bool, float], None]


def impact(dim: int, particles: int, **numerics: object) -> Scene:
    """Build an aluminium ball that hits an aluminium plate of the same volume at 400 m/s; contact after few steps."""
    if dim == 2:
        radius = 1.0e-3 * (0.5 * particles / np.pi) ** 0.5
        ball, thickness = Disc(radius, (-radius - 0.6e-3, 0.1e-3)), 0.5 * np.pi * radius
        plate = Box((0.0, -radius), (thickness, radius))
    else:
        radius = 1.0e-3 * (0.375 * particles / np.pi) ** (1.0 / 3.0)
        ball, thickness = Sphere(radius, (-radius - 0.6e-3, 0.1e-3, 0.2e-3)), np.pi * radius / 3.0
        plate = Box((0.0, -radius, -radius), (thickness, radius, radius))
    scene = Scene("impact", dim=dim, spacing=1.0e-3, until=1.0, numerics=Numerics(**numerics))
    scene.add_body("ball", ball, "aluminium", velocity=(400.0, 0.0, 0.0)[:dim])
    scene.add_body("plate", plate, "aluminium")
    return scene


# ---------------------------------------------------------------------------------------------------------------------
# facts and tests


def facts(sheet: Sheet, device: str, _quick: bool, _deadline: float) -> None:
    """Versions, device and driver."""
    found = find_device(device)
    told = {"date": datetime.date.today().isoformat(), "device": f"{found.alias}: {found.name}"}
    if found.is_cuda:
        told |= {
            "compute capability": f"sm_{found.arch}",
            "memory": f"{found.total_memory / 2**30:.1f} GiB, {found.free_memory / 2**30:.1f} GiB free",
            "driver": ".".join(map(str, wp.get_cuda_driver_version() or ())),
            "multiprocessors": str(found.sm_count),
        }
    told |= {
        "CUDA of Warp": ".".join(map(str, wp.get_cuda_toolkit_version() or ())),
        "Warp, NumPy, Python": f"{wp.__version__}, {np.__version__}, {platform.python_version()}",
        "processor": f"{count_cores()} cores, {platform.machine()}",
        "warpsph": f"{__version__}, commit {os.environ.get('WARPSPH_COMMIT') or 'unknown'}",
    }
    for row in told.items():
        sheet.add(row)


def tests(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Run the tests that need a GPU; rehearsed on a CPU with one file of tests that need none."""
    root = report.checkout()
    if root is None:
        sheet.failed.append("no checkout, no tests")
        return
    if not _has("pytest"):
        sheet.failed.append("left out: this Python has no pytest")
        return
    chosen = ["-m", "gpu", "tests/test_cuda.py", "tests"] if device != "cpu" else ["tests/test_program.py"]
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.xml"
        command = [sys.executable, "-m", "pytest", "-q", "-x" if quick else "--maxfail=30", *chosen]
        command += ["--continue-on-collection-errors", "-p", "no:cacheprovider", f"--junitxml={result}"]
        command += ["-n", str(min(count_cores(), 12))] * _has("xdist")
        child = subprocess.Popen(command, cwd=root)
        try:
            child.wait(max(deadline - time.monotonic(), 1.0))
        except subprocess.TimeoutExpired:
            sheet.notes.append("Stopped at the time limit: not all of them ran; the log says which.")
            child.send_signal(signal.SIGINT)  # pytest then writes what it has
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(TAIL_OF_TESTS)
            child.kill()
        cases = list(ElementTree.parse(result).iter("testcase")) if result.is_file() else []
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for case in cases:
        if case.get("classname") and case.find("error") is None:
            kind = {"failure": "failed", "skipped": "skipped"}
            found = next((kind[tag] for tag in kind if case.find(tag) is not None), "passed")
            counts[found] += 1
            if found == "failed":
                sheet.failed.append(f"{case.get('classname')}::{case.get('name')}")
    sheet.add([str(counts[name]) for name in counts], counts)
    if not counts["passed"]:
        sheet.failed.append("no test passed")


TAIL_OF_TESTS = 5.0
"""Time for pytest to end in good order [s]."""


def _has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


# ---------------------------------------------------------------------------------------------------------------------
# comparison of every scheme


@dataclass(frozen=True)
class Comparison:
    """A scheme in one dimension and precision, with what else is asked of the scene."""

    scheme: str
    dim: int
    precision: str
    contact: bool = False

    def scene(self, quick: bool) -> Scene:
        """The impact, small."""
        options: dict[str, Any] = {"scheme": self.scheme}
        if self.contact:
            options["contact"] = Contact(stiffness=0.25)
            if self.scheme.startswith("adaptle"):
                options["conversion"] = Conversion(strain=0.02)
        return impact(self.dim, (150 if self.dim == 2 else 400) * (1 if quick else 4), **options)


def comparisons(quick: bool) -> Iterator[Comparison]:
    """Every scheme, in 2D and 3D and both precisions, and with contact; the most used ones first."""
    names = [*FIRST, *(name for name in SCHEMES if name not in FIRST)]
    if quick:
        names = ["sav1", "ts2", "adaptle-mixed-as"]
    touching = [(name, 3, True) for name in ("tl", "adaptle-mixed-as")]
    for name, dim, contact in (*touching, *((name, dim, False) for name in names for dim in (3, 2))):
        for precision in ("float64", "float32"):
            yield Comparison(name, dim, precision, contact)


def compare_one(case: Comparison, device: str, quick: bool) -> dict:
    """Run a comparison: on the CPU, there from a start that differs by rounding, and twice on the device."""
    data = case.scene(quick).finalize()
    here, moved = (Solver(data, precision=case.precision, threads=1) for _ in range(2))
    there, again = (Solver(data, device=device, precision=case.precision) for _ in range(2))
    noise = 1.0 + EPS[case.precision] * np.sign(np.sin(1.0 + np.arange(moved.particles.n)))
    for name in ("v", "e", "rho"):
        values = getattr(moved.particles, name).numpy()
        getattr(moved.particles, name).assign((values.T * noise).T)
    start = energy(there.ledger())
    for solver in (here, moved, there, again):
        solver.advance(UNTIL)
    mine, theirs, others = (solver.particles.arrays() for solver in (there, here, moved))
    repeated = again.particles.arrays()
    return {
        "difference": {name: _difference(mine, theirs, name) for name in COMPARED},
        "expected": {name: _difference(others, theirs, name) for name in COMPARED},
        "energy": abs(energy(there.ledger()) / start - 1.0),
        "repeats": all(np.array_equal(mine[name], repeated[name], equal_nan=True) for name in mine),
        "steps": there.reading.steps,
        "graph": there.program.captured,
    }


def _difference(a: dict[str, np.ndarray], b: dict[str, np.ndarray], name: str) -> float:
    """Largest difference of a field over its largest value; positions over the extent of the scene."""
    first, second = (fields[name][np.argsort(fields["id"])].astype(np.float64) for fields in (a, b))
    scale = np.ptp(second, axis=0).max() if name == "x" else np.abs(second).max()
    return float(np.abs(first - second).max() / (scale or 1.0))


def judge(case: Comparison, found: dict) -> str:
    """Say what is wrong with a comparison; nothing if all is well."""
    eps, wrong = EPS[case.precision], []
    for name, difference in found["difference"].items():
        allowed = min(AMPLIFIED * max(found["expected"][name], eps), WORST[case.precision])
        if not difference <= allowed:
            wrong.append(f"{name} differs by {difference:.2g}, allowed {allowed:.2g}")
    if not found["repeats"]:
        wrong.append("a second run gives other bits")
    exact = getattr(SCHEMES[case.scheme], "exact_energy", True)
    if exact and not found["energy"] <= ENERGY[case.precision]:
        wrong.append(f"energy changes by {found['energy']:.2g}")
    return "; ".join(wrong)


def compare(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Compare device and CPU in as many processes as there are cores: most of the time goes into compiling."""
    sheet.notes.append(
        f"Largest differences after {UNTIL * 1e6:g} µs, relative to the largest value. Allowed: {AMPLIFIED:g} times "
        "the change that one rounding unit in the start makes on the CPU (in brackets), at least one unit."
    )
    workers = min(count_cores(), 12)
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        jobs = {pool.submit(compare_one, case, device, quick): case for case in comparisons(quick)}
        try:
            for job in as_completed(jobs, max(deadline - time.monotonic(), 1.0)):
                _compared(sheet, jobs[job], job)
        except TimeoutError:
            pool.shutdown(wait=False, cancel_futures=True)
            for worker in multiprocessing.active_children():
                worker.kill()  # who compiles does not listen
    left = len(jobs) - len(sheet.rows)
    if left:
        sheet.notes.append(f"{left} of {len(jobs)} were not reached.")


def _compared(sheet: Sheet, case: Comparison, job) -> None:
    told = [case.scheme + " + contact" * case.contact, f"{case.dim}D", case.precision]
    try:
        found = job.result()
    except Exception as error:  # whatever breaks in one of them, the others are worth having
        sheet.failed.append(f"{' '.join(told)}: {type(error).__name__}: {error}")
        sheet.add([*told, *["-"] * (len(COMPARED) + 2), "failed"], {"case": vars(case)})
        return
    wrong = judge(case, found)
    if wrong:
        sheet.failed.append(f"{' '.join(told)}: {wrong}")
    values = [f"{found['difference'][name]:.1e} ({found['expected'][name]:.1e})" for name in COMPARED]
    verdict = "failed" if wrong else "same"
    repeats = "yes" if found["repeats"] else "no"
    sheet.add([*told, *values, f"{found['energy']:.1e}", repeats, verdict], {"case": vars(case)} | found)


# ---------------------------------------------------------------------------------------------------------------------
# graph, speed, layouts, memory


def graph(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Step with a captured graph and with plain launches: the same bits, and how fast."""
    sizes = [(2, 2_000), (3, 2_000)] if quick else [(2, 20_000), (3, 20_000), (3, 200_000), (3, 1_000_000)]
    for dim, particles in sizes:
        for scheme in ("sav1", "ts2"):
            if time.monotonic() > deadline:
                return
            data = impact(dim, particles, scheme=scheme).finalize()
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                (plain, before), (replayed, after) = (
                    _stepped(data, device, flag, 20 if quick else 100) for flag in (False, True)
                )
            same = all(np.array_equal(before[name], after[name], equal_nan=True) for name in before)
            trouble = [str(warning.message) for warning in told if "no graph on" in str(warning.message)]
            sheet.failed += trouble + [f"{dim}D {scheme}: other bits with a graph"] * (not same)
            n = len(data.x)
            sheet.add(
                [f"{dim}D", scheme, f"{n:,}", f"{1e6 * plain:.4g}", f"{1e6 * replayed:.4g}",
                 f"{plain / replayed:.2f}", "yes" if same else "no", f"{n / replayed / 1e6:.3g}"],
                {"dim": dim, "scheme": scheme, "n": n, "plain_s": plain, "graph_s": replayed},
            )  # fmt: skip


def _stepped(data, device: str, captured: bool, steps: int) -> tuple[float, dict[str, np.ndarray]]:
    """Time of a step [s], and the state after them."""
    solver = Solver(data, device=device, precision="float32", threads=1)
    solver.program.captured = captured
    solver.advance(1.0, lambda now: now.steps >= 5)
    wp.synchronize_device(device)
    start, first = time.perf_counter(), solver.reading.steps
    solver.advance(1.0, lambda now: now.steps >= first + steps)
    wp.synchronize_device(device)
    return (time.perf_counter() - start) / (solver.reading.steps - first), solver.particles.arrays()


def bench(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Run ``warpsph bench`` on the cases that targets are set for, the large ones last."""
    from .bench import bench as measure

    if quick:
        report.checkout = lambda: None  # a rehearsal is nothing for the documentation
        ceilings.ROUNDS, ceilings.COPIED_CUDA = 100, 1 << 24  # nor for the device to show what it can do
    cases = ["eulerian-3d", "ts2-3d", "tl-3d"]
    for size in [2_000, 4_000] if quick else [1_000_000, 10_000_000]:
        left = deadline - time.monotonic()
        if left > 0.0:
            path = sheet.path.with_name(f"bench-{size}.json")
            text = measure(
                cases, device, precisions=["float32", "float64"], sizes=[size], json=path, budget=left
            )
            sheet.notes += [f"```\n{text}\n```"]
            sheet.add([f"{size:,}", path.name])


def try_layouts(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Try data layouts."""
    n = 20_000 if quick else 1_000_000
    sheet.notes.append(f"About {n:,} particles; the prediction was made before anything was run on a GPU.")
    rows = layouts.run_trials(
        device,
        n,
        list(layouts.trials(quick)),
        threads=1,
        deadline=deadline,
        on_row=lambda row: sheet.add(layouts.cells(row), row),
    )
    if not rows:
        sheet.failed.append("no time for any")


def memory(sheet: Sheet, device: str, quick: bool, deadline: float) -> None:
    """Find the bytes of a particle from what a device has left: of a small scene, then of the largest there is time for.

    A first run, which is not counted, brings the code there.
    """
    found = find_device(device)
    Solver(impact(3, 500, scheme="sav1").finalize(), device=device, precision="float32", threads=1).prepare()
    gc.collect()
    wp.synchronize_device(device)
    sizes = [1_000, 2_000] if quick else [1_000_000, 10_000_000, 20_000_000, 50_000_000]
    seconds = _measure_memory(sheet, found, sizes[0])
    left = deadline - time.monotonic()
    fitting = [size for size in sizes[1:] if SLOWER * seconds * size / sizes[0] < left]
    if fitting[-1:] != sizes[-1:]:
        sheet.notes.append(f"No time for {sizes[-1]:,} particles.")
    if fitting:
        _measure_memory(sheet, found, fitting[-1])


SLOWER = 1.2
"""A larger scene may take so many times longer for each particle."""


def _measure_memory(sheet: Sheet, device: wp.Device, particles: int) -> float:
    """Build a solver and take a step; gives the time that took [s]."""
    start = time.monotonic()
    data = impact(3, particles, scheme="sav1").finalize()
    before = device.free_memory if device.is_cuda else 0
    solver = Solver(data, device=str(device), precision="float32", threads=1)
    solver.prepare()
    wp.synchronize_device(device)
    used = before - (device.free_memory if device.is_cuda else 0)
    n, seconds = solver.particles.n, time.monotonic() - start
    told = f"{used / n:.0f}" if device.is_cuda else "-"
    sheet.add([f"{n:,}", f"{used / 1e9:.2f}", told, f"{seconds:.1f}"], {"n": n, "bytes": used})
    del solver, data
    gc.collect()
    wp.synchronize_device(device)  # only now the pool gives memory back
    return seconds


STAGES = {
    "facts": Stage("Machine", ("", ""), facts),
    "compare": Stage(
        "Device against CPU, every scheme",
        ("scheme", "", "precision", *COMPARED, "energy", "repeats bit for bit", "verdict"),
        compare,
    ),
    "tests": Stage("Tests", ("passed", "failed", "skipped"), tests),
    "graph": Stage(
        "Replayed graph against plain launches, float32",
        ("", "scheme", "particles", "µs a step, plain", "µs a step, graph", "plain/graph", "same bits",
         "M particle-steps/s"),
        graph,
    ),
    "bench": Stage("Benchmark", ("particles", "everything in"), bench),
    "layouts": Stage("Data layouts", layouts.HEADER, try_layouts),
    "memory": Stage(
        "Memory, sav1 in 3D, float32", ("particles", "GB", "bytes a particle", "s to build"), memory
    ),
}  # fmt: skip
"""What `gpu_check` runs, by name."""
