"""The lock of an output folder: one run at a time, and none that is over keeps others out."""

import contextlib
import fcntl
import json
import os
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import TextIO

from warpsph.messages import output

from . import text

NAME = "run.lock"
"""The file: JSON of ``host``, ``pid`` and ``since`` of the process that writes into the folder."""

LONGEST = 2**12
"""Longest file that is read [bytes]."""

MOMENT = 1.0
"""Longest time between locking the file and writing into it [s], for a message that names the holder."""


@contextlib.contextmanager
def held(folder: Path, tell: Callable[[str], None]) -> Iterator[None]:
    """Keep other runs out of a folder, which is made if need be, until the context ends.

    The lock is one of the system's (flock), which ends with the process that holds it, however it ends; the file says
    who that is. Where the file system has no such locks, the file itself is the lock, and whether its holder is alive
    can be known on one host only.

    Args:
        folder: The folder.
        tell: Takes the line that says that a stale lock was taken over.

    Raises:
        InputError: If another process holds the lock, or the folder cannot be made or written.
        DiskError: If the disk takes no more.
    """
    path = Path(folder) / NAME
    made: list[Path] = []
    try:
        _make(path.parent, made)
        file = _take(path, tell) if _has_locks(path.parent) else _take_by_name(path, tell)
    except OSError as error:
        raise output.no_folder(folder, error) from error
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()  # while it is locked: who waits for this file finds that it is no longer the folder's
        file.close()
        for each in reversed(made):  # nothing was written: leave nothing
            with contextlib.suppress(OSError):
                each.rmdir()


def holder(folder: Path) -> dict | None:
    """Who says to be writing into a folder: entries of the lock file, None if there is none or its process is over.

    For messages only: `held` decides.
    """
    path = Path(folder) / NAME
    found = _read(path)
    return found if path.exists() and _may_live(found) else None


def _take(path: Path, tell: Callable[[str], None]) -> TextIO:
    """Open and lock the file; until it is locked, one who leaves may remove it."""
    while True:
        file = path.open("a+", encoding="utf-8")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            raise output.in_use(path.parent, _signature(path)) from None
        if _is_in_place(file, path):
            break
        file.close()
    if left := _read(path):
        tell(output.stale_lock(path.parent, left))
    file.truncate(0)
    _sign(file)
    return file


def _take_by_name(path: Path, tell: Callable[[str], None]) -> TextIO:
    """Make the file, which must not be there, unless its process was on this host and is over."""
    for last in (False, True):
        try:
            file = path.open("x+", encoding="utf-8")
        except FileExistsError:
            found = _read(path)
            if last or _may_live(found):
                raise output.in_use(path.parent, found, path) from None
            tell(output.stale_lock(path.parent, found))
            path.unlink(missing_ok=True)
        else:
            _sign(file)
            return file
    raise AssertionError("the second attempt returns or raises")


def _make(folder: Path, made: list[Path]) -> None:
    """Make a folder and those above it, and note which were not there, the innermost last."""
    made += reversed([each for each in (folder, *folder.parents) if not each.exists()])
    folder.mkdir(parents=True, exist_ok=True)


def _has_locks(folder: Path) -> bool:
    """Whether the file system knows locks, tried on a file without a name."""
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True


def _sign(file: TextIO) -> None:
    """Write into the file who holds it."""
    since = datetime.now().astimezone().isoformat(" ", "seconds")
    json.dump({"host": socket.gethostname(), "pid": os.getpid(), "since": since}, file)
    file.flush()


def _signature(path: Path) -> dict:
    """Who has locked a file, which that process is perhaps about to write; empty if it never does."""
    deadline = time.monotonic() + MOMENT
    while not (found := _read(path)) or not _may_live(found):
        if time.monotonic() > deadline:
            return {}
        time.sleep(0.01)
    return found


def _is_in_place(file: TextIO, path: Path) -> bool:
    """Whether an open file is still the one of that name."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _read(path: Path) -> dict:
    """Who a lock file names; empty if it cannot be told, as while it is being written."""
    try:
        found = json.loads(text.read(path, "lock", LONGEST))
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _may_live(holder: dict) -> bool:
    """Whether a process may still be there: only on its own host can be known that it is not."""
    if holder.get("host") != socket.gethostname() or not isinstance(holder.get("pid"), int):
        return True
    try:
        os.kill(holder["pid"], 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
