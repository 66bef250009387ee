"""Wall time: reading a limit as batch systems write it, and stopping early enough to keep it."""

import math
import os
import re
import time
from collections import deque
from pathlib import Path

from warpsph.messages import values
from warpsph.storage.writer import PENDING

RECENT = 16
"""Durations that the margin looks back at."""

RESERVE = 1.0
"""Wall time for the summary and for leaving [s]."""

SAFETY = 1.5
"""How much longer than before everything may take."""

_FORMS = (
    r"(?P<s>\d+(\.\d*)?)",
    r"(?P<m>\d+):(?P<s>[0-5]?\d)",
    r"(?P<h>\d+):(?P<m>[0-5]?\d):(?P<s>[0-5]?\d)",
    r"(?P<d>\d+)-(?P<h>[01]?\d|2[0-3])(:(?P<m>[0-5]?\d)(:(?P<s>[0-5]?\d))?)?",
)
"""Seconds; minutes and seconds; with hours; days, then hours, and perhaps minutes and seconds."""

_SECONDS = {"d": 86400.0, "h": 3600.0, "m": 60.0, "s": 1.0}


def parse(text: str) -> float:
    """Read a duration: ``3600`` [s], ``45:00``, ``2:30:00`` or ``1-12:00:00``.

    Raises:
        InputError: If it is none, or zero.
    """
    for form in _FORMS:
        if match := re.fullmatch(form, text.strip(), re.ASCII):
            total = sum(_SECONDS[unit] * float(count) for unit, count in match.groupdict().items() if count)
            if total > 0.0:
                return total
    raise values.refuse(
        "--walltime", text, "seconds (3600), or 45:00, 2:30:00, 1-12:00:00 (days-hours:minutes:seconds)"
    )


def age() -> float:
    """Wall time since this process was started [s]; since now where the system does not tell."""
    try:
        ticks = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
        found = time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK")
    except (AttributeError, IndexError, OSError, ValueError):
        return 0.0
    return max(found, 0.0)


class Deadline:
    """The end of a run's wall time, and when to stop for the last output to be on the disk before it."""

    def __init__(self, walltime: float | None):
        """Count from now.

        Args:
            walltime: Wall time that is left [s]; None for no limit.

        Raises:
            InputError: If it is negative or no number.
        """
        if walltime is not None and not walltime >= 0.0:
            raise values.refuse("walltime", walltime, "0 or more [s], or None")
        self._end = math.inf if walltime is None else time.monotonic() + walltime
        self._batches: deque[float] = deque([0.0], RECENT)
        self._outputs: deque[float] = deque([0.0], RECENT)

    def batch(self, seconds: float) -> None:
        """Note how long a piece of work took that cannot be cut short [s]."""
        self._batches.append(seconds)

    def output(self, seconds: float) -> None:
        """Note how long an output took, copy and writing [s]; from any thread."""
        self._outputs.append(seconds)

    def is_near(self) -> bool:
        """Whether to stop now.

        There has to be time for one more piece of work, for the outputs that wait and the last one, and for a summary,
        which rebuilds the neighbour rows and so counts as another piece of work.
        """
        needed = 2.0 * max(self._batches) + (PENDING + 1) * max(self._outputs)
        return time.monotonic() + RESERVE + SAFETY * needed > self._end
