"""SIGINT and SIGTERM: a run ends after the steps it is taking, everything else at once."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType

from warpsph.errors import Ended
from warpsph.messages import stops

SHOW_CURSOR = "\x1b[?25h"
"""What a terminal needs after a live line that was not taken away."""


class Stop:
    """Takes signals that ask for an end.

    Attributes:
        asked: What the last of them asks for; None as long as there was none.
    """

    def __init__(self, final: bool):
        """Take no signal yet; with ``final``, a second one will end the process without another line of Python."""
        self.asked: Ended | None = None
        self._final = final
        self._patient = False

    @contextlib.contextmanager
    def patience(self) -> Iterator[None]:
        """For a while, only note a first signal in `asked`; at other times it raises `Ended` where the program is."""
        self._patient = True
        try:
            yield
        finally:
            self._patient = False

    def take(self, number: int, _frame: FrameType | None = None) -> None:
        """Take a signal: the handler.

        Raises:
            Ended: At once, if nobody has the patience to look at `asked`, or if this is the second one.
        """
        first, self.asked = self.asked is None, stops.asked(signal.Signals(number))
        if first and self._patient:
            return
        if self._final and not first:
            _leave(self.asked)
        raise self.asked


@contextlib.contextmanager
def listening(final: bool = False) -> Iterator[Stop]:
    """Take SIGINT and SIGTERM until the context ends; handlers are then what they were before.

    Within another such context of the same thread its `Stop` is used. Signals that the process was told to ignore stay
    ignored, and outside of the main thread, where Python takes none, nothing is changed.

    Args:
        final: Whether a second signal ends the process, as a kill does, instead of raising `Ended`.
    """
    if threading.current_thread() is not threading.main_thread():
        yield Stop(final)
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for handler in before.values():
        if isinstance(present := getattr(handler, "__self__", None), Stop):
            yield present
            return
    stop = Stop(final)
    taken = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
    try:
        for number in taken:
            signal.signal(number, stop.take)
        yield stop
    finally:
        for number, handler in taken.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _leave(ended: Ended) -> None:
    """End the process: nothing is waited for, and nothing but a line is written."""
    cursor = SHOW_CURSOR if sys.stderr.isatty() else ""
    os.write(2, f"{cursor}warpsph: {ended} again: not waiting for anything\n".encode())
    os._exit(ended.code)
