"""Everything to be found out on a GPU, stage by stage, each with a time limit: ``scripts/gpu_check`` calls it.

A stage is a process of its own and writes what it finds at once: one that is cut off or crashes costs no other.
"""

import argparse
import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from warpsph.storage import atomic

LIMITS = {"facts": 15, "compare": 105, "tests": 80, "graph": 35, "bench": 105, "layouts": 60, "memory": 80}
"""Seconds a stage may take, in the order of importance; what one leaves over goes to the last ones. In all 8 minutes."""

TAIL = 6.0
"""A stage ends by itself so long before its limit [s]."""


@dataclass
class Sheet:
    """What a stage has found so far: a table, its title and remarks, written to a file after every row.

    Attributes:
        path: The file.
        title: Title of the table.
        header: Its columns.
        rows: Its rows, as text.
        data: Everything behind them.
        notes: Remarks in front of it.
        failed: What is wrong; empty if nothing is.
        done: The stage has come to its end.
    """

    path: Path
    title: str
    header: Sequence[str]
    rows: list[list[str]] = field(default_factory=list)
    data: list[Any] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    done: bool = False

    def add(self, row: Sequence[str], data: object = None) -> None:
        """Add a row and write everything."""
        self.rows.append(list(row))
        self.data.append(data)
        self.write()

    def write(self) -> None:
        """Write the file, and the report of all stages beside it."""
        content = {name: value for name, value in vars(self).items() if name != "path"}
        atomic.write(self.path, json.dumps(content, indent=1, default=float).encode())
        write_report(self.path.parent)


def write_report(out: Path) -> None:
    """Lay the sheets of a folder out as Markdown, in ``report.md``."""
    parts = ["# GPU check"]
    for stage in LIMITS:
        path = out / f"{stage}.json"
        if not path.is_file():
            continue
        sheet = json.loads(path.read_text())
        state = "" if sheet["done"] else " (cut off)"
        lines = [sheet["header"], ["---"] * len(sheet["header"]), *sheet["rows"]]
        table = "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
        wrong = [f"**failed:** {text}" for text in sheet["failed"]]
        parts += [f"## {sheet['title']}{state}", *sheet["notes"], *wrong, table]
    atomic.write(out / "report.md", ("\n\n".join(parts) + "\n").encode())


def run_stage(command: list[str], log: Path, limit: float) -> str:
    """Run a stage; gives how it ended if not well. At the limit it is stopped, with every process it has started."""
    with log.open("ab") as stream:
        child = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            code = child.wait(limit)
        except (subprocess.TimeoutExpired, KeyboardInterrupt) as stop:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)
            child.wait()
            if isinstance(stop, KeyboardInterrupt):
                raise
            return f"stopped at its limit of {limit:.0f} s"
    return f"ended with code {code}" if code else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all stages, or the one that is named; 1 if something failed."""
    parser = argparse.ArgumentParser(prog="gpu_check", description=__doc__.splitlines()[0])
    parser.add_argument("--device", default="cuda:0", help="Warp device; cpu rehearses")
    parser.add_argument("--quick", action="store_true", help="small sizes and few rows: a rehearsal")
    parser.add_argument("--out", type=Path, default=Path(os.environ.get("OUT", "gpu_check")))
    parser.add_argument("--stage", choices=LIMITS, help="only this one")
    parser.add_argument(
        "--deadline", type=float, help="of a stage: when it should end, as time.monotonic has it"
    )
    given = parser.parse_args(arguments)
    given.out.mkdir(parents=True, exist_ok=True)
    if given.deadline is not None:
        return _one_stage(given)
    end = time.monotonic() + sum(LIMITS.values())
    stages = [given.stage] if given.stage else list(LIMITS)
    troubles = [_watched(stage, stages[k + 1 :], end, given) for k, stage in enumerate(stages)]
    print(f"{given.out / 'report.md'}: {'something failed' if any(troubles) else 'all well'}", flush=True)
    return int(any(troubles))


def _watched(stage: str, later: list[str], end: float, given: argparse.Namespace) -> bool:
    """Run a stage in its share of the time; tells whether something failed."""
    left = end - time.monotonic() - sum(LIMITS[name] for name in later)
    command = [sys.executable, "-m", "warpsph.quality.gpu_check", "--stage", stage, "--device", given.device]
    start = time.monotonic()
    command += ["--out", str(given.out), "--deadline", f"{start + left - TAIL:.1f}"]
    command += ["--quick"] * given.quick
    trouble = run_stage(command, given.out / "log.txt", left)
    path = given.out / f"{stage}.json"
    found = (
        json.loads(path.read_text()) if path.is_file() else {"failed": ["nothing was written"], "done": True}
    )
    ending = "; ".join(filter(None, [trouble, *found["failed"]])) or "well"
    if trouble and not found["done"]:
        found["failed"].append(trouble)
        atomic.write(path, json.dumps(found, indent=1).encode())
        write_report(given.out)
    print(f"{stage}: {time.monotonic() - start:.0f} s of {left:.0f}: {ending}", flush=True)
    return ending != "well"


def _one_stage(given: argparse.Namespace) -> int:
    from . import gpu_stages

    stage = gpu_stages.STAGES[given.stage]
    sheet = Sheet(given.out / f"{given.stage}.json", stage.title, stage.header)
    sheet.write()
    stage.run(sheet, given.device, given.quick, given.deadline)
    sheet.done = True
    sheet.write()
    return int(bool(sheet.failed))


if __name__ == "__main__":
    sys.exit(main())
