"""Launches written out for the threads of a team: a graph for each, replayed side by side without the host in between."""

import ctypes
import functools

import warp as wp

from warpsph.kernels.spec import Spec
from warpsph.kernels.team import LEFT, TeamKernels, make_team

from .launch import Command, Launcher
from .team import Work

LINE = 16
"""Words of four bytes that a thread has for itself, so that no other's writing takes them out of its cache."""

MINE, ALONE, REST = range(3)
"""What that is: whether the slice that was claimed last is its own, whether another thread has left, and how often it has to
run its part yet."""


class Score:
    """Launches that are replayed in order, as often as one likes.

    On CUDA, and for one thread, this is one graph of all of them. For several threads of a CPU each has its part: it runs
    its slices of a launch, then those that its neighbour has not begun yet, and meets all others before the next launch.

    Warp runs a graph on a CPU without holding the interpreter lock.
    """

    def __init__(self, launcher: Launcher, kernels: TeamKernels | None, commands: list[Command]):
        """Record the launches without running them.

        Raises:
            RuntimeError: The device cannot record.
        """
        self._launcher, self._kernels, threads = launcher, kernels, launcher.threads
        with wp.ScopedDevice(launcher.device):
            self._claims = wp.zeros(sum(len(command.slices) for command in commands), dtype=wp.int32)
            self._meeting = wp.zeros(2, dtype=wp.int64)
            self._own = wp.zeros((threads, 3, LINE), dtype=wp.int32)
        self._parts = [self._record(commands, member) for member in range(threads)]

    def play(self, count: int) -> None:
        """Run everything ``count`` times."""
        if self._launcher.device.is_cuda:
            for _ in range(count):
                wp.capture_launch(self._parts[0])
            return
        for shared in (self._claims, self._meeting, self._own):
            shared.numpy()[:] = 0
        self._own.numpy()[:, REST] = count
        self._launcher.together(
            [functools.partial(wp.capture_launch, part) for part in self._parts], self._leave
        )

    def _leave(self) -> None:
        """Have nobody wait for one that does not come."""
        self._meeting.numpy()[LEFT] = 1

    def _record(self, commands: list[Command], member: int) -> wp.Graph:
        """Write out one thread's part; on a CPU its repetitions too."""
        with wp.ScopedCapture(self._launcher.device) as capture:
            if self._launcher.device.is_cpu:
                step = functools.partial(self._record_once, commands, member)
                wp.capture_while(self._own[member, REST], step)
            else:
                for command in commands:
                    command()
        return capture.graph

    def _record_once(self, commands: list[Command], member: int) -> None:
        threads, first = self._launcher.threads, 0
        mine, alone, rest = (self._own[member, entry] for entry in (MINE, ALONE, REST))
        for command in commands:
            for k, shared in self._shares(len(command.slices), member):
                if shared:
                    self._claimed(command.slices[k], first + k, mine)
                else:
                    command.slices[k].launch()
            if threads > 1:
                self._launch(self._kernels.meet, 0, threads, _give_way(), self._meeting, alone)
            first += len(command.slices)
        self._launch(self._kernels.countdown, 0, alone, rest)

    def _shares(self, count: int, member: int) -> list[tuple[int, bool]]:
        """Slices that a thread runs, and whether its neighbour may come first; of those of its neighbour the last ones first."""
        threads = self._launcher.threads
        if threads == 1 or count == 1:
            return [(k, False) for k in range(count) if member == 0]
        own, others = (
            range(count * m // threads, count * (m + 1) // threads) for m in (member, (member + 1) % threads)
        )
        return [(k, True) for k in (*own, *reversed(others))]

    def _claimed(self, piece: wp.Launch, number: int, mine: wp.array) -> None:
        """Run a slice if it is still there to be taken."""
        self._launch(self._kernels.claim, number, self._claims, mine)
        wp.capture_if(mine, piece.launch)

    def _launch(self, kernel: wp.Kernel, *args: object) -> None:
        """Record one thread of a kernel of the team; the first argument is its place."""
        wp.launch(kernel, 1, args, device=self._launcher.device)


def recorded(device: wp.Device, work: Work) -> Work:
    """Give work that consists of launches and copies as one call of C, on a CPU that can record; else as it is."""
    if device.is_cuda:
        return work
    try:
        with wp.ScopedCapture(device) as capture:
            work()
    except RuntimeError:
        return work
    return functools.partial(wp.capture_launch, capture.graph)


def written_out(launcher: Launcher, spec: Spec, command: Command) -> Work:
    """Give a launch as a `Score` of its own, on a CPU that can record; else as it is."""
    if launcher.device.is_cuda:
        return command
    try:
        score = Score(launcher, make_team(spec), [command])
    except RuntimeError:
        return command
    return functools.partial(score.play, 1)


@functools.cache
def _give_way() -> int:
    """Address of the C function by which a thread lets others have its core."""
    return ctypes.cast(ctypes.CDLL(None).sched_yield, ctypes.c_void_p).value
