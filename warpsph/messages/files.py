"""Files and folders that cannot be read or written: which one, why, what to do."""

from pathlib import Path

from warpsph.errors import InputError

from .values import printable, shown


def damaged(path: Path, form: str, error: Exception) -> InputError:
    """A file of ours that is no longer what was written, or never was one; ``error`` says what is wrong."""
    lines = printable(str(error).strip("'\" .")).splitlines() or [""]
    reason = "it does not fit into the memory" if isinstance(error, MemoryError) else lines[0]
    return InputError(f"{path} is damaged or no {form} ({reason or type(error).__name__})")


def foreign(path: Path, form: str, found: object) -> InputError:
    """A whole file of ours, but of another kind."""
    return InputError(f"{path} is no {form}: its format is {shown(found)}")


def other_version(path: Path, version: int, found: object) -> InputError:
    """A file of an older or a newer version of the format."""
    return InputError(f"{path} has format version {shown(found)}; this warpsph reads version {version}")
