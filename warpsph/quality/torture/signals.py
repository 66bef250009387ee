"""Trial: runs are asked to stop, by signals at random moments and by their wall time; how soon they do, and how."""

import random
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from warpsph.errors import InputError
from warpsph.storage import checkpoint

from .child import SCENE, Child, command
from .trial import Findings, Means

SEED = 7
"""Of the moments."""

LONG = "1e-2"
"""Simulated time that no run of the trial reaches [s]."""

FINE = ("--spacing", "1.2e-4")
"""Options of a run whose batches of steps take tenths of a second: 8842 particles."""

WALLTIME, SLACK = 5.0, 0.5
"""Limit of the runs with a wall time [s], and how long loading the program may vary by [s]."""

SHORT = 3.0
"""That limit in the short version [s]; where loading takes as long, the run ends before its first step."""


@dataclass
class _Row:
    """What came of one kind of request."""

    about: str
    code: int
    seconds: list[float] = field(default_factory=list)
    checkpoints: int = 0
    resumed: int = 0

    def cells(self) -> tuple[str, ...]:
        """Cells of the table."""
        times = f"{median(self.seconds):.1f}", f"{max(self.seconds):.1f}"
        return (
            self.about,
            str(len(self.seconds)),
            str(self.code),
            *times,
            str(self.checkpoints),
            str(self.resumed),
        )


def run(means: Means) -> Findings:
    """Ask runs to stop."""
    found = Findings(
        (
            "asked by",
            "times",
            "exit code",
            "seconds to the end, median",
            "longest",
            "checkpoints",
            "gone on with",
        )
    )
    trial = _Trial(means, found)
    few = 1 if means.quick else 8
    trial.signals("SIGTERM during steps, 138 particles", signal.SIGTERM, 143, few)
    if not means.quick:
        trial.signals("SIGINT during steps, 138 particles", signal.SIGINT, 130, few)
        for number, code in ((signal.SIGTERM, 143), (signal.SIGINT, 130)):
            trial.signals(f"{number.name} during steps, 8842 particles", number, code, 4, FINE)
            trial.early(f"{number.name} in the first second", number, code, 12)
        trial.twice(4)
    trial.walltimes(1 if means.quick else 4)
    found.notes.append(
        f"A request at a random moment (seed {SEED}). Each process must end with its own code and one line, without a "
        "traceback; once it has taken steps it must leave a checkpoint, from which `warpsph resume` is then tried. For "
        f"`--walltime {WALLTIME:g}` the seconds are those from the start of the process."
    )
    return found


class _Trial:
    """Runs of one scene, each in a folder of its own."""

    def __init__(self, means: Means, found: Findings):
        self.means, self.found = means, found
        self.scene = means.scratch / "balls.py"
        self.scene.write_text(SCENE)
        self.draw = random.Random(SEED)
        self.count = 0

    def start(self, *options: str) -> tuple[Child, Path]:
        """Start a run that takes longer than anyone waits."""
        self.count += 1
        out = self.means.scratch / str(self.count)
        return Child(
            "run", self.scene, "--until", LONG, "--snapshots", 1000, *options, "--out", out, "--no-frames"
        ), out

    def signals(self, about: str, number: int, code: int, times: int, options: tuple[str, ...] = ()) -> None:
        """Send a signal while steps are taken."""
        row = _Row(about, code)
        for _ in range(times):
            child, out = self.start(*options)
            child.wait_for((out / "checkpoint.h5").exists)
            child.wait(self.draw.uniform(0.0, 1.0))
            self.end(row, child, out, lambda child: child.signal(number))
            self.resume(row, out)
        self.add(row)

    def early(self, about: str, number: int, code: int, times: int) -> None:
        """Send a signal while the program is loaded and the scene built; the interpreter's own start is left alone."""
        row = _Row(about, code)
        for _ in range(times):
            child, out = self.start()
            child.wait_for(child.listens)
            child.wait(self.draw.uniform(0.0, 1.0))
            self.end(
                row, child, out, lambda child: child.signal(number), whole=(out / "checkpoint.h5").exists()
            )
        self.add(row)

    def twice(self, times: int) -> None:
        """Send two signals: the second ends the process whatever it does."""
        row = _Row("SIGINT twice during steps, 8842 particles", 130)
        for _ in range(times):
            child, out = self.start(*FINE)
            child.wait_for((out / "checkpoint.h5").exists)

            def press(child: Child) -> None:
                child.signal(signal.SIGINT)
                time.sleep(0.02)
                child.signal(signal.SIGINT)

            self.end(row, child, out, press)
            self.resume(row, out)
        self.add(row)

    def walltimes(self, times: int) -> None:
        """Let the wall time run out."""
        limit = SHORT if self.means.quick else WALLTIME
        row = _Row(f"--walltime {limit:g}, 138 particles", 5)
        for _ in range(times):
            started = time.monotonic()
            child, out = self.start("--walltime", f"{limit:g}")
            self.end(row, child, out, lambda _: None, since=started)
            self.resume(row, out)
        if max(row.seconds) > WALLTIME + SLACK and not self.means.quick:  # tests share their machine
            self.found.failed.append(f"{row.about}: took {max(row.seconds):.1f} s")
        self.add(row)

    def end(
        self,
        row: _Row,
        child: Child,
        out: Path,
        ask: Callable[[Child], None],
        since: float | None = None,
        whole: bool = True,
    ) -> None:
        """Ask for the end, and see how it comes; ``whole``: there has to be a checkpoint."""
        since = time.monotonic() if since is None else since
        ask(child)
        code, said = child.end()
        row.seconds.append(time.monotonic() - since)
        last = said.splitlines()[-1:] or [""]
        if code != row.code or "Traceback" in said or not last[0].startswith("warpsph: "):
            self.found.failed.append(f"{row.about}: ended with code {code}: {said}")
        try:
            checkpoint.load(out / "checkpoint.h5")
            row.checkpoints += 1
        except InputError as error:
            if whole:
                self.found.failed.append(f"{row.about}: {error}")

    def resume(self, row: _Row, out: Path) -> None:
        """Go on from there, a little."""
        until = 1.02 * checkpoint.load(out / "checkpoint.h5")[1]["time"] + 1e-8
        code, said = command("resume", out, "--until", until)
        row.resumed += code == 0
        if code != 0 or "Traceback" in said:
            self.found.failed.append(f"{row.about}: going on ended with code {code}: {said}")

    def add(self, row: _Row) -> None:
        """Put a row into the table."""
        self.means.say(f"{row.about}: {len(row.seconds)} times")
        self.found.rows.append(row.cells())
