"""The command ``scripts/torture``: run trials, print what they find, write it into ``docs/reliability.md``."""

import argparse
import importlib
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import warp as wp

from warpsph.quality import report

from .trial import Findings, Means

TRIALS = {
    "restart": "Going on with a run",
    "kill": "Killed without warning",
    "signals": "Asked to stop",
    "disk": "A disk that takes no more",
    "lock": "Two runs in one folder",
    "guards": "Guards in the loop",
    "memory": "Memory",
    "files": "Hostile and broken files",
    "scenes": "Drawn scenes",
    "extreme": "Extreme physics",
}
"""Trials in the order of the page, with what each is about; ``NAME.run(means)`` of this package gives its findings."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the trials that are named, or all; 1 if something did not hold, 2 for a name that is none."""
    options = _parser().parse_args(arguments)
    unknown = [name for name in options.trials if name not in TRIALS]
    if unknown:
        print(f"error: trial {unknown[0]!r} is unknown; allowed: {', '.join(TRIALS)}", file=sys.stderr)
        return 2
    wp.config.quiet = True
    facts = report.facts(wp.get_device("cpu"))  # before the first table makes the checkout dirty
    source = ", ".join(facts[key] for key in ("date", "device", "warpsph", "libraries"))
    wrong = []
    for name in options.trials or TRIALS:
        found, seconds = attempt(name, options.quick)
        text = describe(name, found, seconds, source)
        print(f"\n## {TRIALS[name]}\n\n{text}\n", flush=True)
        wrong += [f"{name}: {line}" for line in found.failed]
        if options.write:
            report.write_section(report.checkout() / "docs" / "reliability.md", name, text)
    for line in wrong:
        print(f"error: {line}", file=sys.stderr)
    return 1 if wrong else 0


def attempt(name: str, quick: bool) -> tuple[Findings, float]:
    """Run one trial in a folder of its own; gives what it found and how long it took [s]."""
    trial = importlib.import_module(f"{__package__}.{name}")
    scratch = Path(tempfile.mkdtemp(prefix=f"torture_{name}_"))
    started = time.perf_counter()
    try:
        found = trial.run(Means(scratch, quick, lambda line: print(f"{name}: {line}", flush=True)))
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return found, time.perf_counter() - started


def describe(name: str, found: Findings, seconds: float, source: str) -> str:
    """Lay findings out as Markdown, with where they come from."""
    wrong = [f"**Did not hold:** {line}" for line in found.failed]
    table = [report.markdown(found.header, found.rows)] if found.rows else []
    how = f"`scripts/torture {name}`, {seconds:.0f} s; {source}."
    return "\n\n".join([*found.notes, *wrong, *table, how])


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="scripts/torture", description="Try out what a run survives.")
    trials = "; ".join(f"{name}: {about}" for name, about in TRIALS.items())
    parser.add_argument("trials", nargs="*", metavar="TRIAL", help=f"all if none is named. {trials}")
    parser.add_argument("--quick", action="store_true", help="the short version of each, as in the tests")
    parser.add_argument("--write", action="store_true", help="write the tables of docs/reliability.md")
    return parser


if __name__ == "__main__":
    sys.exit(main())
