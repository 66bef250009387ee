"""Runs that cannot be gone on with: what of the folder, and whether to start anew."""

from pathlib import Path
from typing import TYPE_CHECKING

from warpsph.errors import InputError

if TYPE_CHECKING:
    import numpy as np


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


def too_early(until: float, time: float) -> InputError:
    """A run is to go on to a time that it has passed; times in [s]."""
    return InputError(f"until = {until:g} s is before the checkpoint's time; allowed: {time:g} or more")


def no_arrays(names: list[str]) -> InputError:
    """A checkpoint lacks arrays that the run needs."""
    return InputError(
        f"checkpoint lacks {', '.join(names)}; allowed: one of this version of warpsph (start the run anew)"
    )


def other_number(found: int, needed: int) -> InputError:
    """A checkpoint is of another number of particles."""
    return InputError(
        f"checkpoint holds {found} particles; this scene has {needed}: put back what the scene was built from"
    )


def wrong_array(name: str, array: "np.ndarray", shape: tuple[int, ...]) -> InputError:
    """An array of a checkpoint that the run cannot use."""
    return InputError(
        f"checkpoint holds {name} as {array.dtype} of shape {array.shape}; this run needs shape {shape}"
    )


def wrong_numbers(names: list[str]) -> InputError:
    """Numbers of bodies, materials and the like in a checkpoint that stand for nothing in the scene."""
    return InputError(f"checkpoint holds numbers in {', '.join(names)} that stand for nothing in this scene")
