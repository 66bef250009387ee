"""What a user is told of a run that goes on all the same: one line each, also among the warnings of its summary."""

from pathlib import Path


def older_checkpoint(cause: str, path: Path, time: float) -> str:
    """The newest checkpoint cannot be read; an older one [s] serves."""
    return f"{cause}; going on from {path}, t = {time:g} s"


def other_arithmetic(then: str, now: str, time: float) -> str:
    """A run goes on from a time [s] on another device or in another precision."""
    return (
        f"computed {then} up to t = {time:g} s, and {now} from there on: "
        "no longer bit for bit what an unbroken run gives"
    )


def other_version(then: str, now: str, time: float) -> str:
    """A run goes on from a time [s] with other versions of this program or of Warp."""
    return (
        f"computed by {then} up to t = {time:g} s, and by {now} from there on: "
        "perhaps no longer bit for bit what an unbroken run gives"
    )


def history_lost(path: Path, last: float | None, time: float) -> str:
    """A history ends before the checkpoint's last row [s]: the system went down before it had them on the disk."""
    since = "its rows" if last is None else f"its rows after t = {last:g} s"
    return f"{path} has lost {since} up to t = {time:g} s; all else is whole"
