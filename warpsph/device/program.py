"""The launches of a step as one thing to run: recorded once and replayed, on a GPU as a CUDA graph."""

import warnings

from warpsph.kernels.spec import Spec
from warpsph.kernels.team import make_team

from .launch import Command, Launcher
from .score import Score


class Program:
    """Launches that are run over and over, in order: a plan of the next step, and steps that end with it.

    A launch costs the host some microseconds, and a tenth of a millisecond where a thread is woken to share it; to replay
    all of them costs as much as one. What is replayed may neither allocate nor wait for the device: the launches of a
    step do neither, dt = 0 in device memory makes a step void.

    Attributes:
        captured: Replay a `Score` (unless recording it has failed) instead of launching one by one.
    """

    def __init__(self, launcher: Launcher, spec: Spec):
        self.captured = True
        self._launcher, self._kernels = launcher, make_team(spec) if launcher.device.is_cpu else None
        self._commands: dict[str, list[Command]] = {"step": [], "plan": []}
        self._scores: dict[str, Score] = {}

    def bind(self, step: list[Command], plan: list[Command]) -> None:
        """Take other launches, or the same ones after arrays have moved in memory: older scores are dropped."""
        self._commands, self._scores = {"step": [*step, *plan], "plan": plan}, {}

    def run(self, count: int) -> None:
        """Take ``count`` steps; the first one after `bind` one by one, so that all code is on the device."""
        self._run("step", count)

    def plan(self) -> None:
        """Plan a step without taking one."""
        self._run("plan", 1)

    def _run(self, which: str, count: int) -> None:
        if self.captured and count > 0 and which not in self._scores:
            self._launch(which, 1)
            count -= 1
            self._record(which)
        if not self.captured:
            self._launch(which, count)
        elif count > 0:
            self._scores[which].play(count)

    def _launch(self, which: str, count: int) -> None:
        with self._launcher.arithmetic:
            for _ in range(count):
                for command in self._commands[which]:
                    command()

    def _record(self, which: str) -> None:
        """Record launches without running them; a device that cannot is told so once."""
        try:
            self._scores[which] = Score(self._launcher, self._kernels, self._commands[which])
        except RuntimeError as error:
            self.captured = False
            device = self._launcher.device
            warnings.warn(f"no graph on {device}, launching one by one: {error}", stacklevel=4)
