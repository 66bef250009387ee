"""A disk that takes no more: full, over a quota, read-only, gone; at every stage of a run's output.

Most failures are made up (`faults`): of the calls that write output, one after the other is refused. The rest is real: file
systems of a few hundred kilobytes, which take a mount namespace of one's own (`small_disks`), limits of the process, folders
that are removed, streams that nobody reads.
"""

import contextlib
import errno
import itertools
import json
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .bench import Bench, clear
from .faults import Refusal, watched
from .trial import Findings, Means

CODES = (
    errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS, errno.ENOENT, errno.EACCES, errno.ESTALE,
)  # fmt: skip
"""Causes that refused calls are given in turn."""

STRIDE = 2
"""Of the many calls that write a piece of a file every second is refused, of all others each."""

HEADER = (
    "what takes no more",
    "tries",
    "ends as it must",
    "earlier output whole",
    "with room it ends the same",
)

STAGES = {
    "vtkhdf": "snapshot", "series": "index of snapshots", "h5": "checkpoint", "csv": "history", "json": "summary",
    "png": "frames", "py": "copy of the scene",
}  # fmt: skip
"""Stages of output by the ending of what they write."""

LIMIT = 180.0
"""Seconds after which a process of its own counts as hanging."""


@dataclass
class Tally:
    """What came of some tries of one kind.

    Attributes:
        tries: How many there were.
        stopped: Those that ended as they must: exit code 4 and one line with the cause, if nothing else is said.
        whole: Those that left every file with a name whole, and no other.
        same: Those that went on with room and ended as an unharmed run.
        compared: Whether they went on with room.
        failed: What did not hold.
    """

    tries: int = 0
    stopped: int = 0
    whole: int = 0
    same: int = 0
    compared: bool = True
    failed: list[str] = field(default_factory=list)

    def add(self, stopped: str | None, harm: str | None, difference: str | None) -> None:
        """Count a try by what is wrong with it in each respect; None if nothing is."""
        self.tries += 1
        self.stopped += stopped is None
        self.whole += harm is None
        self.same += difference is None
        self.failed += [text for text in (stopped, harm, difference) if text is not None]


Table = dict[str, Tally]
"""Tallies by what takes no more."""


def run(means: Means) -> Findings:
    """Try everything; the quick version the last call of each stage and one limit."""
    table: Table = {}
    bench = Bench(means.scratch)
    notes = [refused_calls(bench, means, table)]
    limited_files(bench, means, table)
    if not means.quick:
        vanishing(bench, means, table)
        streams(bench, means, table)
        notes += small_disks(means, table)
    found = Findings(HEADER, notes=notes)
    for name, tally in table.items():
        counts = [f"{count} of {tally.tries}" for count in (tally.stopped, tally.whole, tally.same)]
        found.rows.append((name, str(tally.tries), *(counts if tally.compared else [*counts[:2], "-"])))
        found.failed += [f"{name}: {text}" for text in tally.failed]
    return found


def refused_calls(bench: Bench, means: Means, table: Table) -> str:
    """Refuse one call after the other, once or from then on; gives what was done."""
    out, seen = means.scratch / "refused", Refusal(None, errno.EIO)
    with watched(seen):
        bench.run(out)
    chosen, pieces = [], itertools.count()
    for number, (what, _) in enumerate(seen.seen, start=1):
        if what != "write" or next(pieces) % STRIDE == 0:
            chosen.append(number)
    if means.quick:
        chosen = list({stage(path): number for number, (_, path) in enumerate(seen.seen, start=1)}.values())
    for turn, number in enumerate(chosen):
        code = CODES[turn % len(CODES)]
        refusal = Refusal(number, code, lasting=turn // len(CODES) % 2 == 1)
        clear(out)
        with watched(refusal):
            ended = bench.run(out)
        if refusal.fired is None:
            continue  # the order of calls differs by a few: the run and its writer take turns
        what, path = refusal.fired
        judge(
            bench,
            table,
            f"a call refused, {stage(path)}",
            out,
            ended,
            os.strerror(code),
            f"{what} {path.name}",
        )
        if turn % 50 == 0:
            means.say(f"refused call {number} of {len(seen.seen)}")
    causes = ", ".join(os.strerror(code) for code in CODES)
    return (
        f"A run makes {len(seen.seen)} calls of the system that write output. {len(chosen)} of them were refused, one in each run, "
        f"half of them together with all later ones, with these causes in turn: {causes}. "
        "Where no other exit code is named, a run must end with 4 and one line that names the cause."
    )


def limited_files(bench: Bench, means: Means, table: Table) -> None:
    """Let the system cut files that grow beyond a limit: in this process, and once in one of its own."""
    out, name = means.scratch / "limited", "a limit on the size of files"
    for limit in () if means.quick else range(2_000, 162_000, 8_000):
        clear(out)
        with limited(limit):
            ended = bench.run(out)
        if ended[0]:
            judge(bench, table, name, out, ended, os.strerror(errno.EFBIG), f"limit {limit}")
    clear(out)
    ended = separate(
        bench.words(out), preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
    )
    judge(bench, table, name, out, ended, os.strerror(errno.EFBIG), "a process of its own")


def vanishing(bench: Bench, means: Means, table: Table) -> None:
    """Take the output folder, or a part of it, away just before a file gets its name."""
    out, aside = means.scratch / "vanishing", means.scratch / "aside"

    def removed() -> None:
        shutil.rmtree(out)

    def replaced() -> None:
        shutil.rmtree(out)
        out.write_text("a file\n")

    def moved() -> None:
        out.rename(aside)

    def beheaded() -> None:
        (out / "history.csv").unlink()

    def emptied() -> None:
        shutil.rmtree(out / "snapshots")

    kinds = {
        "the folder removed": removed, "a file in the folder's place": replaced, "the folder moved away": moved,
        "history.csv removed": beheaded, "snapshots/ removed": emptied,
    }  # fmt: skip
    for (name, take), number in itertools.product(kinds.items(), range(4, 11, 2)):
        clear(out)
        with watched(_At(number, take)):
            ended = bench.run(out)
        if take is moved:
            if out.exists():
                raise RuntimeError(f"{out} has come back")
            aside.rename(out)
        cause = os.strerror(errno.ENOTDIR if take is replaced else errno.ENOENT)
        which = f"before file {number}"
        judge(bench, table, name, out, ended, cause, which, anew=take is not moved, parts=take is not moved)


class _At:
    """Does something before the file of a number gets its name."""

    def __init__(self, number: int, action: Callable[[], None]):
        self._left, self._action = number, action

    def __call__(self, what: str, _path: Path) -> None:
        self._left -= what == "replace"
        if self._left == 0 and what == "replace":
            self._action()


def streams(bench: Bench, means: Means, table: Table) -> None:
    """Close what a run prints to, or let it be full: it runs on, and only lost results are an error."""
    out = means.scratch / "streams"
    cases = {
        "stderr on a full disk": ("2>/dev/full", 0), "stderr to a pipe that is closed": ("2> >(true)", 0),
        "stdout to a pipe that is closed": ("> >(true)", 0), "no stdout and no stderr": (">&- 2>&-", 0),
        "stdout on a full disk": (">/dev/full", 4),
    }  # fmt: skip
    for name, (how, code) in cases.items():
        clear(out)
        line = " ".join(f"'{word}'" for word in bench.words(out))
        ended, said = separate(["bash", "-c", f"{line} {how}"])
        wrong = None
        if ended != code or "Traceback" in said or "Exception ignored" in said:
            wrong = f"exit code {ended} instead of {code}; stderr: {said.strip()[-200:]!r}"
        table.setdefault(f"{name} (exit code {code})", Tally()).add(
            wrong, _first(bench.harm_in(out)), bench.difference(out)
        )


def small_disks(means: Means, table: Table) -> list[str]:
    """Run on real file systems of all sizes, from nothing up to what a run needs; gives what was done, or why not."""
    worker = [sys.executable, "-m", "warpsph.quality.torture.small_disks", str(means.scratch / "small")]
    for own in (["unshare", "-m"], ["unshare", "-rm"]):
        probe = [*own, "mount", "-t", "tmpfs", "-o", "size=64k", "none", str(means.scratch)]
        try:
            allowed = subprocess.run(probe, capture_output=True, timeout=LIMIT).returncode == 0
        except OSError:
            allowed = False
        if allowed:
            break
    else:
        return ["Small file systems were not tried: this system lets the user mount none."]
    means.say("small file systems")
    code, said = separate([*own, *worker], 4.0 * LIMIT)
    if code:
        table["small file systems"] = Tally(failed=[f"the process ended with {code}: {said.strip()[-400:]}"])
        return []
    told = json.loads((means.scratch / "small" / "found.json").read_text())
    table |= {name: Tally(**tally) for name, tally in told["table"].items()}
    return told["notes"]


def judge(
    bench: Bench, table: Table, name: str, out: Path, ended: tuple[int, str], cause: str, which: str,
    anew: bool = False, parts: bool = True,
) -> None:  # fmt: skip
    """Look at how a run has ended and at what it left, then go on with it: three marks in the tally of a name.

    Args:
        bench: What was run.
        table: Where the marks go.
        name: What took no more.
        out: Folder of the run.
        ended: Its exit code and stderr.
        cause: What they have to name.
        which: Which try this is.
        anew: Start anew with ``--force``, since what was written is no longer there.
        parts: Whether the run could remove half-written files.
    """
    stopped = misbehaved(ended, cause)
    harm = _first(bench.harm_in(out, parts)) if out.is_dir() else None
    if out.is_file():  # put there in place of the folder
        out.unlink()
    code, said = bench.run(out, "--force") if anew else bench.go_on(out)
    difference = bench.difference(out) if code == 0 else f"going on ended with {code}: {said.strip()[-200:]}"
    marks = (f"{which}: {text}" if text else None for text in (stopped, harm, difference))
    table.setdefault(name, Tally()).add(*marks)


def misbehaved(ended: tuple[int, str], cause: str) -> str | None:
    """What is wrong with an end by a failing disk; None if it has its code and one line that names the cause."""
    code, said = ended
    lines = [line for line in said.splitlines() if line.startswith("warpsph:")]
    if code != 4:
        return f"exit code {code}: {said.strip()[-200:]}"
    if "Traceback" in said or "Exception ignored" in said:
        return f"a traceback: {said.strip()[-200:]}"
    if len(lines) != 1 or "could not be written" not in lines[0] or cause not in lines[0]:
        return f"the line does not name the cause: {lines}"
    return None


def stage(path: Path) -> str:
    """The stage of output that a file belongs to."""
    ending = path.name.removesuffix(".part").rpartition(".")[2]
    return STAGES.get(ending, "folders")


def separate(words: list[str], limit: float = LIMIT, **options) -> tuple[int, str]:
    """Run a command in a process of its own; gives exit code and stderr. One that hangs is killed and has code -9."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **options)
    try:
        said = process.communicate(timeout=limit)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        said = process.communicate()[1] + f"\nkilled after {limit:g} s"
    return process.returncode, said


@contextlib.contextmanager
def limited(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond a size."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def _first(found: list[str]) -> str | None:
    return found[0] if found else None
