"""HDF5 files of this program: written at once, and refused with one clear line if they are not ours."""

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from warpsph import __version__
from warpsph.errors import InputError

from . import atomic

if TYPE_CHECKING:
    import h5py


@contextlib.contextmanager
def writing(path: Path, form: str, version: int, keep: Path | None = None) -> Iterator["h5py.File"]:
    """Open an HDF5 file to write to, which is put in place of ``path`` at the end.

    Args:
        path: File to replace.
        form: What the file is, for example ``"warpsph snapshot"``.
        version: Version of that format.
        keep: Name that the old file takes; None: it goes.

    Raises:
        DiskError: If it cannot be written.
    """
    import h5py

    with atomic.replacing(path, keep) as stream:
        disk = _Disk(stream)
        try:
            with h5py.File(disk, "w") as file:
                file.attrs.update(
                    {"format": form, "format_version": version, "generator": f"warpsph {__version__}"}
                )
                yield file
        finally:
            if disk.error is not None:  # also where HDF5 stumbled over it
                raise disk.error


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


class _Disk:
    """A file that does not fail, as HDF5 sees it: a failed close would make it abort the process later.

    Attributes:
        error: The first failure, after which nothing more is written.
    """

    def __init__(self, stream: BinaryIO):
        self._stream = stream
        self.error: OSError | None = None

    def read(self, size: int = -1) -> bytes:
        """Read; HDF5 takes nothing for a file that has no such method, and uses `readinto`."""
        return self._attempt(self._stream.read, size, otherwise=b"")

    def readinto(self, buffer: memoryview) -> int:
        """Read into memory."""
        return self._attempt(self._stream.readinto, buffer, otherwise=0)

    def write(self, content: memoryview) -> int:
        """Write, without a copy of large content."""
        return self._attempt(self._stream.write, content, otherwise=len(content))

    def seek(self, *where: int) -> int:
        """Move to a place."""
        return self._attempt(self._stream.seek, *where, otherwise=where[0])

    def tell(self) -> int:
        """Give the place."""
        return self._attempt(self._stream.tell, otherwise=0)

    def truncate(self, size: int) -> int:
        """Set the length."""
        return self._attempt(self._stream.truncate, size, otherwise=size)

    def flush(self) -> None:
        """Pass on what is buffered."""
        self._attempt(self._stream.flush, otherwise=None)

    def _attempt(self, method: Callable, *arguments: Any, otherwise: Any) -> Any:
        """Call a method of the stream, unless one has failed."""
        if self.error is None:
            try:
                return method(*arguments)
            except OSError as error:
                self.error = error
        return otherwise


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
