"""Threads that share a launch."""

import functools
import weakref
from collections.abc import Callable, Iterable, Iterator
from queue import SimpleQueue
from threading import Thread

from .subnormals import flush

Work = Callable[[], None]
"""A piece of work."""


class Team:
    """The calling thread and its helpers, which wait for work in queues: no pool hands it over faster.

    Helpers take subnormal numbers for zero, see `subnormals`.
    """

    def __init__(self, threads: int):
        """Start ``threads`` - 1 helpers; they end with the team."""
        self._jobs: list[SimpleQueue] = [SimpleQueue() for _ in range(threads - 1)]
        for jobs in self._jobs:
            Thread(target=_help, args=(jobs,), daemon=True).start()
        weakref.finalize(self, _dismiss, self._jobs)

    def share(self, pieces: list[Work]) -> None:
        """Run all pieces, each by whoever is free; returns when all are done, also if it is interrupted meanwhile.

        Raises:
            Exception: What a piece raised.
        """
        rest, ended, failures = iter(pieces), SimpleQueue(), []
        for jobs in self._jobs:
            jobs.put((rest, ended))
        try:
            failures.append(_work(rest))
        finally:
            failures += [ended.get() for _ in self._jobs]
        for failure in filter(None, failures):
            raise failure

    def together(self, works: list[Work], leave: Work) -> None:
        """Run a piece of work for each thread, in which they wait for each other; returns when all are done.

        Args:
            works: The caller's first.
            leave: Told if a thread has ended early, so that the others wait for it no longer.

        Raises:
            Exception: What a thread raised.
        """

        def whole(work: Work) -> None:
            try:
                work()
            except BaseException:
                leave()
                raise

        ended, asked, failures = SimpleQueue(), 0, []
        try:
            for jobs, work in zip(self._jobs, works[1:], strict=True):
                jobs.put((iter([functools.partial(whole, work)]), ended))
                asked += 1
            failures.append(_work(iter([functools.partial(whole, works[0])])))
        except BaseException:  # interrupted between two lines of this
            leave()
            raise
        finally:
            failures += [ended.get() for _ in range(asked)]
        for failure in filter(None, failures):
            raise failure


def run_all(pieces: Iterable[Work]) -> None:
    """Run pieces one after the other."""
    for piece in pieces:
        piece()


def _help(jobs: SimpleQueue) -> None:
    flush()
    while (job := jobs.get()) is not None:
        rest, ended = job
        ended.put(_work(rest))


def _work(rest: Iterator[Work]) -> Exception | None:
    """Run pieces as long as there are any; gives what went wrong."""
    try:
        run_all(rest)
    except Exception as error:
        return error
    return None


def _dismiss(jobs: list[SimpleQueue]) -> None:
    for queue in jobs:
        queue.put(None)
