"""Hostile and broken files: thousands of spoilt meshes, snapshots, checkpoints and tables are read by a process of limits."""

import contextlib
import json
import os
import select
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import mutations, originals, victim
from .trial import Findings, Means

SEED = 6
"""Of all that is drawn."""

PATIENCE = 60.0
"""Wall time after which a file counts as one that hangs [s]; a busy machine must not decide."""

FULL, QUICK = 230, 9
"""Mutated files of each format."""

KEPT = 100 * 2**20
"""Memory that a process may have taken for one file before another one takes over: libraries keep some [bytes]."""

SEALED = ("snapshot", "checkpoint")
"""Formats in which a change of the content, or of the seal, must be found."""

MENDED = (
    "VTK crashed on 103 of 150 spoilt PLY files and 13 of 150 OBJ files, and 76 of 150 PLY files in text ended with a traceback: "
    "neither VTK nor HDF5 now sees a file that warpsph has not checked",
    "13 of 150 spoilt snapshots were read with other figures, without a word",
    "tracebacks: numbers of bodies and materials out of range; a deformation gradient that is not finite, so that the last snapshot "
    "of a run that went wrong could not be described; pressures of 1e308 in a frame; a summary nested a thousand deep, whose warnings "
    "were no list, or whose wall time was infinite; a history with a cell of more than 131072 characters",
    "sums of a state with infinities of both signs ended a resumed run with a traceback",
    "a pipe in place of a history held the program up",
    "control characters in names of bodies and in messages reached the terminal, and dollar signs were taken for formulas",
    "facts of a checkpoint within others, of its ledger and guards, were taken as they came: tracebacks in mid-run",
    "a mesh that encloses nothing passed, all its triangles being there twice",
)
"""What this trial, or what was tried on the way to it, found wrong."""


@dataclass
class Try:
    """One spoilt file.

    Attributes:
        form: Its format.
        way: How it was spoilt.
        path: Where it is.
        strict: Whether other content than the original's must not come back.
    """

    form: str
    way: str
    path: Path
    strict: bool


def run(means: Means) -> Findings:
    """Spoil files, have each read, and count what comes of it."""
    rng = np.random.default_rng(SEED)
    good = originals.make(means.scratch / "good", run=not means.quick)
    folder = means.scratch / "spoilt"
    folder.mkdir()
    with Victim() as process:
        if "run" in good:
            shutil.copytree(good["run"], means.scratch / "sound")
        read = good | ({"run": means.scratch / "sound"} if "run" in good else {})
        sound = {form: process.read(form, path) for form, path in read.items()}
        unread = [form for form, answer in sound.items() if answer["outcome"] != "read"]
        if unread:
            raise RuntimeError(f"sound files are not read: {unread}, {sound[unread[0]]['said']}")
        done: list[tuple[Try, dict[str, Any]]] = []
        for attempt in _tries(rng, good, folder, means.quick):
            done.append((attempt, process.read(attempt.form, attempt.path)))
            if len(done) % 200 == 0:
                means.say(f"{len(done)} files")
            _remove(attempt.path)
    return _findings(done, {form: answer["said"] for form, answer in sound.items()})


class Victim:
    """The process that reads; a new one after each crash or hang."""

    def __init__(self):
        """Start it at the first file."""
        self._process: subprocess.Popen | None = None

    def read(self, form: str, path: Path) -> dict[str, Any]:
        """Have a file read; gives what `victim.attempt` says, or the outcomes ``crash`` and ``hang``."""
        if self._process is None:
            command = [sys.executable, "-m", victim.__name__]
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        with contextlib.suppress(BrokenPipeError):  # it has died: no answer comes
            self._process.stdin.write(f"{form}\t{path}\n".encode())
            self._process.stdin.flush()
        if not select.select([self._process.stdout], [], [], PATIENCE)[0]:
            self.close()
            return {"outcome": "hang", "said": "", "seconds": PATIENCE, "memory": 0}
        answer = self._process.stdout.readline()
        if answer:
            found = json.loads(answer)
            if found["memory"] > KEPT:
                self.close()
            return found
        code = self._process.wait()
        self.close()
        return {"outcome": "crash", "said": f"exit code {code}", "seconds": 0.0, "memory": 0}

    def close(self) -> None:
        """End it."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process.stdout.close()
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        self._process = None

    def __enter__(self) -> "Victim":
        return self

    def __exit__(self, *_) -> None:
        self.close()


def _tries(rng: np.random.Generator, good: dict[str, Path], folder: Path, quick: bool) -> Iterator[Try]:
    """Spoilt files, made one by one."""
    for form, path in good.items():
        if form == "run":
            continue
        data = path.read_bytes()
        ways = mutations.BYTES + mutations.OF_FORMAT[form]
        for number in range(QUICK if quick else FULL):
            way = ways[number % len(ways)]
            yield _written(form, way(rng, data), way.__name__, folder / path.name, form in SEALED)
        if form in SEALED:
            for number in range((2 if quick else 1) * (QUICK if quick else FULL)):
                way = (mutations.index, mutations.values, mutations.index, mutations.extremes)[number % 4]
                name = f"{way.__name__}, right seal"
                yield _written(form, way(rng, data), name, folder / path.name, False)
        yield from _no_files(form, folder, path.suffix)
    for path in mutations.structures(folder, good["snapshot"]):
        yield Try("snapshot", "hostile HDF5", path, True)
    if not quick:
        yield from _runs(rng, good, folder)
        yield from _commands(rng, good, folder)


def _written(form: str, data: bytes, way: str, path: Path, strict: bool) -> Try:
    """Write a spoilt file."""
    path.write_bytes(data)
    return Try(form, way, path, strict)


def _no_files(form: str, folder: Path, suffix: str) -> Iterator[Try]:
    """What is no plain file, or nothing."""
    names = {
        way: folder / f"odd_{number}{suffix}"
        for number, way in enumerate(("empty", "folder", "pipe", "loop", "device"))
    }
    names["empty"].touch()
    names["folder"].mkdir()
    os.mkfifo(names["pipe"])
    names["loop"].symlink_to(names["loop"])
    names["device"].symlink_to("/dev/zero")
    for path in names.values():
        yield Try(form, "no plain file", path, True)


def _runs(rng: np.random.Generator, good: dict[str, Path], folder: Path) -> Iterator[Try]:
    """Folders of a run that cannot go on, since its checkpoint is spoilt, with a right seal or without."""
    data = (good["run"] / "checkpoint.h5").read_bytes()
    for number in range(60):
        way = (mutations.index, mutations.values, mutations.extremes, mutations.flip)[number % 4]
        path = folder / "run"
        shutil.copytree(good["run"], path)
        (path / "checkpoint.h5").write_bytes(way(rng, data))
        yield Try("run", way.__name__, path, False)


def _commands(rng: np.random.Generator, good: dict[str, Path], folder: Path) -> Iterator[Try]:
    """Spoilt files for whole commands: `info`, and `plot` and `render` of a folder."""
    ways = (mutations.values, mutations.extremes, mutations.index, mutations.extremes)
    for number in range(20):
        way = ways[number % 4]
        yield _written(
            "`warpsph info`",
            way(rng, good["snapshot"].read_bytes()),
            way.__name__,
            folder / "s_0001.vtkhdf",
            False,
        )
        path = folder / "rendered"
        path.mkdir()
        yield Try(
            "`warpsph render`",
            way.__name__,
            _written(
                "", way(rng, good["snapshot"].read_bytes()), "", path / "s_0001.vtkhdf", False
            ).path.parent,
            False,
        )
        path = folder / "plotted"
        path.mkdir()
        way = (mutations.number, mutations.line)[number % 2]
        (path / "history.csv").write_bytes(way(rng, good["history"].read_bytes()))
        yield Try("`warpsph plot`", way.__name__, path, False)


def _remove(path: Path) -> None:
    """Remove a file of any kind."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()


def _findings(done: list[tuple[Try, dict[str, Any]]], sound: dict[str, str]) -> Findings:
    """Count outcomes by format and by mutation."""
    header = (
        "format",
        "tried",
        "refused",
        "read, as it was",
        "read, changed",
        "traceback",
        "crash",
        "hang",
        "slowest [s]",
        "most memory [MB]",
    )
    found = Findings(header)
    outcomes = [_outcome(attempt, answer, sound) for attempt, answer in done]
    for form in dict.fromkeys(attempt.form for attempt, _ in done):
        mine = [k for k, (attempt, _) in enumerate(done) if attempt.form == form]
        count = Counter(outcomes[k] for k in mine)
        slowest, memory = max(done[k][1]["seconds"] for k in mine), max(done[k][1]["memory"] for k in mine)
        cells = [str(count[name]) for name in ("refused", "same", "changed", "traceback", "crash", "hang")]
        found.rows.append((form, str(len(mine)), *cells, f"{slowest:.2f}", f"{memory / 2**20:.0f}"))
    for (attempt, answer), outcome in zip(done, outcomes, strict=True):
        if outcome in ("traceback", "crash", "hang") or (outcome == "changed" and attempt.strict):
            found.failed.append(f"{attempt.form}, {attempt.way}: {outcome} {answer['said']}"[:300])
    ways = Counter(attempt.way for attempt, _ in done)
    refused = Counter(
        attempt.way for (attempt, _), outcome in zip(done, outcomes, strict=True) if outcome == "refused"
    )
    listed = ", ".join(f"{way} {refused[way]}/{number}" for way, number in ways.items())
    found.notes = [
        f"{len(done)} files, spoilt with seed {SEED}, each read by a process that may take {victim.ROOM // 2**20} MB more than its "
        f"libraries, within {PATIENCE:.0f} s. *Refused* is one clear line (exit code 2). A file of text, or one that was sealed again after "
        "it was spoilt, may say something else that makes sense: *read, changed*.",
        f"Refused by mutation: {listed}.",
        "Found wrong, and mended: " + "; ".join(MENDED) + ".",
    ]
    return found


def _outcome(attempt: Try, answer: dict[str, Any], sound: dict[str, str]) -> str:
    """What came of one file; what was read is told apart by its checksum."""
    if answer["outcome"] != "read":
        return answer["outcome"]
    return "same" if answer["said"] == sound.get(attempt.form) else "changed"
