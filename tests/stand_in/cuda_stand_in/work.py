"""What the device has been told to do: queued until somebody waits for it, or recorded into a graph."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from .memory import Memory

KERNEL, BUILTIN, COPY, FILL, GRAPH = 1, 2, 4, 8, 16
"""Kinds of work, as the timing of Warp tells them apart; what is of no kind is not timed."""


@dataclass
class Job:
    """One thing to do: a launch, a copy, a mark of time."""

    do: Callable[[], None]
    name: str = ""
    kind: int = 0


@dataclass(eq=False)
class Event:
    """A mark in the queue.

    Attributes:
        timed: It may be asked for its time.
        when: When the device came to it [s]; None: not yet.
    """

    timed: bool
    when: float | None = None

    def mark(self) -> None:
        """The device has come to it."""
        self.when = time.perf_counter()


@dataclass(eq=False)
class Capture:
    """A graph that is being recorded on a stream, and whether something was done that spoils it."""

    stream: object
    jobs: list[Job] = field(default_factory=list)
    spoilt: bool = False


class Work:
    """The queue of the device. All streams are one: what runs beside each other on a GPU runs in the order of the calls.

    Attributes:
        capture: What is being recorded; None: nothing.
        stream: The current stream; None is the default stream, which waits for all others.
        timings: Name, kind and time [ms] of what was done, while they are wanted; None: they are not.
    """

    def __init__(self, memory: Memory):
        self.memory, self.stream = memory, None
        self.capture: Capture | None = None
        self.timings: list[tuple[str, int, float]] | None = None
        self._pending: deque[Job] = deque()
        self._lock = threading.RLock()

    def submit(self, do: Callable[[], None], stream: object, name: str = "", kind: int = 0) -> None:
        """Queue a job, or record it."""
        job = Job(do, name, kind)
        if self.capture is None:
            self._pending.append(job)
        elif stream is None:
            self.refuse("work on the default stream")
        else:
            self.capture.jobs.append(job)

    def release(self, do: Callable[[], None]) -> None:
        """Queue the release of something, which is never recorded."""
        self._pending.append(Job(do))

    def refuse(self, what: str) -> None:
        """Raise if a graph is being recorded, which is lost then."""
        if self.capture is not None:
            self.capture.spoilt = True
            raise RuntimeError(f"CUDA error 900: {what} is not permitted when a stream is capturing")

    def finish(self) -> bool:
        """Do all that is queued: what the host waits for."""
        self.refuse("waiting for the device")
        with self._lock:
            if self._pending:
                with self.memory.at_hand():
                    while self._pending:
                        self._run(self._pending.popleft())
        return True

    def _run(self, job: Job) -> None:
        start = time.perf_counter()
        job.do()
        if self.timings is not None and job.kind:
            self.timings.append((job.name, job.kind, 1e3 * (time.perf_counter() - start)))
