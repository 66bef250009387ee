"""What users are told: in one place, one line each, and to the point."""

import ast
import errno
import importlib
import inspect
import pkgutil
from pathlib import Path

import numpy as np
import pytest

from warpsph import errors, messages
from warpsph.messages import bodies, files, machine, output, remarks, restarts, scripts, stops, values
from warpsph.watching.trouble import Culprit

PACKAGE = Path(messages.__file__).parents[1]
ERRORS = tuple(name for name, thing in vars(errors).items() if inspect.isclass(thing))
CULPRIT = Culprit(5, "ball", "steel", (1.0, 2.0, 3.0), 1e-6, 64)
KINDS = [info.name for info in pkgutil.iter_modules(messages.__path__)]


def made(path):
    """Lines of a file that make one of our errors."""
    calls = (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call))
    return [call.lineno for call in calls if isinstance(call.func, ast.Name) and call.func.id in ERRORS]


def test_errors_are_made_here_and_nowhere_else():
    elsewhere = [path for path in PACKAGE.rglob("*.py") if path.parent.name not in ("messages", "torture")]
    assert not {f"{path.relative_to(PACKAGE)}:{line}" for path in elsewhere for line in made(path)}


def test_every_kind_is_described():
    for kind in KINDS:
        assert f"`{kind}`" in messages.__doc__


@pytest.mark.parametrize("kind", KINDS)
def test_every_message_is_documented_and_gives_an_error(kind):
    module = importlib.import_module(f"{messages.__name__}.{kind}")
    for name, function in inspect.getmembers(module, inspect.isfunction):
        if function.__module__ != module.__name__ or name.startswith("_"):
            continue
        assert function.__doc__, f"{kind}.{name}"


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (values.refuse("dim", 4, "1, 2 or 3"), "dim = 4 is not allowed; allowed: 1, 2 or 3"),
        (values.refuse("x", np.zeros(2), "y"), "x = [0.0, 0.0] is not allowed; allowed: y"),
        (values.outside("cfl", 2.0, "0.0 to 1.0"), "cfl = 2.0 is out of range; allowed: 0.0 to 1.0"),
        (values.missing("G", "positive"), "G is missing; allowed: positive"),
        (
            values.unknown("material", "aluminum", ["aluminium", "steel"]),
            "material 'aluminum' is unknown (did you mean 'aluminium'?); allowed: aluminium, steel",
        ),
        (
            values.unknown("scene", "x", ["sod"], "the path of a .py file"),
            "scene 'x' is unknown; allowed: sod, the path of a .py file",
        ),
        (values.clash("a", "b", "c", "reason"), "a does not go with b: reason; allowed: c"),
        (values.lacks("erosion", "contact", "none"), "erosion needs contact; allowed: none"),
        (
            bodies.overlap("a", "b", 3, np.array([1.0, 2.0]), 0.5),
            "bodies 'a' and 'b' overlap near (1, 2) m: 3 particle pairs are too close; "
            "allowed: half a spacing, 0.5 m, or more",
        ),
        (
            scripts.failed(Path("a.py"), 5, ZeroDivisionError("division by zero")),
            "a.py, line 5: ZeroDivisionError: division by zero",
        ),
    ],
)
def test_common_messages(error, text):
    assert str(error) == text


def test_a_long_value_is_cut():
    assert len(str(values.refuse("x", list(range(1000)), "less"))) < 200


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (
            output.unwritten(Path("a/b.h5"), OSError(errno.EDQUOT, "Disk quota exceeded")),
            "a/b.h5 could not be written: Disk quota exceeded; make room within the quota",
        ),
        (
            output.not_empty(Path("out")),
            "output folder out is not empty; use --force, another --out, or `warpsph resume out`",
        ),
        (
            output.in_use(Path("out"), {"host": "h", "pid": 7, "since": "noon"}),
            "output folder out is in use by process 7 on h, there since noon; wait for it, end it, or use another --out",
        ),
        (
            files.damaged(Path("s.vtkhdf"), "warpsph snapshot", ValueError("no seal")),
            "s.vtkhdf is damaged or no warpsph snapshot (no seal)",
        ),
        (
            restarts.too_early(1.0, 2.0),
            "until = 1 s is before the checkpoint's time; allowed: 2 or more",
        ),
        (
            remarks.older_checkpoint("checkpoint.h5 is damaged", Path("checkpoint_previous.h5"), 1e-6),
            "checkpoint.h5 is damaged; going on from checkpoint_previous.h5, t = 1e-06 s",
        ),
        (
            stops.guarded(CULPRIT, "density", -2.0, 0.0, 3),
            "stopped at t = 1e-06 s, step 64: particle 5 of body 'ball' (material 'steel') at (1, 2, 3) m: density -2 kg/m^3 "
            "is not positive (3 particles); `warpsph resume DIR --on-trouble warn` goes on from the last checkpoint in spite "
            "of it",
        ),
        (
            machine.no_room("10 particles need 5 GB", "cuda:0", 10**9, ["2 particles", "float32"]),
            "10 particles need 5 GB on cuda:0, where 1 GB are free; allowed: 2 particles, or float32",
        ),
    ],
)
def test_common_messages_of_runs(error, text):
    assert str(error) == text
