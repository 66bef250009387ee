"""Checkpoints: arrays and facts that a run goes on from, bit for bit."""

import json
from pathlib import Path

import numpy as np

from . import hdf5

FORM, VERSION = "warpsph checkpoint", 3
"""Name and version of the format; the version rises when old readers would fail."""


def save(path: Path, arrays: dict[str, np.ndarray], info: dict) -> None:
    """Write a checkpoint in place of an older one.

    Args:
        path: File to replace.
        arrays: Numeric arrays of any type and shape; kept in the order they have.
        info: Anything JSON can hold; floats come back exactly.

    Raises:
        RunError: If it cannot be written; an older file of that name stays whole.
    """
    with hdf5.writing(path, FORM, VERSION, info) as file:
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
