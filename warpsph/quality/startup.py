"""How long a user waits: from the start of the process to the end of a scene's first step."""

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from warpsph import library
from warpsph.messages import measuring
from warpsph.progress import Progress, quiet_warp

_CHILD = "import sys; from warpsph import cli; from warpsph.quality.startup import first_step; first_step(*sys.argv[1:])"
"""What a process runs: the command line's modules are loaded as in `warpsph run`, though nothing is parsed."""

_STEPPED = "stepped"
"""What it says when the first step is done."""


class _Stepped(Exception):
    """The first step is done."""


class _UntilFirstStep(Progress):
    """Ends a run at its first report, which comes after one step."""

    def update(self, **_facts: float) -> None:
        """Say so, and stop."""
        print(_STEPPED, flush=True)
        raise _Stepped


def first_step(scene: str, out: str, device: str = "cpu") -> None:
    """Run a scene into a folder up to its first step, with all that a run writes by then.

    Args:
        scene: A bundled scene by name, or the path of a scene file.
        out: Output folder, empty or none yet.
        device: Where to compute.
    """
    progress = _UntilFirstStep()
    with contextlib.suppress(_Stepped), quiet_warp(progress):
        from warpsph.run import run

        run(library.load(scene).build(), Path(out), device=device, frames=False, progress=progress)


def measure(scene: str, device: str = "cpu") -> dict[str, float]:
    """Wall time from the start of a process to the end of the first step of a scene [s].

    Args:
        scene: A bundled scene by name, or the path of a scene file.
        device: Where to compute.

    Returns:
        ``cold``, with an empty cache of kernels, and ``warm``, with what that left there.

    Raises:
        RunError: If a process ends before a step; with the last line that it wrote.
    """
    with tempfile.TemporaryDirectory() as cache:
        return {when: _start(scene, device, cache) for when in ("cold", "warm")}


def _start(scene: str, device: str, cache: str) -> float:
    """Start the scene once, in a process of its own."""
    with tempfile.TemporaryDirectory() as out:
        started = time.perf_counter()
        with subprocess.Popen(
            [sys.executable, "-c", _CHILD, scene, str(Path(out, "run")), device],
            env=os.environ | {"WARP_CACHE_PATH": cache}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        ) as child:  # fmt: skip
            said = child.stdout.readline().strip()
            seconds = time.perf_counter() - started
            complaint = child.communicate()[1].strip()
    if said != _STEPPED:
        raise measuring.no_step(scene, complaint)
    return seconds
