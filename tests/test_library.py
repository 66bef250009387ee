"""Scenes are found, loaded and built, and whatever is wrong with one is said in one line."""

from pathlib import Path

import pytest

from warpsph import library
from warpsph.errors import InputError

SCENE = '''
"""A drop on a plate.

More about it.
"""
from pathlib import Path
from typing import Literal

class Drop:
    def __init__(self, **values):
        self.values = values
    def finalize(self):
        pass

def build(
    *,
    spacing: float = 1e-4,
    scheme: Literal["sav1", "bal"] = "sav1",
    corner: tuple[float, float] = (0.0, 1.0),
    mesh: Path | None = None,
    hot=False,
    count=3,
):
    """Build it.

    Args:
        spacing: Particle spacing [m],
            over two lines.
        scheme: What is solved.
    """
    return Drop(spacing=spacing, scheme=scheme, corner=corner, mesh=mesh, hot=hot, count=count)
'''.lstrip()


@pytest.fixture
def scene(tmp_path):
    """Write a scene file and give its path as text."""

    def write(text=SCENE, name="drop.py"):
        path = tmp_path / name
        path.write_text(text)
        return str(path)

    return write


def one_line(error):
    return "\n" not in str(error.value)


def test_a_scene_tells_its_parameters(scene):
    file = library.load(scene())
    assert (file.name, file.summary) == ("drop", "A drop on a plate.")
    assert file.source == SCENE
    assert list(file.parameters) == ["spacing", "scheme", "corner", "mesh", "hot", "count"]
    spacing, scheme = file.parameters["spacing"], file.parameters["scheme"]
    assert (spacing.default, spacing.kind) == (1e-4, "number")
    assert spacing.help == "Particle spacing [m], over two lines."
    assert scheme.choices == ("sav1", "bal")
    assert file.parameters["mesh"].kind == "path or None"
    assert file.parameters["hot"].kind == "yes or no"
    assert file.parameters["count"].kind == "whole number"


def test_values_reach_build_as_their_types(scene):
    built = library.load(scene()).build(spacing=1, corner=[2, 3.5], mesh="a.stl", hot=True)
    assert built.values["corner"] == (2.0, 3.5)
    assert type(built.values["spacing"]) is float
    assert built.values["mesh"] == Path("a.stl")
    assert built.values["scheme"] == "sav1"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"spacings": 1.0}, ["'spacings'", "drop", "spacing, scheme, corner, mesh, hot, count"]),
        ({"spacing": "fine"}, ["spacing = 'fine'", "number"]),
        ({"spacing": True}, ["spacing = True", "number"]),
        ({"count": 2.5}, ["count = 2.5", "whole number"]),
        ({"count": True}, ["count = True", "whole number"]),
        ({"scheme": "sav9"}, ["scheme = 'sav9'", "sav1, bal"]),
        ({"corner": (1.0,)}, ["corner = (1.0,)", "number and number"]),
        ({"mesh": 3}, ["mesh = 3", "path or None"]),
    ],
)
def test_bad_values_are_named(scene, values, words):
    with pytest.raises(InputError) as error:
        library.load(scene()).build(**values)
    assert one_line(error)
    assert all(word in str(error.value) for word in words)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("def build(:\n", ["line 1", "syntax error"]),
        ("import math\nmath.nothing\n", ["line 2", "AttributeError"]),
        ("x = 1\n", ["no function build"]),
        ("def build(spacing):\n    pass\n", ["spacing", "default"]),
        ("def build(**values):\n    pass\n", ["values", "default"]),
        ("def build(a: dict = {}):\n    pass\n", ["parameter a", "dict", "Literal"]),
        ("def build(a: float = 'x'):\n    pass\n", ["parameter a = 'x'", "number"]),
        ("def build(a=None):\n    pass\n", []),
        ("def build(a: 'Nothing' = 1):\n    pass\n", ["NameError"]),
    ],
)
def test_a_broken_file_is_named(scene, text, words):
    path = scene(text)
    if not words:
        library.load(path)
        return
    with pytest.raises(InputError) as error:
        library.load(path)
    assert one_line(error)
    assert all(word in str(error.value) for word in [path, *words])


def test_a_failing_build_names_the_line(scene):
    path = scene("def build(n=1):\n    return half(n)\n\ndef half(n):\n    return n / 0\n")
    with pytest.raises(InputError, match="line 5: ZeroDivisionError"):
        library.load(path).build()


def test_an_input_error_of_the_scene_passes(scene):
    path = scene(
        "from warpsph.errors import InputError\ndef build():\n    raise InputError('density = -1')\n"
    )
    with pytest.raises(InputError, match=r"^density = -1$"):
        library.load(path).build()


def test_build_has_to_return_a_scene(scene):
    with pytest.raises(InputError, match="returned None"):
        library.load(scene("def build():\n    pass\n")).build()


def test_a_scene_sees_its_neighbours_and_leaves_nothing_behind(scene, tmp_path):
    scene("value = 7\n", "beside.py")
    path = scene("import beside\ndef build(n: int = beside.value):\n    pass\n")
    assert library.load(path).parameters["n"].default == 7
    assert not list(tmp_path.glob("__pycache__/drop*"))


def test_a_missing_scene_lists_the_others(monkeypatch, tmp_path):
    monkeypatch.setattr(library, "names", lambda: ["hvi_2d", "sod"])
    monkeypatch.chdir(tmp_path)
    for name in ("hvi_2", "hvi_2d.py"):
        with pytest.raises(
            InputError, match=r"did you mean 'hvi_2d'\?\); allowed: hvi_2d, sod, the path"
        ) as error:
            library.find(name)
        assert one_line(error)
    assert not library.exists("hvi_2")


def test_a_folder_is_no_scene(tmp_path):
    (tmp_path / "a.py").mkdir()
    with pytest.raises(InputError, match="is unknown"):
        library.load(tmp_path / "a.py")


def test_every_bundled_scene_loads():
    for name in library.names():
        file = library.load(name)
        assert library.exists(name)
        assert file.summary
        assert all(p.help for p in file.parameters.values())
