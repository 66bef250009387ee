"""Sound files of every format that warpsph reads, small ones, to be spoilt."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from warpsph.fields import FIELDS
from warpsph.state import State
from warpsph.storage import checkpoint, history, snapshot

WIDTH = {"int": (), "real": (), "vec": (3,), "point": (3,), "mat": (3, 3), "sym": (3, 3)}
"""Shape of one entry on the state, by a field's kind."""

SCENE = '''"""Two small discs meet."""

from warpsph import Disc, Numerics, Scene


def build(speed: float = 400.0) -> Scene:
    """Build the discs."""
    scene = Scene("discs", dim=2, spacing=1e-3, until=1e-6, numerics=Numerics(scheme="sav1"), snapshots=2)
    scene.add_body("left", Disc(3e-3, center=(-3.6e-3, 0.0)), "aluminium", velocity=(speed, 0.0))
    scene.add_body("right", Disc(3e-3, center=(3.6e-3, 0.0)), "aluminium")
    return scene
'''
"""A scene of some fifty particles."""


def make(folder: Path, run: bool) -> dict[str, Path]:
    """Write one file of each format, and the folder of a run if wanted; gives the paths by format."""
    import pyvista

    folder.mkdir()
    path = {"snapshot": folder / "s_0001.vtkhdf", "checkpoint": folder / "checkpoint.h5"}
    path |= {"history": folder / "history.csv", "summary": folder / "summary.json"}
    state = _state()
    snapshot.write(path["snapshot"], state)
    checkpoint.save(
        path["checkpoint"], dict(state.fields), {"time": 1e-6, "step": 12, "parameters": {"speed": 1.0}}
    )
    with history.History(path["history"], [("time", "s"), ("step", "1"), ("pressure_max", "Pa")]) as table:
        for step in range(40):
            table.write([step / 3.0, step, 1e9 * np.sin(step)])
    facts = {
        "scene": "a",
        "parameters": {"x": [1.5, None]},
        "wall_s": 61.5,
        "time": 1e-6,
        "steps": 7,
        "warnings": ["b"],
    }
    path["summary"].write_text(json.dumps(facts, indent=2))
    ball = pyvista.Icosphere(nsub=1)
    for name, suffix, binary in (
        ("stl", "stl", True), ("stl (text)", "stl", False), ("obj", "obj", True), ("ply", "ply", True), ("ply (text)", "ply", False),
    ):  # fmt: skip
        path[name] = folder / f"{'binary' if binary else 'text'}.{suffix}"
        ball.save(path[name], binary=binary)
    if run:
        (folder / "scene.py").write_text(SCENE)
        path["run"] = folder / "run"
        command = [
            sys.executable,
            "-m",
            "warpsph",
            "run",
            str(folder / "scene.py"),
            "--out",
            str(path["run"]),
        ]
        subprocess.run([*command, "--until", "5e-7", "--no-frames"], check=True, capture_output=True)
    return path


def _state() -> State:
    """Some particles in two bodies, with every field that a snapshot has."""
    rng, n = np.random.default_rng(1), 40
    fields = {}
    for f in FIELDS:
        if f.output:
            shape = (n, *WIDTH[f.kind])
            fields[f.name] = np.zeros(shape, dtype=np.int32) if f.kind == "int" else rng.normal(size=shape)
    fields |= {"id": np.arange(n, dtype=np.int32), "body": np.repeat(np.arange(2, dtype=np.int32), n // 2)}
    return State(1e-6, 12, 2, 0.1, 0.12, "scene", ["one", "two"], ["aluminium"], fields)
