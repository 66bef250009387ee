"""A process that reads files which may be broken or hostile, within limits of memory; its parent watches the time.

Each line on stdin, ``FORMAT<tab>PATH``, is answered by one line of JSON on stdout, see `attempt`.
"""

import contextlib
import hashlib
import io
import json
import os
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from warpsph import cli, info, mesh_files
from warpsph.errors import InputError, RunError
from warpsph.run import resume
from warpsph.shapes import Mesh
from warpsph.storage import checkpoint, history, snapshot

ROOM = 1536 * 2**20
"""Address space that reading may take beyond what the libraries have [bytes]."""

LONGEST = 1000
"""Most characters of a clear message."""

UNTIL = 7e-7
"""Time that a run of `originals` is gone on with to [s]."""

PROBE = np.random.default_rng(0).uniform(-1.0, 1.0, (20, 3))
"""Points that a mesh is asked for."""


def main() -> None:
    """Answer until stdin ends."""
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + ROOM, taken + ROOM))
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever a library prints does not get between the answers
    for line in sys.stdin:
        form, path = line.rstrip("\n").split("\t")
        print(json.dumps(attempt(form, Path(path))), file=answers, flush=True)


def attempt(form: str, path: Path) -> dict[str, Any]:
    """Read a file.

    Returns:
        ``outcome``: ``"read"``, ``"refused"`` with one clear line, or ``"traceback"``; ``said``: that line, or a checksum
        of what was read; ``seconds``; ``memory``, by how much the process grew meanwhile [bytes].
    """
    before, started = _highest_memory(anew=True), time.perf_counter()
    try:
        outcome, said = "read", READERS[form](path)
    except (InputError, RunError) as error:
        said = str(error)
        outcome = "refused" if said and len(said) < LONGEST and said.isprintable() else "traceback"
    except BaseException as error:
        outcome, said = "traceback", f"{type(error).__name__}: {error}"[:LONGEST]
    seconds, memory = time.perf_counter() - started, _highest_memory() - before
    return {"outcome": outcome, "said": said, "seconds": seconds, "memory": memory}


def _snapshot(path: Path) -> str:
    state = snapshot.read(path)
    facts = [
        state.time,
        state.step,
        state.dim,
        state.spacing,
        state.h,
        state.scene,
        state.bodies,
        state.materials,
    ]
    if snapshot.time(path) != state.time or not _is_clean(info.describe_state(state)):
        raise AssertionError("what was read does not agree, or would upset a terminal")
    return _checksum(facts, state.fields)


def _checkpoint(path: Path) -> str:
    arrays, facts = checkpoint.load(path)
    return _checksum(facts, arrays)


def _history(path: Path) -> str:
    names, units, columns = history.read(path)
    return _checksum([names, units], columns)


def _summary(path: Path) -> str:
    text = info.describe(path)
    if not _is_clean(text):
        raise AssertionError("the text would upset a terminal")
    return _checksum(text, {})


def _mesh(path: Path) -> str:
    mesh, polygons = Mesh(path), mesh_files.read(path)
    mesh.contains(PROBE)
    return _checksum("", {"points": polygons.points, "corners": polygons.corners, "sizes": polygons.sizes})


def _run(path: Path) -> str:
    summary = resume(path, until=UNTIL, frames=False)
    return _checksum([summary["steps"], summary["energy_error"]], {})


def _command(name: str, path: Path) -> str:
    """Run a command as from a terminal; a clear line on stderr with exit code 2, or 3 for a run, is a refusal."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main([name, str(path)])
        except SystemExit as end:
            code = end.code
    lines = err.getvalue().splitlines()
    if code in (2, 3) and lines and lines[-1].startswith("warpsph: "):
        raise InputError(lines[-1])
    if code or not _is_clean(out.getvalue()):
        raise AssertionError(f"exit code {code}: {err.getvalue()[-LONGEST:]}")
    return _checksum(code, {})


READERS: dict[str, Callable[[Path], str]] = {
    "snapshot": _snapshot, "checkpoint": _checkpoint, "history": _history, "summary": _summary, "run": _run,
    "stl": _mesh, "stl (text)": _mesh, "obj": _mesh, "ply": _mesh, "ply (text)": _mesh,
    "`warpsph info`": lambda path: _command("info", path), "`warpsph plot`": lambda path: _command("plot", path),
    "`warpsph render`": lambda path: _command("render", path),
}  # fmt: skip
"""What is done with a file, by format; gives a checksum of what was read."""


def _is_clean(text: str) -> bool:
    """Whether a text can be printed as it is."""
    return all(line.isprintable() for line in text.split("\n"))


def _checksum(facts: Any, arrays: dict[str, np.ndarray]) -> str:
    """Checksum of facts and arrays."""
    digest = hashlib.sha256(json.dumps(facts).encode())
    for name, array in arrays.items():
        digest.update(f"{name} {array.dtype} {array.shape}".encode() + np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _highest_memory(anew: bool = False) -> int:
    """Highest memory of the process so far [bytes], or from now on."""
    if anew:
        Path("/proc/self/clear_refs").write_text("5")
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


if __name__ == "__main__":
    main()
