"""What ``warpsph bench`` measures: every family of schemes on a block of particles, and two scenes as they are."""

import functools
import gc
import itertools
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import warp as wp

from warpsph import library
from warpsph.device.launch import Launcher, find_device
from warpsph.errors import InputError, RunError
from warpsph.info import table
from warpsph.messages import values
from warpsph.progress import Progress
from warpsph.search.neighbours import MAX_PARTICLES
from warpsph.solver import PRECISIONS
from warpsph.storage import atomic

from . import ceilings, performance, report, startup, trial
from .trial import CASES, SCENES, SCHEMES, Case

DEFAULT_PRECISIONS = ("float64", "float32")
"""Precisions that are measured where none is asked for."""

SMALLEST = 100
"""Particles of the block, at least."""


def bench(
    cases: Sequence[str] = (),
    device: str = "cpu",
    *,
    precisions: Sequence[str] | None = None,
    sizes: Sequence[int] | None = None,
    threads: int | None = None,
    json: Path | None = None,
    budget: float | None = None,
    progress: Progress | None = None,
) -> str:
    """Measure cases, and add them to docs/performance.md where this runs from a checkout.

    Args:
        cases: Names of `CASES`, or of `SCHEMES` for 2D and 3D; all, and how long a start takes, if there are none.
        device: Where to compute.
        precisions: Names of `warpsph.solver.PRECISIONS`.
        sizes: Particles of the block.
        threads: CPU threads; all cores if not given.
        json: File for everything that was measured, written after every case.
        budget: No case is begun after so long [s].
        progress: Where progress goes; plain lines to stderr if None.

    Returns:
        The tables, for a terminal.

    Raises:
        InputError: An argument is not allowed.
    """
    end = time.monotonic() + budget if budget is not None else float("inf")
    say = progress.message if progress else functools.partial(print, file=sys.stderr, flush=True)
    found = find_device(device)
    chosen = choose(cases)
    precisions = _checked("precision", precisions or DEFAULT_PRECISIONS, PRECISIONS)
    sizes = sizes or performance.DEFAULT_SIZES["cuda" if found.is_cuda else "cpu"]
    for size in sizes:
        if not SMALLEST <= size <= MAX_PARTICLES:
            raise values.outside("-n", size, f"{SMALLEST} to {MAX_PARTICLES} particles")
    say("measuring what the device can do ...")
    launcher = Launcher(device, threads)
    best = {name: asdict(ceilings.measure(launcher, _real(name))) for name in precisions}
    record: dict[str, Any] = {"facts": report.facts(found), "ceilings": best, "trials": []}
    for done in _trials(_jobs(chosen, sizes), best, end, say, device=device, threads=threads):
        record["trials"].append(done)
        _write(json, record)
    if not cases and time.monotonic() < end:
        record["startup"] = {}
        for scene in library.names():
            say(f"starting {scene} with an empty cache of kernels, and again ...")
            try:
                record["startup"][scene] = startup.measure(scene, device)
            except RunError as error:
                say(str(error))
            _write(json, record)
    root = report.checkout()
    if root is not None:
        try:
            performance.add(root, record)
        except ImportError as error:
            say(f"no picture: {error}")
    return "\n\n".join(
        f"{title}\n{table(rows, header)}"
        for title, header, rows in performance.tables(performance.rounded(record))
    )


def choose(names: Sequence[str]) -> list[Case]:
    """Cases by their names, in the order of `CASES`; all if there are none.

    Raises:
        InputError: There is no such case.
    """
    if not names:
        return list(CASES.values())
    allowed = {name: {f"{name}-2d", f"{name}-3d"} for name in SCHEMES} | {name: {name} for name in CASES}
    for name in names:
        if name not in allowed:
            raise values.unknown("case", name, (*SCHEMES, *SCENES), "each scheme's -2d or -3d alone")
    wanted = set().union(*(allowed[name] for name in names))
    return [case for name, case in CASES.items() if name in wanted]


def _trials(
    jobs: list[tuple[Case, int | None]],
    best: dict[str, dict],
    end: float,
    say: Callable[[str], None],
    **options,
) -> Iterator[dict[str, Any]]:
    """Measure every job in the precisions that ``best`` has ceilings of; what the device has no room for says so.

    The options are those of `trial.measure`; nothing is begun after ``end``.
    """
    built, data, seconds = None, None, 0.0
    origin = {"commit": report.commit(), "date": report.today()}
    for (case, size), precision in itertools.product(jobs, best):
        if time.monotonic() >= end:
            say(f"{case.name}, {precision}: left out, the time is up")
            continue
        place = (case.dim, size) if case.scheme else case.name
        if place != built:
            data = None  # two scenes at once need not fit into memory
            (data, seconds), built = trial.build(case, size), place
        say(f"{case.name}, {len(data.x):,} particles, {precision}")
        done = {"case": case.name, "asked": size, "particles": len(data.x), "precision": precision, **origin}
        try:
            measured = trial.measure(trial.with_scheme(data, case), precision=precision, **options)
            done |= {"scene_s": seconds, "ceilings": best[precision], **measured}
        except (InputError, RunError, MemoryError, RuntimeError) as error:
            say(f"{case.name}, {precision}: {error}")
            done["failed"] = str(error)
        yield done
        gc.collect()


def _jobs(chosen: list[Case], sizes: Sequence[int]) -> list[tuple[Case, int | None]]:
    """Cases on the block from small to large, then the scenes, which have a size of their own."""
    blocks = [(case, size) for size in sorted(sizes) for case in chosen if case.scheme]
    return blocks + [(case, None) for case in chosen if not case.scheme]


def _checked(what: str, names: Sequence[str], allowed: Sequence[str]) -> list[str]:
    for name in names:
        if name not in allowed:
            raise values.unknown(what, name, allowed)
    return list(dict.fromkeys(names))


def _real(precision: str) -> type:
    """Scalar type whose ceilings a precision is held against."""
    return wp.float64 if precision == "float64" else wp.float32


def _write(path: Path | None, record: dict[str, Any]) -> None:
    if path is not None:
        atomic.write(Path(path), performance.text(record).encode())
