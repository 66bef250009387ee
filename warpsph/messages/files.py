"""Files and folders that cannot be read or written: which one, why, what to do."""

from pathlib import Path
from typing import TYPE_CHECKING

from warpsph.errors import InputError, RunError

from .values import printable, shown

if TYPE_CHECKING:
    import numpy as np

MESHES = "a closed surface as STL, OBJ or PLY file"
"""Files that a mesh can come from."""


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
    return InputError(f"{folder} cannot be resumed: {name} is missing; allowed: the folder of a run")


def no_whole_checkpoint(causes: list[str]) -> InputError:
    """Every checkpoint that there is cannot be read; ``causes`` names each."""
    return InputError(f"{'; '.join(causes)}; there is no other to go on from: start the run anew")


def not_renamed(path: Path, error: OSError) -> RunError:
    """A file cannot get another name."""
    return RunError(f"{path} could not be renamed: {error.strerror or error}; is the folder writable?")


def scene_changed(path: Path) -> InputError:
    """The scene is not the one that a checkpoint is of."""
    return InputError(
        f"{path} was changed since the checkpoint; put the old text back, or start a new run of it: "
        f"warpsph run {path} --out FOLDER"
    )
