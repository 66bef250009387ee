"""What ``warpsph compare`` measures: the step loop of one impact, beside another code's, and what each scheme costs."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import median

from warpsph import library
from warpsph.device.cores import count_cores
from warpsph.device.launch import find_device
from warpsph.info import table
from warpsph.messages import values
from warpsph.progress import Progress
from warpsph.scene import Scene, SceneData
from warpsph.solver import Solver

from . import report, series
from .lagrangian_costs import lagrangian_costs
from .peer import Peer
from .scheme_costs import scheme_costs
from .series import HEADER, Series, Variant, advance, first_steps
from .stopwatch import REST, ROWS, kernel_times

SCHEME = "sav1-as"
"""Scheme of the two-dimensional case: what the peer script for PySPH solves."""

PRECISIONS = ("float64", "float32")
"""In the order of the tables."""


def compare(
    device: str = "cpu",
    *,
    peers: Sequence[str] = (),
    full: bool = False,
    lagrangian: bool = False,
    repeats: int = 5,
    progress: Progress | None = None,
) -> str:
    """Measure, and write the report into docs/benchmarks.md where this runs from a checkout.

    Args:
        device: Where to compute.
        peers: Commands of other codes, measured in turn with ours; each prints one line of JSON last.
        full: Measure the whole 8 µs as well, once with every variant, and the peers again in between.
        lagrangian: Measure Total Lagrangian and coupled steps instead, in a section of their own.
        repeats: Repetitions of every measurement.
        progress: Where progress goes.

    Returns:
        The report, for a terminal.

    Raises:
        InputError: An argument makes no sense.
        RunError: A peer failed.
    """
    if repeats < 1:
        raise values.outside("--repeats", repeats, "1 or more")
    if lagrangian and full:
        raise values.clash("--full", "--lagrangian", "one of them", "that has a plate of its own")
    say = (progress or Progress()).message
    origin = report.facts(find_device(device))
    if lagrangian:
        tables = lagrangian_costs(_variants(device), [Peer(command) for command in peers], repeats, say)
        return _told("lagrangian", origin, tables)
    data = impact_2d().finalize()
    variants, others = _variants(device), [Peer(command) for command in peers]
    rows = _in_turn("2D impact", data, variants, others, repeats, say)
    dt = next((peer.facts["dt"] for peer in others if "dt" in peer.facts), None)
    if dt is not None:
        double = [variant for variant in variants if variant.precision == "float64"]
        rows += _in_turn(
            "2D impact", at_step(data, dt), double, [], repeats, say, f" of about {dt * 1e9:.3g} ns"
        )
    beside = _comparison(others, rows)
    if full:
        others = [
            Peer(command) for command in peers
        ]  # measured anew: the machine may have got slower meanwhile
        whole = _whole_in_turn("2D impact", data, variants, others, say)
        rows, beside = rows + whole, beside + _comparison(others, whole)
    schemes = scheme_costs(impact_2d(), variants, repeats, say)
    say("timing every kernel ...")
    tables = [("", HEADER, [row.cells() for row in rows])]
    if beside:
        tables.append(("Beside other codes", PEER_HEADER, beside))
    tables.append(("What the schemes cost", *schemes))
    tables.append(("What a step is made of", *_shares(data, variants)))
    return _told("cuda" if find_device(device).is_cuda else "cpu", origin, tables)


def impact_2d() -> Scene:
    """Build the bundled scene hvi_2d at the paper's resolution."""
    return library.load("hvi_2d").build(scheme=SCHEME, spacing=1e-4)


def at_step(data: SceneData, dt: float) -> SceneData:
    """Give the same scene with the Courant number that makes the first step ``dt`` [s]."""
    solver = Solver(data)
    solver.advance(math.inf, lambda now: True)
    numerics = replace(data.numerics, cfl=data.numerics.cfl * dt / solver.reading.dt_max)
    return replace(data, numerics=numerics)


def _variants(device: str) -> list[Variant]:
    """Both precisions; on a CPU with one thread, then with all."""
    found = find_device(device)
    if found.is_cuda:
        return [Variant(device, precision, None) for precision in PRECISIONS]
    everything = count_cores()
    return [
        Variant(device, precision, threads) for threads in sorted({1, everything}) for precision in PRECISIONS
    ]


def _in_turn(
    case: str,
    data: SceneData,
    variants: list[Variant],
    peers: list[Peer],
    repeats: int,
    say: Callable[[str], None],
    which: str = "",
) -> list[Series]:
    """Measure the first steps with every variant and every peer in turn, so that all see the same machine."""
    window = f"steps {series.WARM_UP + 1} to {series.WARM_UP + series.STEPS}{which}"
    rows = [Series(case, window, variant, len(data.x)) for variant in variants]
    for k in range(repeats):
        say(f"{case}, {len(data.x):,} particles: repetition {k + 1} of {repeats}")
        for row in rows:
            first_steps(row, data)
        for peer in peers:
            peer.measure()
    return rows


def _whole_in_turn(
    case: str, data: SceneData, variants: list[Variant], peers: list[Peer], say: Callable[[str], None]
) -> list[Series]:
    """Measure a scene from beginning to end with every variant, and every peer after each."""
    rows = []
    for variant in variants:
        rows.append(_whole(case, data, variant, say))
        for peer in peers:
            peer.measure()
    return rows


def _whole(case: str, data: SceneData, variant: Variant, say: Callable[[str], None]) -> Series:
    """Measure a scene from beginning to end, once; neighbours are counted ten times in between."""
    say(
        f"{case}, {len(data.x):,} particles: the whole time, {variant.precision}, {variant.threads or 1} threads"
    )
    solver = variant.solver(data)
    row = Series(case, f"all {data.until * 1e6:g} µs", variant, len(data.x))
    wall, counts, builds = 0.0, [], 0
    for k in range(10):
        before, start = solver.neighbours.builds, time.perf_counter()
        solver.advance(data.until * (k + 1) / 10)
        wall += time.perf_counter() - start
        builds += solver.neighbours.builds - before
        counts.append(solver.mean_neighbours())
    row.steps, row.builds, row.neighbours = solver.reading.steps, builds, sum(counts) / len(counts)
    row.ns.append(1e9 * wall / (row.steps * len(data.x)))
    return row


PEER_HEADER = (
    "code", "particles", "neighbours", "threads", "steps", "its ns per particle-step: median", "min", "max",
    "window of warpsph", "warpsph's median", "times faster",
)  # fmt: skip
"""Columns of the comparison."""


def _comparison(peers: list[Peer], rows: list[Series]) -> list[list[str]]:
    """Each peer beside our float64 figures for the same case and number of threads."""
    out = []
    for peer in peers:
        for row in rows:
            if row.variant.threads in (peer.facts["threads"], None) and row.variant.precision == "float64":
                ours = median(row.ns)
                out.append([*peer.cells(), row.window, f"{ours:.4g}", f"{median(peer.ns) / ours:.2f}"])
    return out


def _shares(data: SceneData, variants: list[Variant]) -> tuple[list[str], list[list[str]]]:
    """Header and rows of the second table: time per particle and step, and its share, by kernel and variant."""
    columns = []
    for variant in variants:
        solver = variant.solver(data)
        advance(solver, series.WARM_UP)
        before = solver.reading.steps
        spent = kernel_times(solver, lambda solver=solver: advance(solver, series.STEPS))
        total = sum(spent.values())
        work = (solver.reading.steps - before) * len(data.x)
        columns.append({name: f"{1e9 * t / work:.3g} ({t / total:.0%})" for name, t in spent.items()})
    header = ["kernel, ns per particle-step (share)"]
    header += [f"{v.precision}, {_threads(v)}" for v in variants]
    own = [name for name in columns[0] if name not in (ROWS, REST)]
    names = own + [name for name in (ROWS, REST) if name in columns[0]]
    return header, [[name, *(column.get(name, "-") for column in columns)] for name in names]


def _threads(variant: Variant) -> str:
    return "GPU" if variant.threads is None else f"{variant.threads} thread{'s' * (variant.threads > 1)}"


def _told(section: str, origin: dict[str, str], tables: list) -> str:
    """Write the report into a section of the documentation of a checkout, and give it for a terminal."""
    root = report.checkout()
    if root is not None:
        facts = "\n".join(f"- {name}: {value}" for name, value in origin.items())
        parts = [
            f"### {title}\n\n" * bool(title) + report.markdown(head, body) for title, head, body in tables
        ]
        report.write_section(root / "docs" / "benchmarks.md", section, "\n\n".join([facts, *parts]))
    return "\n\n".join((f"{title}\n" if title else "") + table(body, head) for title, head, body in tables)
