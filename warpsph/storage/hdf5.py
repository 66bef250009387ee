"""HDF5 files of this program: written at once and sealed, and refused with one clear line if they are not as they were.

HDF5 writes them; it reads none. Its library trusts what a file says about its own structure, so that a damaged or hostile
one can crash it, hang it, or fill the memory.
"""

import contextlib
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from warpsph import __version__
from warpsph.errors import InputError
from warpsph.messages import files

from . import atomic, seal

if TYPE_CHECKING:
    import h5py

KINDS = tuple(np.dtype(kind).str for kind in ("f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"))
"""Types of the numbers that arrays may have."""

MOST_AXES = 4
"""Most axes of an array."""


@contextlib.contextmanager
def writing(
    path: Path, form: str, version: int, facts: dict[str, Any], keep: Path | None = None
) -> Iterator["h5py.File"]:
    """Open an HDF5 file to write to, which is sealed and put in place of ``path`` at the end.

    Args:
        path: File to replace.
        form: What the file is, for example ``"warpsph snapshot"``.
        version: Version of that format.
        facts: What `reading` gives back besides the arrays: anything JSON can hold; floats come back exactly.
        keep: Name that the old file takes; None: it goes.

    Raises:
        DiskError: If it cannot be written.
        ValueError: If an array is not stored in one piece, or of a type that `reading` does not know.
    """
    import h5py

    with atomic.replacing(path, keep) as stream:
        disk = _Disk(stream)
        head = {"format": form, "format_version": version, "generator": f"warpsph {__version__}"}
        try:
            with h5py.File(disk, "w") as file:
                file.attrs.update(head)
                yield file
                arrays = _places(file)
        finally:
            if disk.error is not None:  # also where HDF5 stumbled over it
                raise disk.error
        seal.put(stream, head | {"facts": facts, "arrays": arrays})


@contextlib.contextmanager
def reading(path: Path, form: str, version: int, *, whole: bool = True) -> Iterator["Contents"]:
    """Open a file that `writing` made; what goes wrong in the body while reading is the file's fault.

    Nothing is parsed by HDF5: the seal says where the arrays are, and it is compared with the file before.

    Args:
        path: The file.
        form: What it should be.
        version: Version of that format.
        whole: Whether the arrays are to be compared with their checksum, a second for every two gigabytes or so; else
            only the facts can be relied on, and are there at once.

    Raises:
        InputError: If the file is missing, foreign, damaged, or of another format version.
    """
    path = Path(path)
    if not path.is_file():
        raise files.absent(path, form)
    try:
        with path.open("rb") as stream:
            index = seal.index(stream)
            _check(path, index, form, version)
            if whole:
                seal.verify(stream, index)
            yield Contents(stream, index)
    except InputError:
        raise
    except (OSError, LookupError, ValueError, TypeError, RuntimeError, MemoryError) as error:
        raise files.damaged(path, form, error) from error


class Contents:
    """What a file holds.

    Attributes:
        facts: What `writing` was given.
        names: Names of the arrays, in the order of the file.
    """

    def __init__(self, stream: BinaryIO, index: dict[str, Any]):
        """Check where the arrays are.

        Raises:
            ValueError: If they cannot all lie in the file.
        """
        self._stream, self._arrays = stream, {}
        self.facts = index["facts"]
        if not isinstance(self.facts, dict) or not isinstance(index["arrays"], dict):
            raise ValueError("its index has a wrong form")
        room = size = index["size"]
        for name, (kind, shape, start) in index["arrays"].items():
            whole = [type(number) is int and number >= 0 for number in (start, *shape)]
            if kind not in KINDS or len(shape) > MOST_AXES or not all(whole):
                raise ValueError(f"array {name!r} is of no kind that is allowed")
            length = math.prod(shape) * np.dtype(kind).itemsize
            room -= length  # no byte twice: what is read fits where the file does
            if start + length > size or room < 0:
                raise ValueError(f"array {name!r} of shape {shape} does not fit into the file")
            self._arrays[name] = kind, shape, start
        self.names = list(self._arrays)

    def array(self, name: str) -> np.ndarray:
        """Read an array.

        Raises:
            ValueError: If there is none of that name, or its end is missing.
        """
        if name not in self._arrays:
            raise ValueError(f"array {name!r} is missing")
        kind, shape, start = self._arrays[name]
        values = np.empty(shape, dtype=kind)
        self._stream.seek(start)
        if values.size and self._stream.readinto(memoryview(values.reshape(-1)).cast("B")) != values.nbytes:
            raise ValueError(f"array {name!r} is cut short")
        return values


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


def _check(path: Path, index: dict[str, Any], form: str, version: int) -> None:
    """Compare format and version with what is asked for."""
    if index.get("format") != form:
        raise files.foreign(path, form, index.get("format"))
    if index.get("format_version") != version:
        raise files.other_version(path, version, index.get("format_version"))


def _places(group: "h5py.Group") -> dict[str, tuple[str, tuple[int, ...], int]]:
    """Type, shape and first byte of every numeric array, by its path in the group."""
    import h5py

    places = {}
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            places |= {f"{name}/{inner}": place for inner, place in _places(item).items()}
        elif h5py.check_string_dtype(item.dtype) is None:  # texts are for other programs
            if item.dtype.str not in KINDS:
                raise ValueError(f"array {name!r} has the type {item.dtype}, which is not read back")
            start = item.id.get_offset() if item.size else 0
            if start is None:
                raise ValueError(f"array {name!r} is not stored in one piece")
            places[name] = item.dtype.str, item.shape, start
    return places
