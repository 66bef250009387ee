"""Runs in processes of their own, which a trial may signal and kill."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

PATIENCE = 120.0
"""Wall time that nothing in a trial takes, cold kernel cache included [s]."""

SCENE = '''"""Two balls."""

from warpsph import Disc, Scene


def build(spacing: float = 1e-3, snapshots: int = 6) -> Scene:
    """Build it."""
    scene = Scene("balls", dim=2, spacing=spacing, until=3e-6, snapshots=snapshots)
    scene.add_body("left", Disc(4.5e-3, (-5e-3, 0.0)), "aluminium", velocity=(1000.0, 0.0))
    scene.add_body("right", Disc(4.5e-3, (5e-3, 2e-3)), "aluminium")
    scene.add_measure("peak_pressure", lambda state: state.p.max(), "Pa", peak=True)
    return scene
'''
"""The scene of the trials with processes; its parameters make it coarse or fine, long or short."""


class Child:
    """A process of the command line.

    Attributes:
        process: The process.
    """

    def __init__(self, *tokens: object):
        """Start ``warpsph`` with some words."""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "warpsph", *map(str, tokens)],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=_hear_ctrl_c,
        )  # fmt: skip

    def wait(self, seconds: float = PATIENCE) -> bool:
        """Wait for the end, or for some time [s]; whether it has ended."""
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def wait_for(self, condition: Callable[[], bool]) -> bool:
        """Wait until a condition holds or the process has ended; whether it holds."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            if self.process.poll() is not None or time.monotonic() > deadline:
                return condition()
            time.sleep(0.002)
        return True

    def listens(self) -> bool:
        """Whether the program takes SIGTERM by now; before, the interpreter is being started."""
        try:
            status = Path(f"/proc/{self.process.pid}/status").read_text()
        except FileNotFoundError:
            return False
        caught = int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16)
        return bool(caught >> (signal.SIGTERM - 1) & 1)

    def signal(self, number: int) -> None:
        """Send a signal; nothing happens if it has ended."""
        self.process.send_signal(number)

    def end(self) -> tuple[int, str]:
        """Wait for the end; gives exit code and what was written to stderr. What does not end is killed."""
        try:
            said = self.process.communicate(timeout=PATIENCE)[1]
        except subprocess.TimeoutExpired:
            self.process.kill()
            said = self.process.communicate()[1]
        return self.process.returncode, said


def command(*tokens: object) -> tuple[int, str]:
    """Run a command line to its end; gives exit code and what it wrote to stderr."""
    return Child(*tokens).end()


def _hear_ctrl_c() -> None:
    """A shell makes what it runs in the background deaf to SIGINT; what is tried here must hear it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
