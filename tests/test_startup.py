"""The time until a scene's first step: a process of its own tells when it is done, or why not."""

import pytest

from warpsph.errors import RunError
from warpsph.quality import startup

SCENE = '''"""A bar."""

from warpsph import Box, Scene


def build() -> Scene:
    scene = Scene("bar", dim=1, spacing=1e-3, until=1.0)
    scene.add_body("bar", Box(0.0, {length}), "aluminium")
    return scene
'''


def write(path, length):
    path.write_text(SCENE.format(length=length))
    return str(path)


def test_a_process_runs_to_the_first_step_and_no_further(tmp_path):
    found = startup.measure(write(tmp_path / "bar.py", 20e-3))
    assert 0.0 < found["warm"] < found["cold"]


def test_the_first_step_leaves_the_files_of_a_run(tmp_path, capsys):
    startup.first_step(write(tmp_path / "bar.py", 20e-3), str(tmp_path / "out"))
    assert capsys.readouterr().out == "stepped\n"
    assert len(list((tmp_path / "out" / "snapshots").glob("*.vtkhdf"))) == 1
    assert not (tmp_path / "out" / "summary.json").exists()


def test_a_scene_that_takes_no_step_says_why(tmp_path):
    with pytest.raises(RunError, match=r"took no step: .*high of Box = -1"):
        startup.measure(write(tmp_path / "bar.py", -1))
