"""What a user sees while a run goes on: a live line in a terminal, now and then a plain line in a log."""

import contextlib
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from types import ModuleType
from typing import TextIO

from .running.streams import Dropping
from .units import si

LOG_SHARE = 0.1
"""A log gets a line whenever this share of the run is done ..."""

LOG_SECONDS = 10.0
"""... and when this long passed since the last one [s], or a tenth of the wall time so far if that is longer."""


def clock(seconds: float) -> str:
    """Write a duration as h:mm:ss."""
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"


class Progress:
    """Reports a run to a stream, live if the stream is a terminal."""

    def __init__(self, stream: TextIO | None = None):
        """Report to ``stream``, by default stderr; what it does not take is dropped."""
        from rich.console import Console

        stream = Dropping(stream or sys.stderr)
        self._console = Console(file=stream)
        self._live = stream.isatty() and not self._console.is_dumb_terminal
        self._bar = None
        self._share = 0.0

    def start(self, total_time: float, start_time: float = 0.0) -> None:
        """Begin: the run goes from ``start_time`` to ``total_time`` [s]."""
        self._total, self._begin = total_time, start_time
        self._share = 0.0
        self._wall_start = self._wall_logged = _now()
        if self._live and self._bar is None:
            self._bar = _make_bar(self._console)
            self._task = self._bar.add_task("", total=1.0, text="")
            self._bar.start()

    def update(self, *, time: float, step: int, dt: float, energy_error: float, rate: float) -> None:
        """Report a state of the run.

        Args:
            time: Simulated time [s].
            step: Steps taken.
            dt: Last time step [s].
            energy_error: E/E0 - 1.
            rate: Particle-steps per wall second [1/s].
        """
        length = self._total - self._begin
        share = min(max((time - self._begin) / length, 0.0), 1.0) if length > 0.0 else 1.0
        facts = [f"{si(time, 's')} of {si(self._total, 's')}", f"{self._left(share)} left", f"step {step}"]
        facts += [
            f"dt {si(dt, 's')}",
            f"energy error {energy_error:.0e}",
            f"{rate / 1e6:.3g} M particle-steps/s",
        ]
        if self._bar is not None:
            self._bar.update(self._task, completed=share, text="  ".join(facts))
        elif self._is_due(share):
            self._share, self._wall_logged = share, _now()
            self.message(f"{100 * share:3.0f} %  " + "  ".join(facts))

    def message(self, text: str) -> None:
        """Print one line, above the live line if there is one."""
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)

    def stop(self) -> None:
        """End the live line; harmless if there is none."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _left(self, share: float) -> str:
        """Wall time left if the run goes on as it did."""
        return clock((_now() - self._wall_start) * (1.0 - share) / share) if share > 0.0 else "?"

    def _is_due(self, share: float) -> bool:
        """Whether a log should get a line: few of them, however short or long the run."""
        waited = _now() - self._wall_logged
        if share >= 1.0:
            return self._share < 1.0
        if share - self._share >= LOG_SHARE - 1e-9:
            return waited >= LOG_SHARE * LOG_SECONDS
        return waited >= max(LOG_SECONDS, LOG_SHARE * (_now() - self._wall_start))


class WarpLog:
    """Warp's messages, quiet but for warnings, errors and one line when kernels have to be compiled."""

    def __init__(self, progress: Progress, inner):
        """Report a compilation to ``progress``; hand warnings and errors to the logger ``inner``."""
        self._progress, self._inner = progress, inner
        self._told = False
        self._lock = threading.Lock()  # modules are compiled side by side

    def debug(self, message: str) -> None:
        """Say nothing."""

    def info(self, message: str) -> None:
        """Tell of the first module that was compiled; Warp reports each one when it is done."""
        if not message.rstrip().endswith("(compiled)"):
            return
        with self._lock:
            told, self._told = self._told, True
        if not told:
            self._progress.message("compiling kernels (first run only) ...")

    def warning(self, message: str, category: type | None = None, stacklevel: int = 1) -> None:
        """Pass a warning on."""
        self._inner.warning(message, category, stacklevel + 1)

    def error(self, message: str) -> None:
        """Pass an error on."""
        self._inner.error(message)


@contextlib.contextmanager
def quiet_warp(progress: Progress) -> Iterator[str]:
    """Start Warp, with its messages turned down until the context ends.

    Yields:
        What its native part wrote to stderr, such as that there is no CUDA driver; not shown to the user.
    """
    import warp as wp

    usual = wp.get_logger()
    wp.set_logger(WarpLog(progress, usual))
    try:
        yield _start(wp)
    finally:
        wp.set_logger(usual)


def _start(wp: ModuleType) -> str:
    """Initialise Warp and give what its native part, which knows no logger, writes to stderr."""
    try:
        room = tempfile.TemporaryFile()
    except OSError:  # no disk has room for it: what it writes is shown
        wp.init()
        return ""
    with room as said:
        stderr = os.dup(2)
        os.dup2(said.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
        said.seek(0)
        return " ".join(said.read().decode(errors="replace").split())


def _now() -> float:
    """Wall clock [s]; apart from the `time` that `Progress.update` is given."""
    return time.monotonic()


def _make_bar(console):
    """Build the live line: a bar, which makes way in a narrow terminal, the share and the facts of the run."""
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    text = TextColumn("{task.percentage:3.0f} %  {task.fields[text]}", markup=False)
    return Bar(BarColumn(bar_width=10), text, console=console)
