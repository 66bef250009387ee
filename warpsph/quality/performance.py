"""The page of the benchmark: results of every device, kept as JSON beside it, as tables and as a picture.

Results that were measured elsewhere are added with ``python -m warpsph.quality.performance FILE ...``.
"""

import io
import json
import math
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from warpsph.messages import measuring
from warpsph.storage import atomic

from . import report
from .trial import CASES

PAGE, FOLDER, PICTURE = "docs/performance.md", "docs/performance", "docs/images/performance.png"
"""The page, the folder of the results, and the picture, in a checkout."""

DEFAULT_SIZES = {"cpu": (30_000,), "cuda": (1_000_000, 10_000_000)}
"""Particles of the block where none are asked for; the page has tables of these."""

LEAST_SHARE = 0.05
"""Kernels that take less of a step than this are left out of the table; the JSON has them."""

LONG = 40
"""Rows from which on a table is folded up on the page."""

Table = tuple[str, Sequence[str], list[list[str]]]
"""Title, header and rows."""

SPEED_HEADER = (
    "case", "particles", "precision", "M particle-steps/s", "ns per particle-step", "min", "max", "M pairs/s",
    "neighbours", "search", "steps per rebuild", "date", "commit",
)  # fmt: skip
"""Columns of the table of speed."""

ROOM_HEADER = (
    "case", "particles", "precision", "Eulerian", "bytes per particle", "of these lists", "scene s", "solver s",
    "snapshot s",
)  # fmt: skip
"""Columns of the table of memory, and of what a user waits for besides."""

KERNEL_HEADER = (
    "case", "particles", "precision", "kernel", "ns per particle-step", "share", "M pairs/s", "GB/s", "of the copy",
    "GFLOP/s", "of the peak",
)  # fmt: skip
"""Columns of the table of kernels."""


def add(root: Path, record: dict[str, Any]) -> None:
    """Add results to those that the checkout at ``root`` has of their device, and draw the page anew.

    Raises:
        InputError: The page has no place for them, or other results are damaged.
    """
    path = root / FOLDER / f"{_slug(record['facts']['device'])}.json"
    path.parent.mkdir(exist_ok=True)
    known = read(path) if path.is_file() else {}
    atomic.write(path, text(merged(known, record)).encode())
    draw(root)


def text(record: dict[str, Any]) -> str:
    """Results as JSON, a trial a line, numbers to five digits."""
    head = json.dumps(rounded({name: value for name, value in record.items() if name != "trials"}), indent=1)
    trials = ",\n".join(json.dumps(rounded(trial)) for trial in record["trials"])
    return head.removesuffix("\n}") + f',\n "trials": [\n{trials}\n ]\n}}\n'


def rounded(value: Any) -> Any:
    """Something of JSON with its numbers rounded."""
    if isinstance(value, dict):
        return {name: rounded(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [rounded(inner) for inner in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def merged(known: dict[str, Any], new: dict[str, Any]) -> dict[str, Any]:
    """Known results with the new ones in place of those of the same case, size, precision and threads."""
    trials = {_key(trial): trial for trial in (*known.get("trials", ()), *new["trials"])}
    ceilings = known.get("ceilings", {}) | new["ceilings"]
    return known | new | {"ceilings": ceilings, "trials": sorted(trials.values(), key=_order)}


def read(path: Path) -> dict[str, Any]:
    """Read results.

    Raises:
        InputError: The file holds none.
    """
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        record["facts"]["device"], record["ceilings"], record["trials"]
    except (ValueError, KeyError, TypeError) as error:
        raise measuring.no_results(path) from error
    return record


def draw(root: Path) -> None:
    """Write tables and picture of all results of a checkout."""
    records = [read(path) for path in sorted((root / FOLDER).glob("*.json"))]
    parts = []
    for record in records:
        facts = "\n".join(f"- {name}: {value}" for name, value in record["facts"].items() if name != "device")
        parts += [f"## {record['facts']['device']}", facts, *map(_section, tables(_usual(record)))]
    report.write_section(root / PAGE, "performance", "\n\n".join(parts))
    atomic.write(root / PICTURE, picture(records))


def _section(table: Table) -> str:
    """A table in Markdown; a long one is folded up."""
    title, header, rows = table
    body = report.markdown(header, rows)
    if len(rows) > LONG:
        body = f"<details><summary>{len(rows)} rows</summary>\n\n{body}\n\n</details>"
    return f"### {title}\n\n{body}"


def tables(record: dict[str, Any]) -> list[Table]:
    """Tables of the results of a device."""
    good = [trial for trial in record["trials"] if "failed" not in trial]
    limits = record["ceilings"]
    found = [
        ("What the device does at best", ("precision", "copy GB/s", "multiply-add GFLOP/s"),
         [[name, f"{c['bandwidth'] / 1e9:.4g}", f"{c['flops'] / 1e9:.4g}"] for name, c in limits.items()]),
        ("Speed", SPEED_HEADER, [_head(trial) + _speed(trial) for trial in good]),
        ("Memory and waiting", ROOM_HEADER, [_head(trial) + _room(trial) for trial in good]),
        ("Kernels", KERNEL_HEADER, [row for trial in good for row in _kernels(trial)]),
    ]  # fmt: skip
    if "startup" in record:
        header = ("scene", "s to the first step, cold cache of kernels", "warm")
        rows = [[name, f"{s['cold']:.3g}", f"{s['warm']:.3g}"] for name, s in record["startup"].items()]
        found.insert(1, ("Start of a run", header, rows))
    failed = [
        [t["case"], f"{t['particles']:,}", t["precision"], t["failed"]]
        for t in record["trials"]
        if "failed" in t
    ]
    if failed:
        found.append(("Not measured", ("case", "particles", "precision", "why"), failed))
    return found


def picture(records: list[dict[str, Any]]) -> bytes:
    """Particle-steps per second against particles, of every case on the block and every device: a PNG."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    trials = [
        (k, t)
        for k, record in enumerate(records)
        for t in record["trials"]
        if t["asked"] and "failed" not in t
    ]
    precisions = sorted({t["precision"] for _, t in trials}, reverse=True) or ["float64"]
    figure = Figure(figsize=(10.0, 1.0 + 3.6 * len(precisions)), dpi=120, layout="constrained")
    grid = figure.subplots(len(precisions), 2, squeeze=False, sharey=True)
    for row, precision in zip(grid, precisions, strict=True):
        for axes, dim in zip(row, (2, 3), strict=True):
            chosen = [(k, t) for k, t in trials if (t["precision"], t["dim"]) == (precision, dim)]
            _panel(axes, chosen, f"{dim}D, {precision}")
        row[0].set_ylabel("particle-steps per second")
    names = [record["facts"]["device"] for record in records]
    lines = [Line2D([], [], color=colour, label=name) for name, colour in COLOURS.items()]
    lines += [Line2D([], [], color="#555555", label=name, **_style(k)) for k, name in enumerate(names)]
    figure.legend(handles=lines, loc="outside lower center", ncols=4, frameon=False)
    memory = io.BytesIO()
    figure.savefig(memory, format="png")
    return memory.getvalue()


COLOURS = {
    "eulerian": "#1d3f6e", "eulerian-mixed": "#5b8cc4", "tl": "#b3432b", "adaptle": "#e0a32e", "ts2": "#3d7d4f",
    "pm": "#8a5a9e",
}  # fmt: skip
"""Colour of each family."""

STYLES = (
    {"marker": "o", "linestyle": "--"}, {"marker": "s", "linestyle": "-"}, {"marker": "^", "linestyle": ":"},
    {"marker": "D", "linestyle": "-."},
)  # fmt: skip
"""Style of each device."""


def _panel(axes: Any, trials: list[tuple[int, dict[str, Any]]], title: str) -> None:
    """Draw one line for each family and device, of the runs with the most threads."""
    for device in sorted({k for k, _ in trials}):
        threads = max(t["threads"] for k, t in trials if k == device)
        for name, colour in COLOURS.items():
            line = sorted(
                (t["particles"], t["particle_steps_per_s"])
                for k, t in trials
                if (k, t["threads"], t["case"][:-3]) == (device, threads, name)
            )
            axes.plot([n for n, _ in line], [rate for _, rate in line], color=colour, **_style(device))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_title(title, fontsize=11, loc="left")
    axes.set_xlabel("particles")
    axes.grid(color="#dddddd", linewidth=0.8, which="both")
    axes.spines[["top", "right"]].set_visible(False)


def _style(device: int) -> dict[str, Any]:
    """Marker and line of a device."""
    return STYLES[device % len(STYLES)] | {"markersize": 4}


def _usual(record: dict[str, Any]) -> dict[str, Any]:
    """The results at the sizes of a run without -n; the picture has the others."""
    usual = {None, *DEFAULT_SIZES["cuda" if "driver" in record["facts"] else "cpu"]}
    return record | {"trials": [trial for trial in record["trials"] if trial["asked"] in usual]}


def _head(trial: dict[str, Any]) -> list[str]:
    return [trial["case"], f"{trial['particles']:,}", trial["precision"]]


def _speed(trial: dict[str, Any]) -> list[str]:
    ns, lasting = trial["ns_per_particle_step"], trial["steps_per_rebuild"]
    return [
        f"{trial['particle_steps_per_s'] / 1e6:.3g}", _ns(median(ns)), _ns(min(ns)), _ns(max(ns)),
        f"{trial['pairs_per_s'] / 1e6:.3g}", f"{trial['mean_neighbours']:.1f}", f"{trial['search_share']:.0%}",
        f"{lasting:.1f}" if lasting else "-", trial["date"], trial["commit"].replace(", with changes", "+"),
    ]  # fmt: skip


def _room(trial: dict[str, Any]) -> list[str]:
    sizes = [f"{trial[name]:,.0f}" for name in ("bytes_per_particle", "list_bytes_per_particle")]
    waits = [trial[name] for name in ("scene_s", "solver_s", "snapshot_s")]
    return [f"{trial['eulerian_share']:.0%}", *sizes, *("-" if s is None else f"{s:.2g}" for s in waits)]


def _kernels(trial: dict[str, Any]) -> list[list[str]]:
    """Rows of the kernels that take most of a step."""
    best = trial["ceilings"]
    rows = []
    for kernel in trial["kernels"]:
        if kernel["share"] >= LEAST_SHARE:
            cells = [kernel["name"], _ns(kernel["ns_per_particle_step"]), f"{kernel['share']:.0%}"]
            cells += [_of(kernel["pairs_per_s"], 1e6)]
            cells += [_of(kernel["bytes_per_s"], 1e9), _share(kernel["bytes_per_s"], best["bandwidth"])]
            cells += [_of(kernel["flops_per_s"], 1e9), _share(kernel["flops_per_s"], best["flops"])]
            rows.append(_head(trial) + cells)
    return rows


def _ns(value: float) -> str:
    return f"{value:.3g}" if value < 100.0 else f"{value:,.0f}"


def _of(value: float, unit: float) -> str:
    return f"{value / unit:.3g}" if value else "-"


def _share(value: float, whole: float) -> str:
    return f"{value / whole:.0%}" if value else "-"


def _key(trial: dict[str, Any]) -> tuple:
    return tuple(trial.get(name) for name in ("case", "asked", "precision", "threads"))


def _order(trial: dict[str, Any]) -> tuple[float, int, int]:
    """Place in the tables: from small to large, the scenes last, cases and precisions in their own order."""
    cases, precisions = [*CASES, trial["case"]], ["float64", "float32", trial["precision"]]
    return trial["asked"] or math.inf, cases.index(trial["case"]), precisions.index(trial["precision"])


def _slug(device: str) -> str:
    """File name of a device."""
    return re.sub(r"[^a-z0-9]+", "-", device.lower()).strip("-")


def main(files: Sequence[str]) -> None:
    """Add the results of some files to this checkout, and draw its page.

    Raises:
        InputError: This is no checkout.
    """
    root = report.checkout()
    if root is None:
        raise measuring.no_checkout()
    for name in files:
        add(root, read(Path(name)))
    draw(root)


if __name__ == "__main__":
    main(sys.argv[1:])
