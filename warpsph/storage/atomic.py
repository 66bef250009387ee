"""Files that are either the old one or the whole new one, whatever happens while they are written."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from warpsph.errors import RunError


def write(path: Path, content: bytes | memoryview) -> None:
    """Replace a file, as `replacing` does.

    Raises:
        RunError: As `replacing`.
    """
    with replacing(path) as stream:
        stream.write(content)


@contextlib.contextmanager
def replacing(path: Path, keep: Path | None = None) -> Iterator[BinaryIO]:
    """Open a hidden neighbour of a file to write to and read from; at the end it takes the file's name.

    Args:
        path: The file.
        keep: Name that the old file, if there is one, takes just before; None: it goes.

    Raises:
        RunError: If it cannot be written (full disk, no permission); the old file is untouched.
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("w+b") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        if keep is not None and path.exists():
            os.replace(path, keep)
        os.replace(part, path)
    except OSError as error:
        raise RunError(f"{path} could not be written: {error.strerror or error}") from error
    finally:
        _remove(part)


def _remove(part: Path) -> None:
    """Remove what a failure left behind; a second failure must not hide the first."""
    try:
        part.unlink(missing_ok=True)
    except OSError:
        pass
