"""Files that are either the old one or the whole new one, whatever happens while they are written."""

import os
from pathlib import Path

from warpsph.errors import RunError


def write(path: Path, content: bytes | memoryview) -> None:
    """Replace a file: the content goes to a hidden neighbour first, which then takes the file's name.

    Raises:
        RunError: If the content cannot be written (full disk, no permission); the old file is untouched.
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
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
