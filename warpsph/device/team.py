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
        rest = iter(pieces)
        self._run([rest] * (len(self._jobs) + 1))

    def together(self, works: list[Work], leave: Work) -> None:
        """Run a piece of work for each thread, in which they wait for each other; returns when all are done, as `share` does.

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

        self._run([iter([functools.partial(whole, work)]) for work in works], leave)

    def _run(self, parts: list[Iterator[Work]], leave: Work = lambda: None) -> None:
        """Have each thread run its part, the caller the first, and wait for all of them."""
        answers, ended = {}, SimpleQueue()
        asked = [(part, k, answers, ended) for k, part in enumerate(parts[1:])]
        try:
            self._ask(asked)
            failure = _work(parts[0])
        except BaseException:
            leave()
            self._ask(asked)  # perhaps not all were, and to be asked twice does nobody any harm
            raise
        finally:
            _wait(answers, ended, len(asked))
        for found in filter(None, [failure, *answers.values()]):
            raise found

    def _ask(self, asked: list[tuple]) -> None:
        for jobs, job in zip(self._jobs, asked, strict=True):
            jobs.put(job)


def run_all(pieces: Iterable[Work]) -> None:
    """Run pieces one after the other."""
    for piece in pieces:
        piece()


def _help(jobs: SimpleQueue) -> None:
    flush()
    while (job := jobs.get()) is not None:
        part, k, answers, ended = job
        answers[k] = _work(part)
        ended.put(None)


def _wait(answers: dict, ended: SimpleQueue, count: int) -> None:
    """Return when there are as many answers, however often it is interrupted; what interrupted it last is then raised."""
    interrupted = None
    while len(answers) < count:
        try:
            ended.get()  # only says that there is one more: it may be lost to an interruption
        except BaseException as error:
            interrupted = error
    if interrupted is not None:
        raise interrupted


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
