"""The stand-in for a CUDA device: as strict as one, and the tests that need a GPU hold on it."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import warp as wp

pytestmark = pytest.mark.skipif(
    wp.is_cuda_available(), reason="there is a CUDA device, and no need of a stand-in"
)

TESTS = Path(__file__).parent

BEGIN = """
import numpy as np, warp as wp
from warpsph.device.copies import make_room
from warpsph.device.launch import Launcher

@wp.kernel(enable_backward=False)
def count(offset: wp.int32, x: wp.array(dtype=wp.float64)):
    i = wp.tid() + offset
    x[i] = x[i] + wp.float64(1.0)

x = wp.zeros(1000, dtype=wp.float64, device="cuda:0")
once = Launcher("cuda:0").bind(count, 1000, x=x)
"""


def on_stand_in(*command, **options):
    """Run Python in a process that has the stand-in."""
    given = [str(TESTS / "stand_in"), str(TESTS.parent), os.environ.get("PYTHONPATH", "")]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, given))}
    return subprocess.run(
        [sys.executable, *command], env=env, capture_output=True, text=True, check=False, **options
    )


@pytest.fixture
def told(tmp_path):
    """Tells what a piece of code says there in its last line; -n if it ends by signal n."""

    def run(code):
        path = tmp_path / "program.py"
        path.write_text(BEGIN + code)
        done = on_stand_in(str(path))
        assert done.returncode <= 0, done.stderr
        return done.returncode or done.stdout.splitlines()[-1]

    return run


def test_it_says_what_it_is(told):
    assert told("print(x.device.name)") == "stand-in for a GPU: host memory, CPU kernels"


def test_work_is_done_when_somebody_waits_for_it(told):
    code = """
room = make_room({"x": x})["x"]
once()
wp.copy(room, x)
early = float(np.nansum(room.numpy()))
wp.synchronize_device("cuda:0")
print(early, room.numpy().sum(), wp.empty(3, dtype=wp.float64, device="cuda:0").numpy())
"""
    assert told(code) == "0.0 1000.0 [nan nan nan]"


def test_a_graph_only_records_and_is_replayed(told):
    code = """
once()
with wp.ScopedCapture("cuda:0") as capture:
    once()
before = x.numpy().sum()
for _ in range(3):
    wp.capture_launch(capture.graph)
print(before, x.numpy().sum())
"""
    assert told(code) == "1000.0 4000.0"


def test_what_a_capture_does_not_take_ends_it(told):
    code = """
there = wp.zeros(1000, dtype=wp.float64, device="cpu")
for refused in (
    x.numpy,
    lambda: wp.synchronize_device("cuda:0"),
    lambda: wp.zeros(3, dtype=wp.float64, device="cuda:0"),
    lambda: wp.copy(there, x),
):
    try:
        with wp.ScopedCapture("cuda:0") as capture:
            refused()
        print("taken")
    except RuntimeError as error:
        assert "captur" in str(error), error
once()
print(x.numpy().sum())
"""
    assert told(code) == "1000.0"


def test_arrays_of_the_host_are_not_taken_for_the_device_s(told):
    code = """
try:
    Launcher("cuda:0").launch(count, 1000, x=wp.zeros(1000, dtype=wp.float64, device="cpu"))
except RuntimeError as error:
    print(error)
"""
    assert told(code).endswith("array 'x' is not in the device's memory")


def test_the_host_cannot_touch_the_device_s_memory(told):
    assert told("import ctypes; ctypes.string_at(x.ptr, 8)") == -signal.SIGSEGV


def test_solvers_hold_on_it():
    """Graphs, restarts and rows that move, on what behaves as a GPU does; all tests take a minute (CONTRIBUTING.md)."""
    chosen = ["test_cuda.py::test_a_graph_is_captured_and_gives_the_bits_of_plain_launches[sav1]"]
    chosen += ["test_cuda.py::test_energy_and_momentum[adaptle]", "test_memory.py"]
    done = on_stand_in("-m", "pytest", "-q", "-m", "gpu", "-p", "no:cacheprovider", *chosen, cwd=TESTS)
    assert done.returncode == 0 and "skipped" not in done.stdout, done.stdout + done.stderr
