"""Files and folders that cannot be read or written: which one, why, what to do."""

from pathlib import Path

from warpsph.errors import InputError


def no_folder(folder: Path, cause: str) -> InputError:
    """An output folder cannot be made or written."""
    return InputError(f"output folder {folder} cannot be written: {cause}")


def in_use(folder: Path, holder: dict, file: Path | None = None) -> InputError:
    """Another run writes into a folder; ``file`` is its lock if nothing else can tell whether it still does."""
    advice = "wait for it, end it, or use another --out"
    advice += f"; if it is over, remove {file}" if file else ""
    return InputError(f"output folder {folder} is in use by {who(holder)}; {advice}")


def stale_lock(folder: Path, holder: dict) -> str:
    """A lock was left behind, and is taken over."""
    return f"{folder}: {who(holder)}, ended without a word; its lock is taken over"


def no_checkpoint(folder: Path, name: str) -> InputError:
    """A folder cannot be gone on with."""
    return InputError(
        f"{folder} holds no {name}: it is no run, or one that ended before its first output; "
        f"start it with `warpsph run SCENE --out {folder} --force`"
    )


def who(holder: dict) -> str:
    """The process that a lock file names."""
    if not {"host", "pid", "since"} <= set(holder):
        return "another process"
    return f"process {holder['pid']} on {holder['host']}, there since {holder['since']}"
