"""A small run to do harm to: its command line, whether what is there of it is whole, whether it ends as unharmed."""

import contextlib
import io
import json
import os
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from warpsph import cli
from warpsph.errors import InputError
from warpsph.storage import checkpoint, folder

from . import whole

SCENE = '''"""Two balls."""

from warpsph.scene import Scene
from warpsph.shapes import Disc


def build() -> Scene:
    """Build it."""
    scene = Scene("balls", dim=2, spacing=1e-3, until=1e-6, snapshots=2)
    scene.add_body("left", Disc(4.5e-3, (-5e-3, 0.0)), "aluminium", velocity=(1000.0, 0.0))
    scene.add_body("right", Disc(4.5e-3, (5e-3, 2e-3)), "aluminium")
    scene.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    return scene
'''
"""Some 130 particles and three outputs: tenths of a second."""


class Bench:
    """Runs the scene, and compares what came of it with an unharmed run.

    Attributes:
        scene: Its file.
        frames: Whether pictures are drawn.
    """

    def __init__(self, scratch: Path, frames: bool = False):
        """Write the scene into a folder, and run it once unharmed."""
        self.frames, self.scene = frames, scratch / "balls.py"
        self.scene.write_text(SCENE)
        self._whole = scratch / ("whole_with_frames" if frames else "whole")
        code, said = self.run(self._whole)
        if code:
            raise RuntimeError(f"the unharmed run ended with {code}: {said}")

    def run(self, out: Path, *options: str) -> tuple[int, str]:
        """Run the scene into a folder; gives exit code and stderr."""
        return command("run", self.scene, "--out", out, "--threads", "1", *self._pictures(), *options)

    def words(self, out: Path) -> list[str]:
        """The same as a command for a process of its own."""
        words = "run", self.scene, "--out", out, "--threads", 1, *self._pictures()
        return [sys.executable, "-m", "warpsph", *map(str, words)]

    def go_on(self, out: Path) -> tuple[int, str]:
        """Go on from the checkpoint, or start anew where there is none; gives exit code and stderr."""
        if folder.checkpoints(out):
            return command("resume", out, "--threads", "1", *self._pictures())
        return self.run(out, "--force")

    def harm_in(self, out: Path, parts: bool = True) -> list[str]:
        """What is not whole in a folder, one line for each file; empty if all is well.

        Args:
            out: The folder.
            parts: Whether hidden, half-written files count too.
        """
        found = [f"{path.name} is left behind" for path in out.rglob(".*.part*") if parts]
        for path in sorted(path for path in out.rglob("[!.]*") if path.is_file()):
            try:
                self._check(path)
            except (InputError, OSError, ValueError, SyntaxError) as error:
                found.append(f"{path.relative_to(out)}: {error}")
        return found

    def _check(self, path: Path) -> None:
        """Read a file; a snapshot is also compared with the unharmed run's.

        Raises:
            ValueError: Or another error if it is not whole.
        """
        whole.check(path)
        if path.name == "history.csv" and not path.read_bytes().endswith(b"\n"):
            raise ValueError("ends in the middle of a row")
        if path.suffix == ".vtkhdf":
            if path.read_bytes() != (self._whole / "snapshots" / path.name).read_bytes():
                raise ValueError("differs from that of the unharmed run")

    def difference(self, out: Path) -> str | None:
        """The first thing in which a run that has ended differs from the unharmed one; None if nothing does."""
        for path in sorted(self._whole.rglob("*")):
            other = out / path.relative_to(self._whole)
            if path.suffix in (".vtkhdf", ".series", ".csv", ".png", ".py"):
                if not other.is_file() or path.read_bytes() != other.read_bytes():
                    return f"{path.name} differs"
        if harm := self.harm_in(out):
            return harm[0]
        if _arrays(out) != _arrays(self._whole):
            return "checkpoint.h5 differs"
        ends = [json.loads((folder / "summary.json").read_text()) for folder in (out, self._whole)]
        for key in ("steps", "time", "energy_error", "measures", "warnings"):
            if ends[0][key] != ends[1][key]:
                return f"{key} in summary.json differs"
        return None

    def _pictures(self) -> Sequence[str]:
        return () if self.frames else ("--no-frames",)


def command(*tokens: object) -> tuple[int, str]:
    """Run a command line in this process; gives exit code and stderr."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            cli.main([str(token) for token in tokens])
        except SystemExit as ended:
            return int(ended.code or 0), said.getvalue()
    raise AssertionError("a command ends with SystemExit")


def clear(out: Path) -> None:
    """Remove a folder, or what is in its place."""
    if out.is_dir() and not out.is_symlink():
        shutil.rmtree(out)
    elif os.path.lexists(out):
        out.unlink()


def _arrays(out: Path) -> dict[str, bytes]:
    """Arrays of a run's last checkpoint."""
    return {
        name: np.ascontiguousarray(array).tobytes()
        for name, array in checkpoint.load(out / "checkpoint.h5")[0].items()
    }
