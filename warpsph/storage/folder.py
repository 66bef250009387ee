"""The folder a run writes into: may it be used, and making it ready."""

import os
import shutil
from pathlib import Path

from warpsph.errors import InputError
from warpsph.messages import files

from . import lock

OURS = ("scene.py", "checkpoint.h5", "summary.json", "history.csv", "plot.png", "snapshots", "frames")
"""What a run writes, and so what ``force`` clears, in this order: without its scene nobody takes what is left for a run.

The lock is the business of `warpsph.storage.lock`."""


def check(out: Path, force: bool) -> None:
    """Check that results can go into a folder, without touching it.

    Raises:
        InputError: It is a file, holds something besides a lock (unless ``force``), is in use, or cannot be written.
    """
    parent = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    if not parent.is_dir():
        raise InputError(f"output folder {out} cannot be made: {parent} is a file")
    if not os.access(parent, os.W_OK | os.X_OK):
        raise InputError(f"output folder {out} cannot be written: no permission in {parent}")
    if parent == out and not force and any(path.name != lock.NAME for path in out.iterdir()):
        if holder := lock.holder(out):
            raise files.in_use(out, holder)
        raise InputError(
            f"output folder {out} is not empty; use --force, another --out, or `warpsph resume {out}`"
        )


def check_run(out: Path) -> None:
    """Check that a folder holds a run that can go on.

    Raises:
        InputError: It holds no checkpoint or no scene; a run that has just begun in it is named.
    """
    for name in ("checkpoint.h5", "scene.py"):
        if not (out / name).is_file():
            holder = lock.holder(out)
            raise files.in_use(out, holder) if holder else files.no_checkpoint(out, name)


def prepare(out: Path, force: bool) -> None:
    """Make the folder, and clear an earlier run's files from it; the caller holds its lock.

    Raises:
        InputError: It cannot be used, see `check`.
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
        raise files.no_folder(out, error.strerror) from error


def tidy(out: Path) -> None:
    """Remove what a killed run was about to write: files that had no name yet."""
    for folder in (out, out / "snapshots", out / "frames"):
        for part in folder.glob(".*.part"):
            part.unlink(missing_ok=True)
