"""Files that are either the old one or the whole new one, whatever happens while they are written."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from warpsph.messages import output


def write(path: Path, content: bytes | memoryview) -> None:
    """Replace a file, as `replacing` does.

    Raises:
        DiskError: As `replacing`.
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
        DiskError: If it cannot be written (full disk, no permission); the old file is untouched, and what was written of
            the new one is removed.
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    try:
        with naming(path):
            part.unlink(missing_ok=True)  # whatever has the name: a pipe would wait for a reader
            with open(part, "x+b") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            if keep is not None and path.exists():
                os.replace(path, keep)
            os.replace(part, path)
    finally:
        discard(part)


def remove(path: Path) -> None:
    """Remove a file, if it is there.

    Raises:
        DiskError: If that is not possible.
    """
    with naming(path):
        path.unlink(missing_ok=True)


def make_folder(path: Path) -> Path:
    """Make a folder and those above it, if they are not there.

    Raises:
        DiskError: If that is not possible.
    """
    with naming(path):
        path.mkdir(parents=True, exist_ok=True)
    return path


def discard(part: Path) -> None:
    """Remove what a failure left behind; a second failure must not hide the first."""
    with contextlib.suppress(OSError):
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Let a failure of the file system name the file that it is about.

    Raises:
        DiskError: In place of an OSError of the body.
    """
    try:
        yield
    except OSError as error:
        raise output.unwritten(path, error) from error
