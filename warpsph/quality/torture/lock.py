"""Trial: runs that want one folder at the same time, and a run whose lock was left behind."""

import signal
from collections.abc import Callable
from pathlib import Path

from .child import SCENE, Child
from .trial import Findings, Means

LONG = ("--until", "1e-1", "--snapshots", "10000", "--no-frames")
"""Options of a run that takes longer than anyone waits."""


def run(means: Means) -> Findings:
    """Let runs meet in one folder."""
    found = Findings(("tried", "times", "as it should be"))
    trial = _Trial(means, found)
    trial.add("two started at the same moment: one runs, the other is refused", trial.together, 20, 1)
    others = "while it runs: `run`, `run --force`, `resume` are refused, `info` and `plot` work"
    trial.add(others, trial.refused, 4, 0)
    trial.add("a run that was killed: `resume` says so, and takes its lock over", trial.stale, 4, 0)
    found.notes.append(
        "Who is refused ends with code 2 and one line that names host and process, and since when."
    )
    return found


class _Trial:
    """Runs of one scene."""

    def __init__(self, means: Means, found: Findings):
        self.means, self.found = means, found
        self.scene = means.scratch / "balls.py"
        self.scene.write_text(SCENE)

    def add(self, about: str, attempt: Callable[[Path], list[str]], times: int, quick: int) -> None:
        """Try something several times, each in a folder of its own."""
        times = quick if self.means.quick else times
        if not times:
            return
        good = 0
        for k in range(times):
            out = self.means.scratch / f"{attempt.__name__}_{k}"
            wrong = attempt(out)
            good += not wrong
            self.found.failed += [f"{about}: {line}" for line in wrong]
        self.means.say(f"{about}: {good} of {times}")
        self.found.rows.append((about, str(times), str(good)))

    def start(self, out: Path) -> Child:
        """Start a long run."""
        return Child("run", self.scene, *LONG, "--out", out)

    def together(self, out: Path) -> list[str]:
        """Two at the same moment; what was wrong."""
        pair = [self.start(out), self.start(out)]
        pair[0].wait_for(lambda: pair[1].process.poll() is not None)
        pair[1].wait_for(lambda: any(child.process.poll() is not None for child in pair))
        living = [child for child in pair if child.process.poll() is None]
        wrong = [] if len(living) == 1 else [f"{len(living)} of two are running"]
        for child in living:
            if not child.wait_for((out / "checkpoint.h5").exists):
                wrong.append("the winner writes nothing")
            child.signal(signal.SIGTERM)
        for child in pair:
            code, said = child.end()
            wrong += self.judge(code, said, 143 if child in living else 2, living)
        return wrong + (["the lock is still there"] if (out / "run.lock").exists() else [])

    def refused(self, out: Path) -> list[str]:
        """Others while a run is going on; what was wrong."""
        first = self.start(out)
        first.wait_for((out / "checkpoint.h5").exists)
        before = (out / "scene.py").stat()
        wrong = []
        force = ("run", self.scene, "--out", out, "--force")
        for tokens in (force, force[:-1], ("resume", out)):
            code, said = Child(*tokens).end()
            wrong += self.judge(code, said, 2, [first])
        for tokens in (("info", out), ("plot", out, "--output", out.with_suffix(".svg"))):
            code, said = Child(*tokens).end()
            wrong += [] if code == 0 else [f"{tokens[0]} ended with code {code}: {said}"]
        if (out / "scene.py").stat() != before or not (out / "checkpoint.h5").exists():
            wrong.append("files of the run were touched")
        if first.process.poll() is not None:
            wrong.append("the first run did not go on")
        first.signal(signal.SIGTERM)
        code, said = first.end()
        return wrong + self.judge(code, said, 143, [first])

    def stale(self, out: Path) -> list[str]:
        """After a kill; what was wrong."""
        first = self.start(out)
        first.wait_for((out / "checkpoint.h5").exists)
        first.signal(signal.SIGKILL)
        first.end()
        wrong = [] if (out / "run.lock").exists() else ["a kill has left no lock"]
        code, said = Child("resume", out, "--until", "1.1e-5").end()
        if code != 0 or f"process {first.process.pid} on" not in said or "taken over" not in said:
            wrong.append(f"resume ended with code {code}: {said}")
        return wrong + (["the lock is still there"] if (out / "run.lock").exists() else [])

    def judge(self, code: int, said: str, expected: int, living: list[Child]) -> list[str]:
        """Compare an end with what it should be: who is refused names the one that runs."""
        wrong = [] if code == expected else [f"ended with code {code}: {said}"]
        if expected == 2 and not any(f"in use by process {child.process.pid} on" in said for child in living):
            wrong.append(f"does not name the process that runs: {said}")
        return wrong
