"""Trial: a run that is stopped again and again ends in the same bits as one that never was."""

import itertools
import json
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

from warpsph.errors import InputError
from warpsph.progress import Progress
from warpsph.run import resume
from warpsph.run import run as run_scene
from warpsph.storage import checkpoint, snapshot
from warpsph.storage.folder import DAMAGED, NEWEST, PREVIOUS

from .trial import Findings, Means
from .variants import VARIANTS, Variant, make

SOURCE = '''"""A variant of the trial of restarts."""

from warpsph.quality.torture import variants


def build(variant: str = "sav1"):
    """Build it.

    Args:
        variant: Its name.
    """
    return variants.make(variant)
'''
"""The scene file of all variants."""

BATCHES = 2, 1, 4, 3
"""Batches of steps between two stops, in turn."""

QUICK = "mon-mixed-as", "tl, contact, hourglass control, erosion", "adaptle, conversion by strain, 2.5 km/s"
"""Variants of the short version."""

BROKEN = "mon-mixed-as"
"""The variant whose checkpoints are damaged."""

TIMINGS = "wall_s", "step_wall_s", "ns_per_particle_step", "ns_per_pair", "threads"
"""Entries of a summary that may differ."""


def run(means: Means) -> Findings:
    """Stop and go on with every variant, and damage checkpoints."""
    found = Findings(("scheme, options", "particles", "steps", "stopped and gone on", "same bits"))
    found.notes.append(
        f"Each scene is run once unbroken, and once stopped after every {' or '.join(map(str, sorted(BATCHES)))} batches of "
        "steps, in mid-interval or not, and gone on with in a new solver, on one and on two threads in turn. Compared bit for bit: "
        "all arrays of all snapshots, history.csv, the summary with its measures, and the last checkpoint."
    )
    for name in QUICK if means.quick else VARIANTS:
        unbroken, stopped = means.scratch / "unbroken" / name, means.scratch / "stopped" / name
        summary = _start(name, unbroken)
        stops = _stop_again_and_again(name, stopped, most=6 if means.quick else None)
        differing = differences(unbroken, stopped)
        verdict = f"no: {differing}" if differing else "yes"
        found.rows.append((name, str(summary["particles"]), str(summary["steps"]), str(stops), verdict))
        found.failed += [f"{name}: {differing}"] if differing else []
        means.say(f"{name}: {stops} stops, same bits: {verdict}")
    for name, damage in DAMAGES.items():
        outcome = _damaged(means.scratch, name.replace(" ", "_"), damage)
        found.rows.append((f"{BROKEN}, {name}", "", "", "1", outcome))
        found.failed += [] if outcome.startswith("yes") else [f"{name}: {outcome}"]
    return found


class Stopper(Progress):
    """Presses Ctrl-C after some batches of steps, and says nothing."""

    def __init__(self, batches: float):
        """Stop after so many."""
        super().__init__()
        self._left = batches
        self.said: list[str] = []

    def update(self, **_) -> None:
        """Count a batch."""
        self._left -= 1
        if self._left == 0:
            signal.raise_signal(signal.SIGINT)

    def message(self, text: str) -> None:
        """Keep a line."""
        self.said.append(text)


def differences(one: Path, two: Path) -> str:
    """The first thing in which the folders of two runs differ, timings and what was said on the way aside; else nothing."""
    return next(_differing(one, two), "")


def _differing(one: Path, two: Path) -> Iterator[str]:
    names = [[path.name for path in snapshot.find(out)] for out in (one, two)]
    if names[0] != names[1]:
        yield f"{len(names[1])} snapshots instead of {len(names[0])}"
    for name in names[0]:
        states = [snapshot.read(out / "snapshots" / name) for out in (one, two)]
        if (states[0].time, states[0].step) != (states[1].time, states[1].step):
            yield f"time of {name}"
        yield from (f"{field} of {name}" for field in _unlike(*(dict(state.fields) for state in states)))
    (arrays, info), (others, other) = (checkpoint.load(out / NEWEST) for out in (one, two))
    yield from (f"{field} of the last checkpoint" for field in _unlike(arrays, others))
    said = [facts["job"].pop("remarks") for facts in (info, other)]
    for facts in (info, other):
        del facts["job"]["wall"], facts["job"]["step_wall"]
    yield from (f"{key} of the last checkpoint" for key in info if info[key] != other[key])
    if (one / "history.csv").read_bytes() != (two / "history.csv").read_bytes():
        yield "history.csv"
    summaries = [json.loads((out / "summary.json").read_text()) for out in (one, two)]
    for summary, remarks in zip(summaries, said, strict=True):
        summary["warnings"] = [line for line in summary["warnings"] if line not in remarks]
    yield from (
        f"{key} of the summary"
        for key in summaries[0]
        if key not in TIMINGS and summaries[0][key] != summaries[1].get(key)
    )


def _unlike(arrays: dict, others: dict) -> Iterator[str]:
    """Names of arrays that are not the same bits."""
    for name in arrays.keys() | others.keys():
        pair = arrays.get(name), others.get(name)
        if any(array is None for array in pair) or len({(a.dtype, a.shape, a.tobytes()) for a in pair}) > 1:
            yield name


def _start(name: str, out: Path, batches: float = 0, threads: int = 2) -> dict:
    """Run a variant, stopped after some batches."""
    variant: Variant = VARIANTS[name]
    return run_scene(
        make(name), out, precision=variant.precision, threads=threads, source=SOURCE, frames=False,
        parameters={"variant": name}, progress=Stopper(batches),
    )  # fmt: skip


def _stop_again_and_again(name: str, out: Path, most: int | None) -> int:
    """Run a variant, stop and go on until it has ended; gives how often it was stopped.

    Args:
        name: The variant.
        out: Folder of the run.
        most: Stops at most; None: as many as there are.
    """
    batches, stops = itertools.cycle(BATCHES), 0
    try:
        _start(name, out, next(batches))
        return stops
    except KeyboardInterrupt:
        stops += 1
    while True:
        last = most is not None and stops >= most
        try:
            resume(out, threads=1 + stops % 2, frames=False, progress=Stopper(0 if last else next(batches)))
            return stops
        except KeyboardInterrupt:
            stops += 1


def _cut(out: Path) -> None:
    """Take the last thousand bytes of the newest checkpoint off."""
    path = out / NEWEST
    path.write_bytes(path.read_bytes()[:-1000])


def _flip(out: Path) -> None:
    """Change one bit in an array of the newest checkpoint."""
    path = out / NEWEST
    content = bytearray(path.read_bytes())
    content[content.index(checkpoint.load(path)[0]["v"].tobytes()[:64]) + 5] ^= 1
    path.write_bytes(content)


def _lose(out: Path) -> None:
    """Leave what a kill between the two renames leaves."""
    (out / NEWEST).unlink()


def _spoil(out: Path) -> None:
    """Damage both."""
    for name in (NEWEST, PREVIOUS):
        (out / name).write_bytes(b"nothing")


DAMAGES: dict[str, Callable[[Path], None]] = {
    "newest checkpoint cut short": _cut,
    "a bit of it flipped": _flip,
    "newest checkpoint gone": _lose,
    "both checkpoints overwritten": _spoil,
}
"""What happens to the checkpoints of a stopped run."""


def _damaged(scratch: Path, folder: str, damage: Callable[[Path], None]) -> str:
    """Damage the checkpoints of a stopped run and go on; gives what came of it, ``yes`` in front if it was right."""
    unbroken, out = scratch / "unbroken" / BROKEN, scratch / folder
    try:
        _start(BROKEN, out, batches=17)
        return "no: it was not stopped"
    except KeyboardInterrupt:
        damage(out)
    listener, damaged = Stopper(0), (out / NEWEST).exists()
    try:
        resume(out, frames=False, progress=listener)
    except InputError as error:
        named = all(str(out / name) in str(error) for name in (NEWEST, PREVIOUS))
        return "yes: refused, both are named" if damage is _spoil and named else f"no: {error}"
    differing = differences(unbroken, out)
    if damage is _spoil or differing:
        return f"no: {differing or 'it was not refused'}"
    if damaged and not (any(NEWEST in line for line in listener.said) and (out / DAMAGED).is_file()):
        return "no: the damaged one was not named"
    return "yes, from the previous one" + (", the damaged one is named" if damaged else "")
