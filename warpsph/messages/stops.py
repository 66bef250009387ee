"""Runs that cannot go on, and runs that were ended: the particle, the cause, what goes on from there.

A particle comes as a `warpsph.watching.trouble.Culprit`, which says when and where it was.
"""

import signal
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from warpsph.errors import Ended, RunError
from warpsph.units import si

if TYPE_CHECKING:
    from warpsph.watching.trouble import Culprit

TIME_IS_UP = 5
"""Exit code of a run whose wall time was up; what a signal ends has 128 and its number."""

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""What a signal is called."""

GO_ON = "`warpsph resume DIR --on-trouble warn` goes on from the last checkpoint in spite of it"


def not_finite(culprit: "Culprit", fields: Sequence[str], density: float = 1.0, clipped: int = 0) -> RunError:
    """A particle's state is not finite; ``clipped``: steps in which its equation of state had no answer before."""
    what = f"{', '.join(fields)} not finite"
    if density <= 0.0:
        what += f", density {density:.6g} kg/m^3 not positive"
    if clipped:
        what += f"; its equation of state had left its range in {clipped} steps"
        return _stopped(culprit, what, "a pressure_cutoff bounds the tension of a material")
    return _stopped(culprit, what, "a smaller cfl may help; look at the snapshot before")


def collapsed(culprit: "Culprit", dt: float, wave: float, acceleration: float, speed: float) -> RunError:
    """The time step [s] collapsed, by a wave speed [m/s], an acceleration [m/s²] or a speed [m/s]."""
    what = (
        f"time step collapsed to {dt:.3g} s (wave speed {wave:.3g} m/s, acceleration {acceleration:.3g} m/s^2, "
        f"speed {speed:.3g} m/s)"
    )
    return _stopped(culprit, what, "a smaller cfl, a stiffer contact or wider gaps between bodies may help")


def turned_over(culprit: "Culprit", smallest: float) -> RunError:
    """A Total Lagrangian particle's det F has come below the smallest that is allowed."""
    what = f"turned over, det F below {smallest:g}: too distorted for a Total Lagrangian particle"
    return _stopped(
        culprit, what, "a scheme adaptle... with inverted='convert' goes on with Eulerian particles"
    )


def crowded(particles: int, most: int) -> RunError:
    """Neighbour rows can no longer be numbered: particles lie on top of each other."""
    return RunError(
        f"the neighbour rows of {particles} particles need more than {most} entries; look at the last snapshot for where "
        "they crowd"
    )


def guarded(culprit: "Culprit", guard: str, value: float, limit: float, particles: int) -> RunError:
    """A guard that ends the run has found something."""
    return _stopped(culprit, trouble(guard, value, limit, particles), GO_ON)


def warned(culprit: "Culprit", guard: str, value: float, limit: float, particles: int) -> str:
    """What is said when a guard that warns finds something for the first time."""
    what = trouble(guard, value, limit, particles)
    return f"{guard} at t = {culprit.time:.6g} s, step {culprit.step}: {culprit}: {what}; the run goes on"


def counted(guard: str, entry: dict) -> str:
    """What a guard that warns has found in a whole run, from its entry in summary.json."""
    first = entry["first"]
    what = trouble(guard, first["value"], entry["limit"], entry["particles"])
    who = f"particle {first['particle']} of body {first['body']!r}"
    return f"{guard} at {entry['looks']} looks, first at t = {first['time']:.6g} s: {who} {what}"


def trouble(guard: str, value: float, limit: float, particles: int) -> str:
    """What a guard has found: the value of the worst particle against the limit, and how many particles there are."""
    text = {
        "density": f"density {value:.6g} kg/m^3 is not positive",
        "energy_error": f"has the most energy, and the energy error {value:.3g} is above its limit {limit:g}",
        "interpenetration": f"is {value:.3g} spacings deep in another body, limit {limit:g}",
        "domain": f"has left the domain by {value:.3g} m",
        "neighbours": f"has {value:.0f} neighbours within reach, limit {limit:.0f}",
    }[guard]
    return text if guard == "energy_error" else f"{text} ({particles} particle{'s' * (particles != 1)})"


def _stopped(culprit: "Culprit", what: str, advice: str) -> RunError:
    return RunError(f"stopped at t = {culprit.time:.6g} s, step {culprit.step}: {culprit}: {what}; {advice}")


def measure_failed(name: str, time: float, error: Exception) -> RunError:
    """A measure of the scene raised something, or gave no number, at a time [s]."""
    what = f"{type(error).__name__}: {error}"
    return RunError(
        f"measure {name!r} failed at t = {time:.6g} s: {what}; mend its function in the scene and run that anew"
    )


def stopped(cause: RunError, lost: Exception | None, last: Path | None) -> RunError:
    """A run stopped: why, what of it could not be written besides, and the last snapshot to look at."""
    besides = f"; besides, {lost}" if lost is not None else ""
    return RunError(f"{cause}{besides}; last snapshot: {last or 'none'}")


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
