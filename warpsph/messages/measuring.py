"""What can go wrong when the program is measured: other codes beside it, compilers, reports."""

from collections.abc import Iterable
from pathlib import Path

from warpsph.errors import InputError, RunError

from .values import shown


def peer_not_run(command: str, error: Exception) -> InputError:
    """The command of another code cannot be started."""
    return InputError(f"--peer {command!r} cannot be run: {getattr(error, 'strerror', None) or error}")


def peer_failed(command: str, code: int, said: str) -> RunError:
    """The command of another code failed."""
    return RunError(f"--peer {command!r} failed with exit code {code}: {said}")


def peer_unclear(command: str, last: str) -> InputError:
    """The last line of another code holds no figures."""
    return InputError(
        f"--peer {command!r} printed {shown(last)} last; allowed: one line of JSON with ns_per_particle_step and "
        "threads (or ranks)"
    )


def peer_case(command: str, case: object, allowed: Iterable[str]) -> InputError:
    """Another code measured something that has no counterpart here."""
    return InputError(
        f"--peer {command!r} names case {case!r}; allowed beside Lagrangian steps: {', '.join(allowed)}"
    )


def no_results(path: Path) -> InputError:
    """A file holds no benchmark."""
    return InputError(f"{path} holds no results; allowed: a file that `warpsph bench --json` wrote")


def no_place(path: Path, begin: str, end: str) -> InputError:
    """A page has no place for a table."""
    return InputError(f"{path} has no place for the report; allowed: a file with the lines {begin} and {end}")


def no_checkout() -> InputError:
    """Pages of the documentation are in a checkout only."""
    return InputError("results are added to a checkout; allowed: to run this from one")


def no_snapshot_then(runs: Iterable[str]) -> InputError:
    """No run has a snapshot near the times asked for."""
    return InputError(f"no run of {', '.join(runs)} has a snapshot at the times asked for")


def no_step(scene: str, complaint: str) -> RunError:
    """A run that was to be timed took no step."""
    lines = complaint.splitlines() or ["no reason given"]
    return RunError(f"scene {scene!r} took no step: {lines[-1]}")


def ptxas_refused(assembler: object, name: str, arch: int, said: str) -> RunError:
    """The assembler does not take a file."""
    return RunError(f"ptxas {assembler} refuses {name} for sm_{arch}: {said}")


def ptxas_silent(kernel: str, module: str) -> RunError:
    """The assembler says nothing of a kernel."""
    return RunError(f"ptxas told nothing of {kernel} in {module}")
