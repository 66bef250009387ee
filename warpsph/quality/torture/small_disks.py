"""Runs on file systems of a few hundred kilobytes: a process of its own, in a mount namespace of its own (see `disk`)."""

import contextlib
import errno
import importlib.util
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from .bench import Bench, command
from .disk import Table, Tally, judge, misbehaved, stage
from .faults import Hook, watched

STEP = 4
"""Kilobytes from one size of the file system to the next: a page."""

AMPLE = 64 * 1024
"""Kilobytes with which everything fits."""

FULL = os.strerror(errno.ENOSPC)
"""The cause in the system's words."""


def main(scratch: Path) -> None:
    """Try all sizes; leaves ``found.json`` in the folder."""
    scratch.mkdir()
    place = scratch / "disk"
    place.mkdir()
    table: Table = {}
    bench = Bench(scratch)
    notes = [all_sizes(bench, place, table), *few_files(bench, place, table)]
    pictures(scratch, place, table)
    (scratch / "found.json").write_text(
        json.dumps({"table": {name: asdict(tally) for name, tally in table.items()}, "notes": notes})
    )


def all_sizes(bench: Bench, place: Path, table: Table) -> str:
    """Let the disk be full at every place of the run's output; every fifth run also goes on in vain before it has room."""
    refused = tries = 0
    for size in range(40, AMPLE, STEP):
        with mounted(place, f"size={size}k"):
            out, tries = place / "out", tries + 1
            ended = bench.run(out)
            if ended[0] == 0:
                break
            if ended[0] == 2:
                refused += "has no room" in ended[1] and not out.exists()
                continue
            if tries % 5 == 0:
                again(bench, out, table)
            enlarge(place)
            judge(bench, table, f"a full disk, {_stage(ended[1])}", out, ended, FULL, f"{size} kB")
    return (
        f"Disks of 40 to {size} kB in steps of {STEP} kB: {refused} were refused before anything was written, since not even the "
        f"first output fits, and the last one was large enough."
    )


def again(bench: Bench, out: Path, table: Table) -> None:
    """Go on while the disk is still full: it must end in the same way, get further or be refused, and harm nothing."""
    ended = bench.go_on(out)
    refused = ended[0] == 2 and "has no room" in ended[1]  # it had no checkpoint yet, and is to start anew
    wrong = misbehaved(ended, FULL) if ended[0] and not refused else None
    harm = (bench.harm_in(out) or [None])[0]
    table.setdefault("gone on with no more room", Tally(compared=False)).add(wrong, harm, None)


def few_files(bench: Bench, place: Path, table: Table) -> list[str]:
    """Let the disk have room for bytes, but not for another file; and be read-only when a run is to go on."""
    for count in range(6, 13):
        with mounted(place, f"size={AMPLE}k,nr_inodes={count}"):
            ended = bench.run(place / "out")
            if ended[0]:
                enlarge(place, ",nr_inodes=1000")
                judge(
                    bench,
                    table,
                    "a disk with no room for another file",
                    place / "out",
                    ended,
                    FULL,
                    f"{count} files",
                )
    with mounted(place, f"size={AMPLE}k"):
        out = place / "out"
        with watched(_after_the_first_checkpoint()):
            bench.run(out)
        mount(place, "remount,ro")
        ended = bench.go_on(out)
        mount(place, "remount,rw")
        judge(bench, table, "a read-only disk, going on", out, ended, os.strerror(errno.EROFS), "remounted")
    return ["A disk cannot become read-only while a run has a file open; it was made so before going on."]


def _after_the_first_checkpoint() -> Hook:
    """Refuses every call after the one that gives the first checkpoint its name."""
    named: list[Path] = []

    def hook(what: str, path: Path) -> None:
        if named:
            raise OSError(errno.ENOSPC, FULL)
        if what == "replace" and path.suffix == ".h5":
            named.append(path)

    return hook


def pictures(scratch: Path, place: Path, table: Table) -> None:
    """Fill the disk while frames, graphs and films are made of a run that is complete."""
    bench = Bench(scratch, frames=True)
    with mounted(place, f"size={AMPLE}k"):
        bench.run(place / "out")
        used = sum(path.stat().st_size for path in (place / "out").rglob("*.png")) // 1024
        whole = int(subprocess.check_output(["du", "-sk", str(place / "out")]).split()[0])
    for part in (0.1, 0.5, 0.9):
        with mounted(place, f"size={whole - int((1.0 - part) * used)}k"):
            out = place / "out"
            ended = bench.run(out)
            if ended[0] == 0:
                continue
            enlarge(place)
            judge(
                bench,
                table,
                f"a full disk, {_stage(ended[1])}",
                out,
                ended,
                FULL,
                f"{part:g} of the frames fit",
            )
    asked = [
        ("graph", "plot", "plot.png", ()),
        ("frames", "render", "frames/speed_0000.png", ("--field", "speed")),
    ]
    if importlib.util.find_spec("imageio_ffmpeg") is not None:
        asked.append(
            ("film", "render", "film.mp4", ("--movie", place / "film.mp4", "--output", scratch / "frames"))
        )
    for name, word, file, options in asked:
        with mounted(place, f"size={AMPLE}k"):
            out = place / "out"
            bench.run(out)
            (out / "plot.png").unlink(missing_ok=True)
            fill(place)
            ended = command(word, out, *options)
            harm = (bench.harm_in(out) or [None])[0]
            if (out / file).exists() or (place / Path(file).name).exists():
                harm = f"{file} is there"
            (place / "filler").unlink()
            code, said = command(word, out, *options)
            late = None if code == 0 else f"with room it ended with {code}: {said.strip()[-200:]}"
            table.setdefault(f"a full disk, {name} of a run that is done", Tally()).add(
                misbehaved(ended, FULL), harm, late
            )


def fill(place: Path) -> None:
    """Leave no byte free."""
    with contextlib.suppress(OSError), open(place / "filler", "wb", buffering=0) as stream:
        while True:
            stream.write(bytes(4096))


@contextlib.contextmanager
def mounted(place: Path, options: str) -> Iterator[None]:
    """Mount an empty file system in memory on a folder for a while."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", str(place)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


def mount(place: Path, options: str) -> None:
    """Change the options of what is mounted."""
    subprocess.run(["mount", "-o", options, str(place)], check=True)


def enlarge(place: Path, more: str = "") -> None:
    """Give room."""
    mount(place, f"remount,size={AMPLE}k{more}")


def _stage(said: str) -> str:
    """The stage at which the disk was full, by the file that a message names."""
    found = re.search(r"(\S+) could not be written", said)
    return stage(Path(found[1])) if found else "unknown"


if __name__ == "__main__":
    main(Path(sys.argv[1]))
