"""Files and folders that cannot be read or written: which one, why, what to do."""

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING

from warpsph.errors import DiskError, InputError

from .machine import size
from .values import printable, shown

if TYPE_CHECKING:
    import numpy as np

MESHES = "a closed surface as STL, OBJ or PLY file"
"""Files that a mesh can come from."""

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
    errno.ESTALE: "mount the file system again",
}
"""What a user can do about a failure of the file system."""


FOREIGN = (PermissionError, FileExistsError, FileNotFoundError, NotADirectoryError, IsADirectoryError)
"""Failures that another folder on the command line would put right."""


def no_folder(folder: Path, error: OSError) -> InputError | DiskError:
    """An output folder cannot be made or written."""
    if not isinstance(error, FOREIGN):
        return unwritten(folder, error)
    return InputError(f"output folder {folder} cannot be written: {error.strerror or error}")


def unwritten(path: Path | str, error: OSError) -> DiskError:
    """Output could not be written: names the file, the cause in the system's words, and what to do about it."""
    remedy = REMEDIES.get(error.errno)
    return DiskError(
        f"{path} could not be written: {error.strerror or error}{_left(Path(path), error)}"
        + (f"; {remedy}" if remedy else "")
    )


def stopped(error: DiskError, last: Path | None, out: Path, goes_on: bool) -> DiskError:
    """A run stopped since output could not be written: what is there, and whether there is a checkpoint to go on from."""
    then = f"`warpsph resume {out}` goes on" if goes_on else "start the run anew with --force"
    return DiskError(f"{error}; last snapshot: {last or 'none'}; then {then}")


def no_frames(error: DiskError, out: Path) -> DiskError:
    """A run came to its end, but not its pictures."""
    return DiskError(f"{error}; the run itself is complete; then `warpsph render {out}` draws the frames")


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


def full_cache(cache: Path, need: float, free: float) -> DiskError:
    """Kernels have to be compiled, and there is no room for them."""
    return DiskError(
        f"kernel cache {cache} has no room: kernels to compile take up to {size(need)}, {size(free)} are free; "
        "free some space, or name another folder with WARP_CACHE_PATH"
    )


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


def absent(path: Path, form: str) -> InputError:
    """A file that is not there, or is a folder, a pipe or the like."""
    return InputError(f"{path} does not exist or is no file; give a {form}")


def damaged(path: Path, form: str, error: Exception) -> InputError:
    """A file of ours that is no longer what was written, or never was one; ``error`` says what is wrong."""
    lines = printable(str(error).strip("'\" .")).splitlines() or [""]
    reason = "it does not fit into the memory" if isinstance(error, MemoryError) else lines[0]
    return InputError(f"{path} is damaged or no {form} ({reason or type(error).__name__})")


def unreadable(path: Path, form: str, error: Exception) -> InputError:
    """A file of text that is missing, not plain, or not text."""
    reason = getattr(error, "strerror", None) or str(error)
    return InputError(f"{path} is not readable as a {form} ({printable(reason)})")


def foreign(path: Path, form: str, found: object) -> InputError:
    """A whole file of ours, but of another kind."""
    return InputError(f"{path} is no {form}: its format is {shown(found)}")


def other_version(path: Path, version: int, found: object) -> InputError:
    """A file of an older or a newer version of the format."""
    return InputError(f"{path} has format version {shown(found)}; this warpsph reads version {version}")


def no_surface(name: str, why: str) -> InputError:
    """A mesh, from a file or not, that is no closed surface; ``why`` goes on from its name."""
    return InputError(f"mesh {name} {why}; allowed: a closed surface, as file or pyvista.PolyData")


def no_mesh(path: Path) -> InputError:
    """A mesh that is not there, or is a folder or no plain file."""
    return InputError(f"mesh {path} does not exist or is no file; allowed: {MESHES}")


def mesh(path: Path, reason: str) -> InputError:
    """A mesh file of another kind, or that is not sound."""
    return InputError(f"mesh {path} cannot be read ({printable(reason)}); allowed: {MESHES}")


def wrong_array(name: str, array: "np.ndarray", shape: tuple[int, ...]) -> InputError:
    """An array of a checkpoint that the run cannot use."""
    return InputError(
        f"checkpoint holds {name} as {array.dtype} of shape {array.shape}; this run needs shape {shape}"
    )


def wrong_numbers(names: list[str]) -> InputError:
    """Numbers of bodies, materials and the like in a checkpoint that stand for nothing in the scene."""
    return InputError(f"checkpoint holds numbers in {', '.join(names)} that stand for nothing in this scene")


def no_plot(path: Path, panels: int, most: int) -> InputError:
    """A history with more quantities than a plot can hold."""
    return InputError(f"{path} has {panels} quantities; a plot holds up to {most}")


def crowd(particles: int, extent: float, spacing: float) -> InputError:
    """A snapshot whose particles lie on top of each other; lengths in [m]."""
    return InputError(
        f"{particles} particles of {spacing:g} m lie within {extent:g} m: nothing can be drawn; allowed: another snapshot"
    )


def no_checkpoint(folder: Path, name: str) -> InputError:
    """A folder holds nothing that a run could go on from."""
    return InputError(
        f"{folder} cannot be resumed: {name} is missing; it is no run, or one that ended before its first output: "
        f"start it with `warpsph run SCENE --out {folder} --force`"
    )


def no_whole_checkpoint(causes: list[str]) -> InputError:
    """Every checkpoint that there is cannot be read; ``causes`` names each."""
    return InputError(f"{'; '.join(causes)}; there is no other to go on from: start the run anew")


def scene_changed(path: Path) -> InputError:
    """The scene is not the one that a checkpoint is of."""
    return InputError(
        f"{path} was changed since the checkpoint; put the old text back, or start a new run of it: "
        f"warpsph run {path} --out FOLDER"
    )


def in_use(folder: Path, holder: dict, file: Path | None = None) -> InputError:
    """Another run writes into a folder; ``file`` is its lock if nothing else can tell whether it still does."""
    advice = "wait for it, end it, or use another --out"
    advice += f"; if it is over, remove {file}" if file else ""
    return InputError(f"output folder {folder} is in use by {who(holder)}; {advice}")


def stale_lock(folder: Path, holder: dict) -> str:
    """A lock was left behind, and is taken over."""
    return f"{folder}: {who(holder)}, ended without a word; its lock is taken over"


def who(holder: dict) -> str:
    """The process that a lock file names."""
    if not {"host", "pid", "since"} <= set(holder):
        return "another process"
    return f"process {holder['pid']} on {holder['host']}, there since {holder['since']}"
