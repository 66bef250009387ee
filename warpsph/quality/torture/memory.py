"""Memory: what a run is said to need against what it takes, and what is refused before it does harm."""

import json
import resource
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import warp as wp

from warpsph.memory.policy import GENEROUS, THRIFTY, Policy
from warpsph.memory.usage import usage
from warpsph.messages.machine import size
from warpsph.quality import block
from warpsph.run import run as run_scene
from warpsph.scene import SceneData
from warpsph.solver import Solver

from .trial import Findings, Means

LOW, HIGH = 0.95, 1.20
"""What the estimate may be over what the solver takes."""

LEAST, MOST = 0.80, 1.25
"""The same of the process's largest resident memory."""

QUICKLY, LITTLE = 20.0, 1e9
"""Time [s] and resident memory [bytes] that a refusal may take, Python, Warp and the scene's own modules included."""

PEAK = """
import resource, subprocess, sys
code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)
"""
"""Runs a command and tells its largest resident memory [kB]. That of a process begins with its parent's, hence one between
that is small."""


@dataclass(frozen=True)
class Case:
    """A block of particles and how it is run."""

    dim: int
    particles: int
    scheme: str
    precision: str = "float64"
    policy: Policy = GENEROUS


QUICK = (Case(2, 3000, "sav1"), Case(2, 3000, "adaptle"))
"""Cases of the short version."""

FULL = (
    *(Case(3, 30000, name) for name in ("sav1", "sav1-mixed-as", "pm", "ts2", "tl", "adaptle", "adaptle-mixed-as")),
    *(Case(2, 30000, name) for name in ("sav1", "bal-mixed-as", "ts2-mixed", "tl-plain", "adaptle")),
    *(Case(3, 30000, "sav1", precision) for precision in ("float32", "mixed")),
    *(Case(3, 30000, name, "float32", THRIFTY) for name in ("sav1", "adaptle")),
)  # fmt: skip
"""Cases of the full version: solvers alone, the last two with the rows of a GPU."""

PROCESSES = (Case(3, 200_000, "sav1"), Case(2, 500_000, "tl"), Case(3, 1_000_000, "sav1"))
"""Whole runs, each in a process of its own."""


def run(means: Means) -> Findings:
    """Compare estimates with what was taken, of solvers and of whole processes, and try what cannot fit."""
    found = Findings(("case", "said", "taken", "said/taken"))
    found.notes.append(
        "Estimates from the field table and a sample of neighbours, against the arrays of the solver, and against the "
        "largest resident memory of a process (there: resident before, and what is said to come). Then what cannot fit, "
        "with how long it takes to be refused and the resident memory of the process that refuses it."
    )
    for case in QUICK if means.quick else FULL:
        means.say(f"{case.scheme}, {case.dim}D, {case.precision}")
        said, taken = against(case)
        _note(found, _title(case), said, taken, (LOW, HIGH))
    for case in () if means.quick else PROCESSES:
        means.say(f"{case.particles} particles in a process of their own")
        said, taken = process(case, means.scratch)
        _note(found, f"{_title(case)}, whole process with outputs", said, taken, (LEAST, MOST))
    _refusals(means, found)
    return found


def against(case: Case) -> tuple[int, int]:
    """Bytes that a solver was estimated to need, and those it has taken."""
    solver = Solver(scene(case), precision=case.precision, policy=case.policy)
    return solver.need.on_device, sum(usage(solver).values())


def scene(case: Case) -> SceneData:
    """The block of a case; half of it Eulerian where the scheme couples."""
    data = block.block(case.dim, case.particles).finalize()
    eulerian = block.half(data.x) if case.scheme.startswith("adaptle") else data.eulerian
    return replace(data, numerics=replace(data.numerics, scheme=case.scheme), eulerian=eulerian)


def process(case: Case, folder: Path) -> tuple[int, int]:
    """Bytes that a run in a process of its own was said to need on top of what it had, and the most it has had."""
    call = (
        f"from {__name__} import child; child({case.dim}, {case.particles}, {case.scheme!r}, {str(folder)!r})"
    )
    shown = subprocess.run([sys.executable, "-c", call], capture_output=True, text=True, check=True)
    shutil.rmtree(folder / "out")
    said, taken = json.loads(shown.stdout.splitlines()[-1])
    return said, taken


def child(dim: int, particles: int, scheme: str, folder: str) -> None:
    """Run a block for a moment, with outputs, and print what was said and what was taken [bytes]."""
    made = block.block(dim, particles)
    made.numerics = replace(made.numerics, scheme=scheme)
    made.until, made.snapshots = 1e-8, 3
    said = []
    estimated = Solver.__init__

    def noting(self, *given, say, **named):
        def told(text):
            said.append(_resident("VmRSS"))
            said.append(self.need.on_device + self.need.outputs)

        estimated(self, *given, say=told, **named)

    Solver.__init__ = noting
    wp.config.quiet = True
    run_scene(made, Path(folder, "out"), frames=False)
    print(json.dumps([sum(said), _resident("VmHWM")]))


def _refusals(means: Means, found: Findings) -> None:
    """Try what cannot fit: it has to be refused, soon, in one line, with nothing written."""
    tries = {"hvi_2d, spacing 1e-9 m": (["--spacing", "1e-9"], None)}
    if not means.quick:
        tries |= {
            "hvi_2d, spacing 1e-300 m": (["--spacing", "1e-300"], None),
            "hvi_2d, spacing 1e-5 m, address space of 3 GB": (["--spacing", "1e-5"], 3 * 10**9),
        }
    for title, (options, limit) in tries.items():
        means.say(title)
        out = means.scratch / f"refused_{len(found.rows)}"
        code, line, seconds, peak = _refused(["run", "hvi_2d", *options, "--out", str(out)], limit)
        found.rows.append((title, f"exit code {code} after {seconds:.1f} s", size(peak), "-"))
        found.notes.append(f"{title}: `{line}`")
        if code != 2 or "allowed:" not in line or out.exists():
            found.failed.append(f"{title}: exit code {code}, {line}")
        if seconds > QUICKLY or peak > (limit or LITTLE):
            found.failed.append(f"{title}: refused after {seconds:.1f} s and {size(peak)}")


def _refused(words: list[str], limit: int | None) -> tuple[int, str, float, int]:
    """Exit code, last line of stderr, time [s] and largest resident memory [bytes] of a command within an address space."""

    def narrow() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", PEAK, sys.executable, "-m", "warpsph", *words],
        capture_output=True, text=True, check=False, preexec_fn=narrow,
    )  # fmt: skip
    said = done.stderr.strip().splitlines()
    seconds = time.perf_counter() - started
    return done.returncode, said[-1] if said else "", seconds, 1024 * int(done.stdout)


def _note(found: Findings, title: str, said: int, taken: int, limits: tuple[float, float]) -> None:
    ratio = said / taken
    found.rows.append((title, size(said), size(taken), f"{ratio:.2f}"))
    if not limits[0] <= ratio <= limits[1]:
        found.failed.append(f"{title}: {ratio:.2f} of what it took; expected {limits[0]} to {limits[1]}")


def _title(case: Case) -> str:
    rows = ", rows of a GPU" if case.policy is THRIFTY else ""
    return f"`{case.scheme}`, {case.dim}D, {case.particles} particles, {case.precision}{rows}"


def _resident(name: str) -> int:
    """Resident memory of this process [bytes]: VmRSS now, VmHWM at most so far."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name))
