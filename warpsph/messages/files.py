"""Files that cannot be read: which one, why, what to give instead."""

from pathlib import Path

from warpsph.errors import InputError

from .values import printable, shown

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


def in_the_series(error: InputError) -> InputError:
    """A snapshot that a run has written before, and that its index has to name, is damaged."""
    return InputError(f"{error}; move it away to go on without it")


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


def no_plot(path: Path, panels: int, most: int) -> InputError:
    """A history with more quantities than a plot can hold."""
    return InputError(f"{path} has {panels} quantities; a plot holds up to {most}")


def crowd(particles: int, extent: float, spacing: float) -> InputError:
    """A snapshot whose particles lie on top of each other; lengths in [m]."""
    return InputError(
        f"{particles} particles of {spacing:g} m lie within {extent:g} m: nothing can be drawn; allowed: another snapshot"
    )


def no_run(path: Path) -> InputError:
    """There is nothing to describe at a path."""
    return InputError(f"{path} does not exist; allowed: a run folder or a .vtkhdf snapshot")


def empty_run(path: Path) -> InputError:
    """A folder holds nothing to describe."""
    return InputError(
        f"{path} holds neither summary.json nor snapshots; allowed: a run folder or a .vtkhdf snapshot"
    )


def no_snapshots(folder: Path) -> InputError:
    """A folder holds nothing to draw."""
    return InputError(f"{folder} holds no snapshots (NAME_0000.vtkhdf); give the output folder of a run")


def no_summary(path: Path, why: str) -> InputError:
    """A file is no summary of a run; ``why`` goes on from its name."""
    return InputError(f"{path} {why}; allowed: the summary.json of a run")


def no_history(path: Path) -> InputError:
    """A file is no history of a run."""
    return InputError(f"{path} is no history: its first line must name columns like 'time [s]'")


def torn_history(path: Path, line: int, columns: int) -> InputError:
    """A line of a history is not one of its rows."""
    return InputError(f"{path} is damaged: line {line} is not a row of {columns} numbers")


def no_rows(path: Path) -> InputError:
    """A history has only begun."""
    return InputError(f"{path} has no rows yet; nothing can be plotted")


def nowhere() -> InputError:
    """A snapshot without a particle that is somewhere."""
    return InputError("no particle has a finite position: nothing can be drawn; allowed: another snapshot")
