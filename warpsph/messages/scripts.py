"""Scene files that cannot be used: which file and line, what is wrong, what a scene file must have."""

from pathlib import Path

from warpsph.errors import InputError


def no_python(path: Path, error: Exception) -> InputError:
    """The file is not Python at all."""
    return InputError(f"{path}: not a Python file: {error}")


def syntax(path: Path, error: SyntaxError) -> InputError:
    """A line is not Python."""
    return InputError(f"{path}, line {error.lineno}: syntax error: {error.msg}")


def failed(path: Path, line: int | None, error: Exception) -> InputError:
    """Its code raised something."""
    where = str(path) if line is None else f"{path}, line {line}"
    return InputError(f"{where}: {type(error).__name__}: {error}")


def no_build(path: Path) -> InputError:
    """There is no function that builds the scene."""
    return InputError(
        f"scene file {path} has no function build(...); it must define one that returns a Scene"
    )


def no_scene(path: Path, found: object) -> InputError:
    """What ``build`` gives is no scene."""
    return InputError(f"{path}: build() returned {found!r}; it must return a warpsph Scene")


def no_default(path: Path, entry: object) -> InputError:
    """A parameter of ``build`` cannot be an option."""
    return InputError(f"{path}: parameter {entry} of build() needs a name and a default value")


def bad_default(path: Path, error: InputError) -> InputError:
    """A parameter's default is not of its own type."""
    return InputError(f"{path}: default of build(): {error}")


def reserved(path: Path, name: str) -> InputError:
    """A parameter of ``build`` has the name of an option of ``warpsph run``."""
    return InputError(f"{path}: parameter {name!r} of build() is an option of `warpsph run`; rename it")
