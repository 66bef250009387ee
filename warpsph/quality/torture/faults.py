"""Failures of the file system, made up inside the process: the k-th call that writes output is refused."""

import contextlib
import io
import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest import mock

from warpsph.storage import atomic, history

Hook = Callable[[str, Path], None]
"""What is called before each call, with its name and the file it is about; it may raise an OSError."""


class Refusal:
    """Refuses one call, or all from it on.

    Attributes:
        seen: Name and file of every call so far.
        fired: The call that was refused first; None if none was.
    """

    def __init__(self, number: int | None, code: int, lasting: bool = False):
        """Refuse the call of a ``number``, counted from 1, with the error ``code``; ``lasting``: and those after it."""
        self.seen: list[tuple[str, Path]] = []
        self.fired: tuple[str, Path] | None = None
        self._number, self._code, self._lasting = number, code, lasting
        self._lock = threading.Lock()  # the run and its writer call

    def __call__(self, what: str, path: Path) -> None:
        """Note a call, and refuse it if its turn has come."""
        with self._lock:
            self.seen.append((what, path))
            turn = len(self.seen)
            due = self._number is not None and (
                turn == self._number or (self._lasting and turn > self._number)
            )
            if due and self.fired is None:
                self.fired = (what, path)
        if due:
            raise OSError(self._code, os.strerror(self._code), str(path))


@contextlib.contextmanager
def watched(hook: Hook) -> Iterator[None]:
    """Call a hook before every call of the system that writes output of a run, its pictures included."""
    make = Path.mkdir

    def mkdir(path: Path, *arguments, **options) -> None:
        hook("mkdir", path)
        make(path, *arguments, **options)

    with contextlib.ExitStack() as patches:
        for module in (atomic, history):
            patches.enter_context(mock.patch.object(module, "os", _System(hook)))
            patches.enter_context(mock.patch.object(module, "open", _opener(hook), create=True))
        patches.enter_context(mock.patch.object(Path, "mkdir", mkdir))
        yield


class _System:
    """The module ``os``, but for the calls that are watched."""

    def __init__(self, hook: Hook):
        self._hook = hook

    def __getattr__(self, name: str):
        return getattr(os, name)

    def fsync(self, number: int) -> None:
        """Write to the disk."""
        self._hook("fsync", Path(os.readlink(f"/proc/self/fd/{number}")))
        os.fsync(number)

    def replace(self, old: Path, new: Path) -> None:
        """Give a file its name."""
        self._hook("replace", Path(new))
        os.replace(old, new)


class _File(io.FileIO):
    """A file whose calls are watched."""

    def __init__(self, path: Path, mode: str, hook: Hook):
        hook("open", Path(path))
        super().__init__(path, mode)
        self._hook, self._path = hook, Path(path)

    def write(self, content) -> int:
        self._hook("write", self._path)
        return super().write(content)

    def truncate(self, size: int | None = None) -> int:
        self._hook("truncate", self._path)
        return super().truncate(size)


def _opener(hook: Hook) -> Callable:
    """A stand-in for ``open`` of binary files."""

    def opened(path: Path, mode: str, buffering: int = -1):
        raw = _File(path, mode.replace("b", ""), hook)
        return raw if buffering == 0 else io.BufferedRandom(raw)

    return opened
