"""Files and folders that cannot be read or written: which one, why, what to do."""

from pathlib import Path

from warpsph.errors import InputError, RunError


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
