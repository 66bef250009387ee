"""Trial: runs are killed at random moments, what lies there is read, and they are gone on with to the end."""

import json
import random
import signal
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from warpsph.errors import InputError
from warpsph.storage import checkpoint, folder, snapshot

from . import whole
from .child import SCENE, Child, command
from .trial import Findings, Means

SEED = 20
"""Of the moments."""

LOADING = 0.2
"""Share of kills within the first second, before any step."""

TIMINGS = ("wall", "step_wall", "wall_s", "step_wall_s", "ns_per_particle_step", "ns_per_pair")
"""Entries of checkpoints and summaries that are no physics."""

MOMENTS = ("while loading", "during an output", "between outputs", "after the last step")
"""When a kill falls: columns of the table."""


@dataclass(frozen=True)
class Case:
    """A run to be killed.

    Attributes:
        name: What it is called in the table.
        options: Options of ``warpsph run``.
        kills: How often it is killed in the full trial, over several runs.
        quick: The same in the short one.
    """

    name: str
    options: tuple[str, ...]
    kills: int
    quick: int = 0


CASES = (
    Case("138 particles, 20 outputs", ("--snapshots", "20", "--no-frames"), 24, 2),
    Case("8842 particles, 15 outputs", ("--spacing", "1.2e-4", "--until", "3e-7", "--snapshots", "15", "--no-frames"), 18),
    Case("138 particles, 4 outputs and frames", ("--snapshots", "4"), 8),
)  # fmt: skip


def run(means: Means) -> Findings:
    """Kill runs and compare what becomes of them with unbroken ones."""
    found = Findings(("run", "kills", *MOMENTS, "files read", "runs ended", "equal to the last bit"))
    for number, case in enumerate(CASES):
        kills = case.quick if means.quick else case.kills
        if kills:
            scratch = means.scratch / str(number)
            scratch.mkdir()
            found.rows.append(_Trial(case, kills, scratch, found.failed, means).row())
    found.notes.append(
        f"SIGKILL at random moments between start and end of a process (seed {SEED}). After each, every file under its "
        "final name is read from end to end; then the run is gone on with, and killed again, until a process ends by "
        "itself. Snapshots, index, history, checkpoint, summary and frames are then compared with those of a run that "
        "was never killed. A run without a checkpoint is refused by `warpsph resume`, which says so, and started anew."
    )
    return found


class _Trial:
    """One row of the table."""

    def __init__(self, case: Case, kills: int, scratch: Path, failed: list[str], means: Means):
        self.case, self.kills, self.scratch, self.failed, self.means = case, kills, scratch, failed, means
        self.scene, self.straight = scratch / "balls.py", scratch / "straight"
        self.scene.write_text(SCENE)
        self.draw = random.Random(SEED)
        self.moments: Counter[str] = Counter()

    def row(self) -> tuple[str, ...]:
        """Kill until it is enough, over as many runs as that takes."""
        self.measure()
        read = ended = equal = 0
        while self.moments.total() < self.kills:
            out = self.scratch / f"killed_{ended}"
            for moment in self.one_run(out):
                self.moments[moment] += 1
                read += self.check(out)
                self.means.say(f"{self.case.name}: kill {self.moments.total()} {moment}")
            ended += 1
            equal += self.is_equal(out)
        counts = [str(self.moments[name]) for name in MOMENTS]
        return self.case.name, str(self.kills), *counts, str(read), str(ended), str(equal)

    def measure(self) -> None:
        """Make the unbroken run, and see how long it takes from its first output on."""
        child = Child(*self.first(self.straight))
        child.wait_for((self.straight / "history.csv").exists)
        started = time.monotonic()
        code, said = child.end()
        self.seconds = time.monotonic() - started
        if code != 0:
            self.failed.append(f"{self.case.name}: the unbroken run ended with code {code}: {said}")

    def first(self, out: Path) -> tuple:
        """The command that starts the run."""
        return "run", self.scene, *self.case.options, "--out", out, "--threads", 1, "--force"

    def one_run(self, out: Path) -> Iterator[str]:
        """Start a run, kill it and go on with it until it ends; says of each kill when it came."""
        while True:
            goes_on = bool(folder.checkpoints(out))
            if not goes_on and out.exists():
                self.refused(out)
            begun = time.time()
            child = Child(*(("resume", out, "--threads", 1) if goes_on else self.first(out)))
            if self.moments.total() >= self.kills or self.ends(child, out, begun):
                code, said = child.end()
                if code != 0:
                    self.failed.append(f"{self.case.name}: going on ended with code {code}: {said}")
                return
            child.signal(signal.SIGKILL)
            child.end()
            yield _moment(out, begun)

    def ends(self, child: Child, out: Path, begun: float) -> bool:
        """Wait for a random moment: one in five while loading, the others later; whether the process has ended."""
        if self.draw.random() < LOADING:
            return child.wait(self.draw.uniform(0.0, 1.0))
        child.wait_for(lambda: _is_fresh(out / "history.csv", begun))
        return child.wait(self.draw.uniform(0.0, 0.5 * self.seconds))

    def refused(self, out: Path) -> None:
        """Without a checkpoint there is one line about what to do."""
        code, said = command("resume", out)
        if code != 2 or "--force" not in said or said.count("\n") != 1:
            self.failed.append(
                f"{self.case.name}: without a checkpoint resume ended with code {code}: {said}"
            )

    def check(self, out: Path) -> int:
        """Read every file from end to end; gives how many there are."""
        files = [path for path in out.rglob("*") if path.is_file() and not path.name.startswith(".")]
        for path in files:
            try:
                whole.check(path)
                if path.name == "scene.py" and path.read_text() != SCENE:
                    raise ValueError("it is not the scene")
            except (InputError, ValueError, OSError, SyntaxError) as error:
                self.failed.append(
                    f"{self.case.name}: after a kill {path.relative_to(out)} is broken: {error}"
                )
        return len(files)

    def is_equal(self, out: Path) -> bool:
        """Compare a run that was killed with the one that was not."""
        one, two = _contents(self.straight), _contents(out)
        wrong = sorted(name for name in one.keys() | two.keys() if one.get(name) != two.get(name))
        if wrong:
            self.failed.append(f"{self.case.name}: not equal to the unbroken run: {', '.join(wrong)}")
        return not wrong


def _moment(out: Path, begun: float) -> str:
    """When a kill came, by what the process that had begun at some time [s] has left there."""
    if not _is_fresh(out / "history.csv", begun) and not _is_done(out):
        return "while loading"
    if _is_done(out):
        return "after the last step"
    return (
        "during an output"
        if any(_is_fresh(part, begun) for part in out.rglob(".*.part"))
        else "between outputs"
    )


def _is_fresh(path: Path, begun: float) -> bool:
    """Whether a file is there and was written since a time [s]."""
    return path.exists() and path.stat().st_mtime >= begun


def _is_done(out: Path) -> bool:
    """Whether all steps are done and the summary says so."""
    path = out / "summary.json"
    return path.is_file() and json.loads(path.read_text())["outcome"] == "done"


def _contents(out: Path) -> dict[str, object]:
    """What a run has left, by file, without times of the clock."""
    found: dict[str, object] = {}
    for path in sorted(path for path in out.rglob("*") if path.is_file()):
        name = str(path.relative_to(out))
        if path.suffix == ".h5":
            arrays, info = checkpoint.load(path)
            found[name] = ({key: value.tobytes() for key, value in arrays.items()}, _timeless(info))
        elif path.name == "summary.json":
            found[name] = _timeless(json.loads(path.read_text()))
        elif path.suffix == ".vtkhdf":
            state = snapshot.read(path)
            found[name] = (
                state.time,
                state.step,
                {key: value.tobytes() for key, value in state.fields.items()},
            )
        else:
            found[name] = whole.picture(path) if path.suffix == ".png" else path.read_bytes()
    return found


def _timeless(facts: dict) -> dict:
    """Facts without times of the clock."""
    inner = {key: _timeless(value) if isinstance(value, dict) else value for key, value in facts.items()}
    return {key: value for key, value in inner.items() if key not in TIMINGS}
