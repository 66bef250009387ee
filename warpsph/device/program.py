"""The launches of a step as one thing to run: on a GPU a CUDA graph, captured once and replayed."""

import warnings

import warp as wp

from .launch import Command, Launcher


class Program:
    """Launches that are run over and over, in order.

    A launch costs the host some microseconds, a replayed graph of all of them as much as one. A captured launch may
    neither allocate nor wait for the device: those of a step do neither, dt = 0 in device memory makes a step void.

    Attributes:
        captured: Replay a graph (on CUDA, unless its capture has failed) instead of launching one by one.
    """

    def __init__(self, launcher: Launcher):
        self.captured = launcher.device.is_cuda
        self._device = launcher.device
        self._arithmetic = launcher.arithmetic
        self._commands: list[Command] = []
        self._graph: wp.Graph | None = None

    def bind(self, commands: list[Command]) -> None:
        """Take other launches, or the same ones after arrays have moved in memory: an older graph is dropped."""
        self._commands, self._graph = commands, None

    def run(self, count: int) -> None:
        """Run everything ``count`` times; the first time after `bind` one by one, so that all code is on the device."""
        with self._arithmetic:
            for _ in range(count):
                if self.captured and self._graph is not None:
                    wp.capture_launch(self._graph)
                    continue
                self._launch()
                if self.captured:
                    self._graph = self._capture()

    def _launch(self) -> None:
        for command in self._commands:
            command()

    def _capture(self) -> wp.Graph | None:
        """Record the launches without running them; a device that cannot is told so once."""
        try:
            with wp.ScopedCapture(self._device) as capture:
                self._launch()
        except RuntimeError as error:
            self.captured = False
            warnings.warn(f"no CUDA graph on {self._device}, launching one by one: {error}", stacklevel=2)
            return None
        return capture.graph
