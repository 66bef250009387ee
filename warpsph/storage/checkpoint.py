"""Checkpoints: arrays and facts that a run goes on from, bit for bit; a run keeps its last two."""

import hashlib
import json
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from warpsph.errors import InputError
from warpsph.messages import remarks, restarts

from . import atomic, hdf5
from .facts import check, finite, natural
from .folder import DAMAGED, NEWEST, PREVIOUS, checkpoints

FORM, VERSION = "warpsph checkpoint", 3
"""Name and version of the format; the version rises when old readers would fail."""

HEADER = (
    "version", "warp", "scene", "scene_sha256", "parameters", "dim", "particles", "scheme", "precision", "device",
    "device_name", "time", "step", "until",
)  # fmt: skip
"""Facts that are attributes of the file too, where any HDF5 tool shows them."""


class Found(NamedTuple):
    """A checkpoint that was read.

    Attributes:
        arrays: As they were saved.
        info: The facts, as they were saved.
        path: Where it lies.
        causes: Why newer ones cannot be read.
    """

    arrays: dict[str, np.ndarray]
    info: dict
    path: Path
    causes: list[str]

    @property
    def remarks(self) -> list[str]:
        """What the user is to be told: that a newer one is damaged, and how."""
        return [remarks.older_checkpoint(cause, self.path, self.info["time"]) for cause in self.causes]


def save(path: Path, arrays: dict[str, np.ndarray], info: dict, keep: Path | None = None) -> None:
    """Write a checkpoint in place of an older one.

    Args:
        path: File to replace.
        arrays: Numeric arrays of any type and shape; kept in the order they have.
        info: Anything JSON can hold; floats come back exactly.
        keep: Name that the older one takes, see `save_newest`; None: it goes.

    Raises:
        DiskError: If it cannot be written; an older file of that name stays whole.
    """
    with hdf5.writing(path, FORM, VERSION, info, keep) as file:
        file.attrs.update({name: _plain(info[name]) for name in HEADER if info.get(name) is not None})
        file["info"] = json.dumps(info)  # for other programs
        group = file.create_group("arrays", track_order=True)
        for name, array in arrays.items():
            group.create_dataset(name, data=np.asarray(array))


def load(path: Path) -> tuple[dict[str, np.ndarray], dict]:
    """Read a checkpoint.

    Returns:
        The arrays and the facts, as they were saved.

    Raises:
        InputError: If the file is missing, no checkpoint, of another format version, or damaged.
    """
    with hdf5.reading(path, FORM, VERSION) as file:
        return {name.removeprefix("arrays/"): file.array(name) for name in file.names}, file.facts


def facts(path: Path) -> dict:
    """Read the facts of a checkpoint, without its arrays.

    Raises:
        InputError: As `load`, but arrays are not looked at.
    """
    with hdf5.reading(path, FORM, VERSION, whole=False) as file:
        check(file.facts, {"time": finite, "step": natural})
        return {"format_version": VERSION} | file.facts


def save_newest(folder: Path, arrays: dict[str, np.ndarray], info: dict) -> None:
    """Write the newest checkpoint of a run; the one there was becomes the previous one.

    The new file is whole on the disk before either is renamed: at any instant one of the two names is a whole checkpoint.

    Raises:
        DiskError: If it cannot be written; the older ones are there.
    """
    save(folder / NEWEST, arrays, info, keep=folder / PREVIOUS)


def load_newest(folder: Path) -> Found:
    """Read the newest checkpoint of a run that is whole.

    Raises:
        InputError: If there is none, or none is whole; names each with its cause.
    """
    causes = []
    for path in checkpoints(folder):
        try:
            arrays, info = load(path)
        except InputError as error:
            causes.append(str(error))
            continue
        return Found(arrays, info, path, causes)
    raise restarts.no_whole_checkpoint(causes) if causes else restarts.no_checkpoint(folder, NEWEST)


def go_on_from(path: Path) -> None:
    """Before a run goes on from a checkpoint: its next one must not push this one out for a damaged one.

    Where this is the previous one, a newest one that is there gets a name of its own.

    Raises:
        DiskError: If it cannot be renamed.
    """
    newest = path.with_name(NEWEST)
    if path.name == PREVIOUS and newest.is_file():
        with atomic.naming(newest):
            os.replace(newest, path.with_name(DAMAGED))


def digest(path: Path) -> str | None:
    """SHA-256 of a file's content, as hexadecimal digits; None if there is no such file."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None


def _plain(value: object) -> object:
    """A fact as an attribute: text, a number, or JSON."""
    return value if isinstance(value, str | int | float) else json.dumps(value)
