"""Output that cannot be written: which file or folder, why, what to do."""

import errno
import os
from pathlib import Path

from warpsph.errors import DiskError, Ended, InputError

from .machine import size
from .values import printable

REMEDIES = {
    errno.ENOSPC: "free some space",
    errno.EDQUOT: "make room within the quota",
    errno.EFBIG: "allow larger files (ulimit -f)",
    errno.EROFS: "make the file system writable",
    errno.EACCES: "allow writing there",
    errno.EPERM: "allow writing there",
    errno.ENOENT: "bring its folder back",
    errno.ENOTDIR: "bring its folder back",
    errno.EISDIR: "move the folder of that name away",
    errno.EIO: "see to the disk",
    errno.ENAMETOOLONG: "use a shorter name",
    errno.ESTALE: "mount the file system again",
}
"""What a user can do about a failure of the file system."""

FOREIGN = (PermissionError, FileExistsError, FileNotFoundError, NotADirectoryError, IsADirectoryError)
"""Failures that are those of a name."""


def in_the_way(out: Path, file: Path) -> InputError:
    """The name of an output folder, or one above it, is that of a file."""
    return InputError(f"output folder {out} cannot be made: {file} is a file; use another --out")


def no_permission(out: Path, parent: Path) -> InputError:
    """The user may not write where the output folder is, or is to be."""
    return InputError(
        f"output folder {out} cannot be written: no permission in {parent}; allow writing there, or use another --out"
    )


def is_by_name(error: OSError) -> bool:
    """Whether a failure of the file system is one that another name on the command line would put right."""
    return isinstance(error, FOREIGN) or error.errno in (errno.ENAMETOOLONG, errno.ELOOP)


def no_folder(folder: Path, error: OSError) -> InputError | DiskError:
    """An output folder cannot be made or written."""
    if not is_by_name(error):
        return unwritten(folder, error)
    return InputError(
        f"output folder {folder} cannot be written: {error.strerror or error}; use another --out"
    )


def not_empty(out: Path) -> InputError:
    """There is something in the output folder already."""
    return InputError(
        f"output folder {out} is not empty; use --force, another --out, or `warpsph resume {out}`"
    )


def in_use(folder: Path, holder: dict, file: Path | None = None) -> InputError:
    """Another run writes into a folder; ``file`` is its lock if nothing else can tell whether it still does."""
    advice = "wait for it, end it, or use another --out"
    advice += f"; if it is over, remove {file}" if file else ""
    return InputError(f"output folder {folder} is in use by {who(holder)}; {advice}")


def stale_lock(folder: Path, holder: dict) -> str:
    """A lock was left behind, and is taken over."""
    return f"{folder}: {who(holder)}, ended without a word; its lock is taken over"


def too_small(out: Path, need: float, free: float) -> InputError:
    """Not even the first output fits on the disk."""
    return InputError(
        f"output folder {out} has no room: the first output takes about {size(need)}, {size(free)} are free; "
        "allowed: a disk with more, or fewer particles"
    )


def tight(out: Path, need: float, free: float) -> str:
    """The disk will be full before the run ends: a warning."""
    return (
        f"warning: the whole run takes about {size(need)} on the disk, {size(free)} are free in {out}; "
        "it stops where the disk is full, and can be resumed with more"
    )


def unwritten(path: Path | str, error: OSError) -> DiskError:
    """Output could not be written: names the file, the cause in the system's words, and what to do about it."""
    remedy = REMEDIES.get(error.errno)
    return DiskError(
        f"{path} could not be written: {error.strerror or error}{_left(Path(path), error)}"
        + (f"; {remedy}" if remedy else "")
    )


def stopped(error: DiskError, ended: Ended | None, last: Path | None, out: Path, goes_on: bool) -> DiskError:
    """A run stopped since output could not be written: what is there, and whether there is a checkpoint to go on from.

    ``ended``: what had asked it to stop anyway.
    """
    before = f"{ended}, but " if ended else ""
    then = f"`warpsph resume {out}` goes on" if goes_on else "start the run anew with --force"
    return DiskError(f"{before}{error}; last snapshot: {last or 'none'}; then {then}")


def no_frames(error: DiskError, out: Path) -> DiskError:
    """A run came to its end, but not its pictures."""
    return DiskError(f"{error}; the run itself is complete; then `warpsph render {out}` draws the frames")


def full_cache(cache: Path, need: float, free: float) -> DiskError:
    """Kernels have to be compiled, and there is no room for them."""
    return DiskError(
        f"kernel cache {cache} has no room: kernels to compile take up to {size(need)}, {size(free)} are free; "
        "free some space, or name another folder with WARP_CACHE_PATH"
    )


def who(holder: dict) -> str:
    """The process that a lock file names."""
    if not {"host", "pid", "since"} <= set(holder):
        return "another process"
    return printable(f"process {holder['pid']} on {holder['host']}, there since {holder['since']}")


def _left(path: Path, error: OSError) -> str:
    """What is left on a full disk, in brackets: a disk with room for bytes may have none for files."""
    if error.errno != errno.ENOSPC:
        return ""
    try:
        disk = os.statvfs(path.parent)
    except OSError:
        return ""
    files = ", none for another file" if disk.f_files and not disk.f_favail else ""
    return f" ({size(disk.f_bavail * disk.f_frsize)} free{files})"
