"""HDF5 files of this program: written at once, and refused with one clear line if they are not ours."""

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from warpsph import __version__
from warpsph.errors import InputError

from . import atomic

if TYPE_CHECKING:
    import h5py


@contextlib.contextmanager
def writing(path: Path, form: str, version: int) -> Iterator["h5py.File"]:
    """Open an HDF5 file in memory and put it in place of ``path`` at the end.

    HDF5 cannot be trusted with a full disk (a failed close aborts the process later), so the file is
    made in memory and written in one piece.

    Args:
        path: File to replace.
        form: What the file is, for example ``"warpsph snapshot"``.
        version: Version of that format.

    Raises:
        RunError: If it cannot be written.
    """
    import h5py

    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        file.attrs.update({"format": form, "format_version": version, "generator": f"warpsph {__version__}"})
        yield file
    atomic.write(path, memory.getbuffer())


@contextlib.contextmanager
def reading(path: Path, form: str, version: int) -> Iterator["h5py.File"]:
    """Open a file that `writing` made; what goes wrong in the body while reading is the file's fault.

    Raises:
        InputError: If the file is missing, foreign, damaged, or of another format version.
    """
    import h5py

    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path} does not exist or is no file; give a {form}")
    try:
        with h5py.File(path, "r") as file:
            _check(path, file, form, version)
            yield file
    except InputError:
        raise
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise InputError(f"{path} is damaged or no {form} ({_reason(error)})") from error


def _check(path: Path, file: "h5py.File", form: str, version: int) -> None:
    """Compare format and version with what is asked for."""
    if file.attrs.get("format") != form:
        raise InputError(f"{path} is no {form}: its format is {file.attrs.get('format', 'foreign')!r}")
    found = int(file.attrs["format_version"])
    if found != version:
        raise InputError(f"{path} has format version {found}; this warpsph reads version {version}")


def _reason(error: Exception) -> str:
    """First line of an error message, without quotes or a full stop."""
    lines = str(error).strip("'\" .").splitlines()
    return lines[0] if lines else type(error).__name__
