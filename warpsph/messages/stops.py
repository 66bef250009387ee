"""Runs that cannot go on, and runs that were ended: the particle, the cause, what goes on from there."""

from pathlib import Path

from warpsph.errors import RunError


def stopped(cause: RunError, lost: Exception | None, last: Path | None) -> RunError:
    """A run stopped: why, what of it could not be written besides, and the last snapshot to look at."""
    besides = f"; besides, {lost}" if lost is not None else ""
    return RunError(f"{cause}{besides}; last snapshot: {last or 'none'}")
