"""The folder a run writes into: may it be used, and making it ready."""

import os
import shutil
from pathlib import Path

from warpsph.messages import output, restarts

from . import atomic, lock

NEWEST, PREVIOUS, DAMAGED = "checkpoint.h5", "checkpoint_previous.h5", "checkpoint_damaged.h5"
"""The last checkpoint of a run, the one before, and one that was found damaged when the run went on."""

OURS = (
    *("scene.py", NEWEST, PREVIOUS, DAMAGED),
    *("summary.json", "history.csv", "plot.png", "snapshots", "frames"),
)
"""What a run writes, and so what ``force`` clears, in this order: without its scene nobody takes what is left for a run.

The lock is the business of `warpsph.storage.lock`."""


def check(out: Path, force: bool) -> None:
    """Check that results can go into a folder, without touching it.

    Raises:
        InputError: It is a file, holds something besides a lock (unless ``force``), is in use, or cannot be written.
    """
    try:
        parent = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    except OSError as error:  # a name that no file system takes
        raise output.no_folder(out, error) from error
    if not parent.is_dir():
        raise output.in_the_way(out, parent)
    if not os.access(parent, os.W_OK | os.X_OK):
        raise output.no_permission(out, parent)
    if parent == out and not force and any(path.name != lock.NAME for path in out.iterdir()):
        if holder := lock.holder(out):
            raise output.in_use(out, holder)
        raise output.not_empty(out)


def free(out: Path) -> int | None:
    """Bytes that are free for a run in a folder, which need not be there yet, once an earlier run's files are cleared.

    None if the file system does not say.
    """
    try:
        disk = shutil.disk_usage(next(place for place in (out, *out.absolute().parents) if place.exists()))
        ours = (out / name for name in OURS)
        earlier = [path for top in ours for path in ([top] if top.is_file() else top.rglob("*"))]
        return disk.free + sum(path.stat().st_size for path in earlier) if disk.total else None
    except OSError:
        return None


def prepare(out: Path, force: bool) -> None:
    """Make the folder, and clear an earlier run's files from it; the caller holds its lock.

    Raises:
        InputError: It cannot be used, see `check`.
        DiskError: The disk does not take it.
    """
    check(out, force)
    try:
        out.mkdir(parents=True, exist_ok=True)
        tidy(out)
        for name in OURS:
            if (out / name).is_dir():
                shutil.rmtree(out / name)
            else:
                (out / name).unlink(missing_ok=True)
        (out / "snapshots").mkdir()
    except OSError as error:
        raise output.no_folder(out, error) from error


def tidy(out: Path) -> None:
    """Remove what a killed run was about to write: files that had no name yet.

    Raises:
        DiskError: If that is not possible.
    """
    for folder in (out, out / "snapshots", out / "frames"):
        for part in folder.glob(".*.part"):
            atomic.remove(part)


def check_run(out: Path) -> None:
    """Check that a folder holds a run that can go on.

    Raises:
        InputError: It holds no checkpoint or no scene; a run that has just begun in it is named.
    """
    missing = [] if checkpoints(out) else [NEWEST]
    missing += [] if (out / "scene.py").is_file() else ["scene.py"]
    if missing:
        holder = lock.holder(out)
        raise output.in_use(out, holder) if holder else restarts.no_checkpoint(out, missing[0])


def checkpoints(out: Path) -> list[Path]:
    """The checkpoints of a run that there are, the newest first."""
    return [out / name for name in (NEWEST, PREVIOUS) if (out / name).is_file()]
