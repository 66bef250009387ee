"""Find and load scenes: bundled ones by name, a user's own by path."""

import contextlib
import inspect
import sys
import traceback
import types
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin, get_type_hints

from .errors import InputError, RunError
from .messages import scripts, values
from .storage import text

if TYPE_CHECKING:
    from .scene import Scene

LONGEST = 2**24
"""Longest scene file that is read [bytes]."""

WORDS = {
    bool: "yes or no",
    int: "whole number",
    float: "number",
    str: "text",
    Path: "path",
    type(None): "None",
}
"""The plain types a scene parameter can have, in words."""


@dataclass(frozen=True)
class SceneParameter:
    """One keyword parameter of a scene's ``build``.

    Attributes:
        name: Its name in Python; on the command line underscores become hyphens.
        annotation: Its type: one of `WORDS`, a ``Literal``, a tuple of them, or a union.
        default: Value when it is not given.
        help: What the docstring of ``build`` says about it.
    """

    name: str
    annotation: Any
    default: Any
    help: str

    @property
    def choices(self) -> tuple:
        """Allowed values of a ``Literal``, else empty."""
        return get_args(self.annotation) if get_origin(self.annotation) is Literal else ()

    @property
    def kind(self) -> str:
        """The type in words."""
        return _in_words(self.annotation)

    def check(self, value: Any) -> Any:
        """Give the value as its type, for example a list from JSON as a tuple.

        Raises:
            InputError: If the value is of another type or not among the choices.
        """
        try:
            return _convert(self.annotation, value)
        except (TypeError, OverflowError):
            raise values.refuse(f"parameter {self.name}", value, self.kind) from None


@dataclass(frozen=True)
class SceneFile:
    """A loaded scene file.

    Attributes:
        name: File name without its ending.
        path: Where it was loaded from.
        source: Its text.
        summary: First line of its docstring.
        parameters: What ``build`` takes, by name.
        function: ``build`` itself.
    """

    name: str
    path: Path
    source: str
    summary: str
    parameters: dict[str, SceneParameter]
    function: Callable

    def build(self, /, **given: Any) -> "Scene":
        """Build the scene, with the defaults for parameters that are not given.

        Raises:
            InputError: For an unknown parameter, a bad value, or anything that goes wrong in the file.
        """
        for name in given.keys() - self.parameters.keys():
            raise values.unknown(f"parameter of scene {self.name}", name, self.parameters or ["none"])
        checked = {name: self.parameters[name].check(value) for name, value in given.items()}
        with _user_code(self.path):
            scene = self.function(**checked)
        if not hasattr(scene, "finalize"):
            raise scripts.no_scene(self.path, scene)
        return scene


def names() -> list[str]:
    """Names of the bundled scenes, sorted."""
    files = (Path(file.name) for file in resources.files("warpsph.scenes").iterdir())
    return sorted(file.stem for file in files if file.suffix == ".py" and not file.name.startswith("_"))


def exists(name_or_path: str) -> bool:
    """Whether `load` would find a file."""
    return name_or_path in names() or (name_or_path.endswith(".py") and Path(name_or_path).is_file())


def find(name_or_path: str | Path) -> Path:
    """Path of a scene file.

    Raises:
        InputError: If there is none; lists the bundled names and the closest one.
    """
    name = str(name_or_path)
    if name in names():
        return Path(str(resources.files("warpsph.scenes").joinpath(f"{name}.py")))
    path = Path(name)
    if path.suffix == ".py" and path.is_file():
        return path.resolve()
    raise values.unknown("scene", name, names(), "the path of a .py file")


def load(name_or_path: str | Path) -> SceneFile:
    """Load a bundled scene by name or a user's scene by path.

    Raises:
        InputError: If it does not exist, is not Python, has no ``build`` or one that cannot be used.
    """
    path = find(name_or_path)
    source = text.read(path, "scene", LONGEST)
    module = _execute(path, source)
    build = getattr(module, "build", None)
    if not inspect.isfunction(build):
        raise scripts.no_build(path)
    summary = (inspect.getdoc(module) or "").partition("\n")[0]
    return SceneFile(path.stem, path, source, summary, _parameters(path, build), build)


def _execute(path: Path, source: str) -> types.ModuleType:
    """Run a scene file as a module of its own, without leaving a byte-code file beside it."""
    try:
        code = compile(source, str(path), "exec")
    except SyntaxError as error:
        raise scripts.syntax(path, error) from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise scripts.no_python(path, error) from error
    module = types.ModuleType(f"warpsph_scene_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module
    with _user_code(path):
        exec(code, module.__dict__)
    return module


@contextlib.contextmanager
def _user_code(path: Path) -> Iterator[None]:
    """Run code of a scene file as ``python FILE`` would; a failure in it becomes one line with file and line."""
    sys.path.insert(0, str(path.parent))
    try:
        yield
    except (InputError, RunError):
        raise
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        raise scripts.failed(path, lines[-1] if lines else None, error) from error
    finally:
        sys.path.remove(str(path.parent))


def _parameters(path: Path, build: Callable) -> dict[str, SceneParameter]:
    """Read the parameters of ``build`` from its signature and docstring."""
    from docstring_parser import parse

    told = {p.arg_name: " ".join((p.description or "").split()) for p in parse(build.__doc__ or "").params}
    with _user_code(path):
        hints = get_type_hints(build)
    parameters = {}
    for name, entry in inspect.signature(build).parameters.items():
        if (
            entry.kind not in (entry.POSITIONAL_OR_KEYWORD, entry.KEYWORD_ONLY)
            or entry.default is entry.empty
        ):
            raise scripts.no_default(path, entry)
        parameter = SceneParameter(
            name, hints.get(name, type(entry.default)), entry.default, told.get(name, "")
        )
        try:
            parameter.check(entry.default)
        except InputError as error:
            raise scripts.bad_default(path, error) from None
        parameters[name] = parameter
    return parameters


def _in_words(annotation: Any) -> str:
    """Name a type for people; an unsupported one is named as it is written."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return ", ".join(str(choice) for choice in inner)
    if origin is tuple:
        return (
            "list of " + _in_words(inner[0]) if inner[1:] == (...,) else " and ".join(map(_in_words, inner))
        )
    if origin in (Union, types.UnionType):
        return " or ".join(map(_in_words, inner))
    if annotation in WORDS:
        return WORDS[annotation]
    supported = "bool, int, float, str, pathlib.Path, Literal[...], a tuple or union of them"
    return f"{supported} (it is annotated {annotation!r})"


def _convert(annotation: Any, value: Any) -> Any:
    """Give the value as the annotated type, or raise TypeError."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        if any(value == choice and type(value) is type(choice) for choice in inner):
            return value
    elif origin is tuple and isinstance(value, (tuple, list)):
        inner = inner[:1] * len(value) if inner[1:] == (...,) else inner
        if len(inner) == len(value):
            return tuple(_convert(a, v) for a, v in zip(inner, value, strict=True))
    elif origin in (Union, types.UnionType):
        for option in inner:
            with contextlib.suppress(TypeError):
                return _convert(option, value)
    elif annotation is float and type(value) is int:
        return float(value)
    elif annotation is Path and isinstance(value, (str, Path)):
        return Path(value)
    elif (
        annotation in WORDS
        and isinstance(value, annotation)
        and not (annotation is int and type(value) is bool)
    ):
        return value
    raise TypeError
