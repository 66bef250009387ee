"""Standard streams that may go away: a pipe whose reader has left, a log on a full disk, a terminal that is closed."""

import contextlib
import io
import os
import sys
from typing import TextIO


class Dropping(io.TextIOBase):
    """A stream that never fails: what cannot be written is dropped. For what nobody's results depend on."""

    def __init__(self, stream: TextIO | None):
        """Write to a stream, or to none."""
        self._stream = stream

    @property
    def encoding(self) -> str:
        """That of the stream."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    def write(self, text: str) -> int:
        """Write, or not."""
        with contextlib.suppress(OSError, ValueError, AttributeError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Pass on what is buffered, or not."""
        with contextlib.suppress(OSError, ValueError, AttributeError):
            self._stream.flush()

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        with contextlib.suppress(OSError, ValueError, AttributeError):
            return self._stream.isatty()
        return False

    def fileno(self) -> int:
        """Number of the stream, for its width."""
        if self._stream is None:
            raise io.UnsupportedOperation("fileno")
        return self._stream.fileno()


def fill() -> None:
    """Give numbers 0 to 2 to nothing where they are closed, or the next file that is opened would get what is printed.

    Python has no stream at all there, which libraries do not expect.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)


def empty() -> OSError | None:
    """Write out what the standard streams hold; one that fails is turned to nothing, and the loss of output is given.

    Python would end with an exit code of its own otherwise. A reader that has left has lost nothing.
    """
    lost = None
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except OSError as error:
            if stream is sys.stdout and not isinstance(error, BrokenPipeError):
                lost = error
            _turn_away(stream)
    return lost


def _turn_away(stream: TextIO) -> None:
    """Let a stream write to nothing from now on."""
    with contextlib.suppress(OSError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
