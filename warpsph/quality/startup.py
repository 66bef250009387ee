"""How long a user waits: from the command to the first step, with and without compiled kernels."""

import json
import os
import subprocess
import sys
import tempfile
import time

from warpsph.errors import RunError

SCENE = "hvi_2d"
"""The scene that is started."""

CODE = """
import json, sys, time
start = time.perf_counter()
import warp
from warpsph import library
from warpsph.solver import Solver
warp.init()
imported = time.perf_counter()
data = library.load(sys.argv[1]).build().finalize()
built = time.perf_counter()
Solver(data, device=sys.argv[2]).advance(float("inf"), lambda now: True)
stepped = time.perf_counter()
print(json.dumps({"import_s": imported - start, "scene_s": built - imported, "first_step_s": stepped - built}))
"""
"""Takes one step of the scene ``argv[1]`` on the device ``argv[2]``; its last line is JSON."""


def measure(device: str) -> dict[str, dict[str, float]]:
    """Start a scene with an empty cache of kernels, then again.

    Returns:
        For ``cold`` and ``warm``: ``total_s``, the wall time of the process, and its parts ``import_s``, ``scene_s`` and
        ``first_step_s``, which includes the compilation [s].
    """
    with tempfile.TemporaryDirectory() as cache:
        return {when: _start(device, cache) for when in ("cold", "warm")}


def _start(device: str, cache: str) -> dict[str, float]:
    """Start the scene in a process of its own.

    Raises:
        RunError: It failed.
    """
    command = [sys.executable, "-c", CODE, SCENE, device]
    start = time.perf_counter()
    done = subprocess.run(
        command, env=os.environ | {"WARP_CACHE_PATH": cache}, capture_output=True, text=True, check=False
    )
    total = time.perf_counter() - start
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing was said"])[-1]
        raise RunError(f"the start of {SCENE} on {device} failed: {said}")
    return {"total_s": total} | json.loads(done.stdout.strip().splitlines()[-1])
