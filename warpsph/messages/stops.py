"""Runs that cannot go on, and runs that were ended: the particle, the cause, what goes on from there."""

import signal
from pathlib import Path

from warpsph.errors import Ended
from warpsph.units import si

TIME_IS_UP = 5
"""Exit code of a run whose wall time was up; what a signal ends has 128 and its number."""

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""What a signal is called."""


def asked(number: signal.Signals) -> Ended:
    """A signal asks for an end."""
    return Ended(WORDS[number], 128 + number)


def time_is_up() -> Ended:
    """The wall time has run out, or will before everything is written."""
    return Ended("wall time is up", TIME_IS_UP)


def paused(ended: Ended, out: Path, time: float, until: float, steps: int) -> Ended:
    """A run was ended after some steps of this process, and its checkpoint is on the disk."""
    where = f"at t = {si(time, 's')} of {si(until, 's')}" + (", before any step" if steps == 0 else "")
    return Ended(f"{ended} {where}; `warpsph resume {out}` goes on from there", ended.code)


def undrawn(ended: Ended, out: Path) -> Ended:
    """A run was ended after its last step, before all frames were drawn."""
    return Ended(f"{ended}; all steps are done, `warpsph resume {out}` draws the frames", ended.code)


def already_done(out: Path, time: float) -> str:
    """A run that is to go on has reached its end."""
    return f"{out} is done: it ended at t = {si(time, 's')}; `warpsph resume {out} --until TIME` takes it further"
