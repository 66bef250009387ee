"""Runs a drawn scene and says what became of it."""

import math
import re
import traceback
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpsph.errors import InputError, RunError
from warpsph.guards import is_exact, is_mutual
from warpsph.running.balance import energy
from warpsph.solver import Solver

from .drawn import DrawnScene

STEPS = 200
"""Steps that a scene has to run."""

END = 1e9
"""A time that no scene gets to [s]."""

SLOW = 0.01
"""Speed over that of sound at which a body counts as moving when errors are weighed."""

BOUNDS = {"float64": 1e-11, "mixed": 1e-4, "float32": 1e-4}
"""Largest error of energy and momentum of conservative schemes, over what there is of them, see `Account`."""


@dataclass(frozen=True)
class Outcome:
    """What became of a drawn scene.

    Attributes:
        kind: ``"ran"``, ``"refused"``, ``"turned over"``, ``"beyond"`` or ``"failed"``, see `judge`.
        detail: The message, or what is wrong.
        energy_error: Error of energy, see `BOUNDS`.
        momentum_error: Error of momentum.
        particles: Number of particles.
        steps: Steps taken.
        conserved: It ran, and conserves energy and momentum.
    """

    kind: str
    detail: str = ""
    energy_error: float = 0.0
    momentum_error: float = 0.0
    particles: int = 0
    steps: int = 0
    conserved: bool = False


def judge(drawn: DrawnScene, steps: int = STEPS) -> Outcome:
    """Run a drawn scene.

    It must run with a finite state, all particles and masses there, and energy and momentum within `BOUNDS`; or be
    refused before the first step, in one line that says what is allowed. Two reasons to stop are granted: a Total
    Lagrangian particle that turned over where the scene asks for no conversion, and matter that was beyond its equation
    of state, which is where that has no sound speed or no pressure. The line must name the particle.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            return _judge(drawn, steps)
        except Exception as error:  # whatever it is, it is what is looked for
            where = traceback.extract_tb(error.__traceback__)[-1]
            return Outcome(
                "failed", f"{type(error).__name__}: {error} ({where.name} in {Path(where.filename).name})"
            )


def _judge(drawn: DrawnScene, steps: int) -> Outcome:
    try:
        solver = Solver(drawn.made().finalize(), precision=drawn.precision, threads=1)
    except InputError as error:
        text = str(error)
        return Outcome("refused" if "\n" not in text and "allowed" in text else "failed", text)
    account, n = Account(solver), solver.particles.n
    try:
        solver.advance(END, lambda now: account.update() or now.steps >= steps)
    except RunError as error:
        return Outcome(_reason(solver, str(error)), str(error), particles=n, steps=_steps(str(error)))
    energy_error, momentum_error = account.errors()
    wrong = _wrong(solver)
    if solver.reading.steps < steps:
        wrong.append(f"only {solver.reading.steps} steps")
    bound, mutual = BOUNDS[drawn.precision], is_mutual(solver.data.numerics)
    conserved = mutual and is_exact(solver.data.numerics)
    if conserved and not energy_error <= bound:
        wrong.append(f"energy error {energy_error:.2g}")
    if mutual and not momentum_error <= bound:
        wrong.append(f"momentum error {momentum_error:.2g}")
    kind = "failed" if wrong else "ran"
    return Outcome(kind, ", ".join(wrong), energy_error, momentum_error, n, solver.reading.steps, conserved)


def _reason(solver: Solver, message: str) -> str:
    """Why a run stopped, if that is granted."""
    if "\n" in message or not re.search(
        r"particle \d+ of body '.*' \(material '.*'\) at \(.*\) m: ", message
    ):
        return "failed"
    if "turned over" in message:
        return "turned over" if solver.data.numerics.inverted == "stop" else "failed"
    return "beyond" if solver.particles.clipped.numpy().any() else "failed"


def _steps(message: str) -> int:
    return int(re.search(r"step (\d+):", message)[1])


class Account:
    """Energy and momentum of a run, and what there has been of them at most.

    That is of energy E its sum without regard to sign, and of momentum √(2 M E); but no less than at `SLOW` of the speed of
    sound. A body may be at rest without energy, and what rounding then makes goes with its moduli.
    """

    def __init__(self, solver: Solver):
        self._solver, p = solver, solver.particles
        m, c = (getattr(p, name).numpy().astype(np.float64) for name in ("m", "cs"))
        self._free = np.array([axis not in dict(solver.data.planes) for axis in range(3)])
        self._most_energy = 0.5 * float(m @ (SLOW * c) ** 2)
        self._most_momentum = float(m @ (SLOW * c))
        self._energy_change = self._momentum_change = 0.0
        self._start = self._now()

    def update(self) -> None:
        """Take the state as it is now into account."""
        (start, pushed), (now, momentum) = self._start, self._now()
        self._energy_change = max(self._energy_change, abs(now - start))
        change = np.linalg.norm((momentum - pushed)[self._free])
        self._momentum_change = max(self._momentum_change, float(change))

    def errors(self) -> tuple[float, float]:
        """Largest errors of energy and momentum so far."""
        return self._energy_change / self._most_energy, self._momentum_change / self._most_momentum

    def _now(self) -> tuple[float, np.ndarray]:
        """Energy and momentum, less what constraints have given."""
        p, now = self._solver.particles, self._solver.ledger()
        m = p.m.numpy().astype(np.float64)
        given = float(np.abs(p.work.numpy()).sum()) if hasattr(p, "work") else 0.0
        pushed = float(np.abs(p.impulse.numpy()).sum()) if hasattr(p, "impulse") else 0.0
        energies = float(now["kinetic_energy"] + m @ np.abs(p.e.numpy()) + given)
        self._most_energy = max(self._most_energy, energies)
        self._most_momentum = max(self._most_momentum, math.sqrt(2.0 * float(m.sum()) * energies) + pushed)
        momentum = np.array([now[f"momentum_{c}"] - now[f"impulse_{c}"] for c in "xyz"])
        return energy(now) - now["work"], momentum


def kind_of(message: str) -> str:
    """What kind of message a text is: without its numbers and names."""
    text = re.sub(r"'[^']*'|\([^)]*\)", "…", message)
    text = re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text)
    return text.split("; allowed")[0]


def _wrong(solver: Solver) -> list[str]:
    """What of the particles is not as it must be."""
    arrays, data = solver.particles.arrays(), solver.data
    wrong = [
        f"{name} not finite"
        for name, values in arrays.items()
        if values.dtype.kind == "f" and name not in ("p_high", "p_low") and not np.isfinite(values).all()
    ]
    ids = arrays["id"]
    if not (np.sort(ids) == np.arange(len(data.x))).all():
        return [*wrong, "particles lost"]
    if not (arrays["m"] == data.m[ids].astype(arrays["m"].dtype)).all():
        wrong.append("masses changed")
    if not (arrays["rho"] > 0.0).all():
        wrong.append("density not positive")
    for name in ("body", "mat", "fixed"):
        if name in arrays and not (arrays[name] == getattr(data, name)[ids]).all():
            wrong.append(f"{name} changed")
    return wrong
