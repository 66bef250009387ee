"""The folder a run writes into: may it be used, and making it ready."""

import os
import shutil
from pathlib import Path

from warpsph.errors import InputError

NEWEST, PREVIOUS, DAMAGED = "checkpoint.h5", "checkpoint_previous.h5", "checkpoint_damaged.h5"
"""The last checkpoint of a run, the one before, and one that was found damaged when the run went on."""

OURS = (
    *("summary.json", "history.csv", NEWEST, PREVIOUS, DAMAGED),
    *("scene.py", "plot.png", "snapshots", "frames"),
)
"""What a run writes, and so what ``force`` clears."""


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


def prepare(out: Path, force: bool) -> None:
    """Make the folder, and clear an earlier run's files from it.

    Raises:
        InputError: It cannot be used, see `check`.
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
    except OSError as error:
        raise InputError(f"output folder {out} cannot be written: {error.strerror}") from error


def checkpoints(out: Path) -> list[Path]:
    """The checkpoints of a run that there are, the newest first."""
    return [out / name for name in (NEWEST, PREVIOUS) if (out / name).is_file()]
