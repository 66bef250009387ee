"""Writing while the run goes on: one thread, in order, a bounded number of outputs, no error lost."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Self

PENDING = 2
"""Outputs that may be in memory at a time: one being written, one waiting."""


class Writer:
    """A thread that writes what it is given, in that order. Use it as a context manager, or `close` it.

    The first error ends the writing: later outputs are dropped, and the error is raised by the next call, whatever
    its type. Numpy, HDF5 and the system let go of the interpreter while they work on large arrays, so the caller's
    steps go on meanwhile.
    """

    def __init__(self):
        """Start with nothing to write; the thread starts with the first output."""
        self._thread = ThreadPoolExecutor(1, "writer")
        self._room = threading.Semaphore(PENDING)
        self._error: BaseException | None = None

    def submit(self, take: Callable[[], Callable[[], None]]) -> None:
        """Queue an output; waits while `PENDING` outputs are in memory.

        Args:
            take: Called here and now, once there is room: it copies what is to be written, and gives the function
                that writes the copy, which the thread calls.

        Raises:
            BaseException: What an earlier output, or ``take``, has failed with.
        """
        self._room.acquire()
        try:
            self.check()
            self._thread.submit(self._write, take())
        except BaseException:
            self._room.release()
            raise

    def check(self) -> None:
        """Go on if all is well.

        Raises:
            BaseException: What an output has failed with.
        """
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Wait until everything is written.

        Raises:
            BaseException: What an output has failed with.
        """
        self._thread.shutdown()
        self.check()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_) -> None:
        """Wait until everything is written; an exception on its way is not replaced by one of the writing."""
        self._thread.shutdown()
        if kind is None:
            self.check()

    def _write(self, job: Callable[[], None]) -> None:
        try:
            if self._error is None:
                job()
        except BaseException as error:  # whatever it is, the caller has to hear of it
            self._error = error
        finally:
            self._room.release()
