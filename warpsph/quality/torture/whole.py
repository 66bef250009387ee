"""Whether a file of a run can be read from end to end."""

import json
from pathlib import Path

import numpy as np

from warpsph.storage import checkpoint, history, snapshot


def check(path: Path) -> None:
    """Read a file that a run has written; those of kinds without a reader count as whole.

    Raises:
        InputError, ValueError, OSError, SyntaxError: If it is not whole.
    """
    if path.suffix == ".vtkhdf":
        snapshot.read(path)
    elif path.suffix == ".h5":
        checkpoint.load(path)
    elif path.suffix == ".csv":
        history.read(path)
    elif path.suffix == ".series":
        named = [entry["name"] for entry in json.loads(path.read_text())["files"]]
        missing = [name for name in named if not path.with_name(name).is_file()]
        if missing:
            raise ValueError(f"names {missing[0]}, which is not there")
    elif path.suffix == ".json":
        json.loads(path.read_text())
    elif path.suffix == ".png":
        picture(path)


def picture(path: Path) -> bytes:
    """The pixels of a picture.

    Raises:
        OSError, SyntaxError: If it is not whole.
    """
    from PIL import Image

    with Image.open(path) as image:
        return np.asarray(image).tobytes()
