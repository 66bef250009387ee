"""``warpsph validate``: run the validation cases and set what comes out beside what was published and is expected."""

import itertools
import math
import re
from pathlib import Path
from typing import Any

from warpsph import library
from warpsph.device.launch import find_device
from warpsph.errors import DiskError, RunError
from warpsph.info import table
from warpsph.messages import values
from warpsph.progress import Progress
from warpsph.run import run
from warpsph.storage import atomic

from . import report
from .cases import CASES
from .cases.tables import Case, Convergence, Figure, Row, Table

INSIDE, OUTSIDE = "✓", "✗"
"""Marks of a figure in and out of the range that is expected of it."""

Summaries = dict[str, dict[str, Any] | str]
"""Summary of each row by name, or why it stopped."""


def validate(
    case: str | None, out: Path, *, device: str = "cpu", progress: Progress | None = None
) -> list[str]:
    """Run a case, or all, and write the tables: into docs/validation.md of a checkout, else into ``out``.

    Args:
        case: Name of the case; None for all.
        out: Folder for the runs, one below it for each row; an earlier validation's are replaced.
        device: Where to compute.
        progress: Where progress goes.

    Returns:
        One line for each figure out of its expected range.

    Raises:
        InputError: There is no such case, or the folder cannot be used.
        DiskError: A run, a table or a picture cannot be written.
    """
    if case is not None and case not in CASES:
        raise values.unknown("case", case, CASES)
    progress = progress or Progress()
    outside: list[str] = []
    origin = report.facts(find_device(device))  # before the first report makes the checkout dirty
    for chosen in [CASES[case]] if case else CASES.values():
        found = _run_case(chosen, Path(out), device, progress)
        for part in chosen.tables:
            outside += _outside(part, found)
            print(f"\n{chosen.scene}: {part.title}\n{table(_rows(part, found), _header(part))}")
        if (part := chosen.convergence) is not None:
            print(f"\n{chosen.scene}: {part.title}\n{table(_orders(part, found), _header(part))}")
        _publish(chosen, found, origin, Path(out))
        _draw(chosen, found, Path(out))
    print("\n" + ("\n".join(outside) or "every figure is where it is expected"))
    return outside


def verdict(figure: Figure, row: Row, value: float) -> str:
    """Mark a value, in the unit to show, as in or out of its expected range; empty if nothing is expected."""
    if figure.expected is None or figure.name in row.unexpected:
        return ""
    rounded = value if figure.decimals is None else round(value, figure.decimals)
    return INSIDE if figure.expected[0] <= rounded <= figure.expected[1] else OUTSIDE


def _run_case(case: Case, out: Path, device: str, progress: Progress) -> Summaries:
    """Run every row of a case; a run that has to stop leaves its reason in place of a summary."""
    file = library.load(case.scene)
    found: Summaries = {}
    for row in (row for part in case.tables for row in part.rows):
        progress.message(f"{case.scene}: {row.name}")
        folder = _folder(case, row, out)
        values = {name: p.default for name, p in file.parameters.items()} | row.parameters
        try:
            found[row.name] = run(
                file.build(**row.parameters), folder, device=device, precision=row.precision, force=True,
                parameters=values, source=file.source, frames=False, progress=progress,
            )  # fmt: skip
        except DiskError:
            raise
        except RunError as error:
            found[row.name] = str(error)
    return found


def _folder(case: Case, row: Row, out: Path) -> Path:
    """Folder of a row's run."""
    return out / case.scene / re.sub(r"\W+", "-", row.name)


def _value(figure: Figure, summary: dict[str, Any]) -> float:
    """A figure of a summary in the unit to show."""
    return figure.factor * (
        summary[figure.name] if figure.name in summary else summary["measures"][figure.name]
    )


def _header(part: Table | Convergence) -> list[str]:
    titles = [f.title + (f" [{f.unit}]" if f.unit != "1" else "") for f in part.figures]
    return ["", *titles]


def _rows(part: Table, found: Summaries) -> list[list[str]]:
    """Rows of text: what is expected, each run beside its published values, and published rows that are not run."""
    rows = [["expected", *(_range(f) for f in part.figures)]]
    for row in part.rows:
        summary = found[row.name]
        if isinstance(summary, str):
            rows.append([row.name, f"{OUTSIDE} {summary}", *[""] * (len(part.figures) - 1)])
            continue
        rows.append([row.name])
        for figure in part.figures:
            value = _value(figure, summary)
            paper = f"({_shown(figure, row.paper[figure.name])})" if figure.name in row.paper else ""
            cells = f"{value:{figure.style}}", paper, verdict(figure, row, value)
            rows[-1].append(" ".join(filter(None, cells)))
    for name, found in part.others.items():
        shown = (f"({_shown(f, found[f.name])})" if f.name in found else "" for f in part.figures)
        rows.append([name, *shown])
    return rows


def _orders(part: Convergence, found: Summaries) -> list[list[str]]:
    """Rows of text: log2 of the ratio of errors from each resolution to the next, for each series."""
    rows = []
    for name, series in part.series.items():
        runs = [found[row] for row in series]
        rows.append([name])
        for figure in part.figures:
            errors = [math.nan if isinstance(run, str) else _value(figure, run) for run in runs]
            orders = (math.log2(coarse / fine) for coarse, fine in itertools.pairwise(errors))
            rows[-1].append(", ".join(f"{order:.2f}" for order in orders))
    return rows


def _range(figure: Figure) -> str:
    if figure.expected is None:
        return ""
    low, high = figure.expected
    return f"≤ {high:g}" if low == 0.0 else f"{low:g} to {high:g}"


def _shown(figure: Figure, value: float) -> str:
    """A published value as it is printed there."""
    return f"{value:{figure.style}}" if figure.decimals is None else f"{value:.{figure.decimals}f}"


def _outside(part: Table, found: Summaries) -> list[str]:
    """One line for each figure out of its range, and for each run that stopped."""
    lines = []
    for row in part.rows:
        summary = found[row.name]
        if isinstance(summary, str):
            lines.append(f"{row.name}: {summary}")
            continue
        for figure in part.figures:
            value = _value(figure, summary)
            if verdict(figure, row, value) == OUTSIDE:
                unit = "" if figure.unit == "1" else f" {figure.unit}"
                lines.append(
                    f"{row.name}: {figure.name} {value:{figure.style}}{unit}, expected {_range(figure)}"
                )
    return lines


def _publish(case: Case, found: Summaries, origin: dict[str, str], out: Path) -> None:
    """Write a case's tables, with where they come from, into a checkout's documentation or the output folder."""
    parts = ["\n".join(f"- {name}: {value}" for name, value in origin.items())]
    parts += [
        f"### {part.title}\n\n{report.markdown(_header(part), _rows(part, found))}" for part in case.tables
    ]
    if (part := case.convergence) is not None:
        parts.append(f"### {part.title}\n\n{report.markdown(_header(part), _orders(part, found))}")
    root, text = report.checkout(), "\n\n".join(parts)
    if root is not None:
        report.write_section(root / "docs" / "validation.md", case.scene, text)
    else:
        atomic.write(out / f"{case.scene}.md", f"# {case.scene}\n\n{text}\n".encode())


def _draw(case: Case, found: Summaries, out: Path) -> None:
    """Make a case's pictures, in a checkout's documentation or the output folder, if all of its runs came to their end."""
    if any(isinstance(summary, str) for summary in found.values()):
        return
    root = report.checkout()
    target = out if root is None else root / "docs" / "images"
    folders = {row.name: _folder(case, row, out) for part in case.tables for row in part.rows}
    for picture in case.pictures:
        picture.draw(folders, target / picture.file)
