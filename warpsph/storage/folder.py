"""The folder a run writes into: may it be used, and making it ready."""

import os
import shutil
from pathlib import Path

from warpsph.errors import InputError
from warpsph.messages import files

OURS = ("summary.json", "history.csv", "checkpoint.h5", "scene.py", "plot.png", "snapshots", "frames")
"""What a run writes, and so what ``force`` clears."""


FOREIGN = (PermissionError, FileExistsError, FileNotFoundError, NotADirectoryError, IsADirectoryError)
"""Failures at the start that another folder on the command line would put right."""


def check(out: Path, force: bool) -> None:
    """Check that results can go into a folder, without touching it.

    Raises:
        InputError: It is a file, holds something (unless ``force``), or cannot be written.
    """
    parent = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    if not parent.is_dir():
        raise InputError(f"output folder {out} cannot be made: {parent} is a file")
    if not os.access(parent, os.W_OK | os.X_OK):
        raise InputError(f"output folder {out} cannot be written: no permission in {parent}")
    if parent == out and not force and any(out.iterdir()):
        raise InputError(
            f"output folder {out} is not empty; use --force, another --out, or `warpsph resume {out}`"
        )


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
    """Make the folder, and clear an earlier run's files from it.

    Raises:
        InputError: It cannot be used, see `check`.
        DiskError: The disk does not take it.
    """
    check(out, force)
    try:
        out.mkdir(parents=True, exist_ok=True)
        for name in OURS:
            if (out / name).is_dir():
                shutil.rmtree(out / name)
            else:
                (out / name).unlink(missing_ok=True)
        (out / "snapshots").mkdir()
    except FOREIGN as error:
        raise InputError(f"output folder {out} cannot be written: {error.strerror}") from error
    except OSError as error:
        raise files.unwritten(out, error) from error
