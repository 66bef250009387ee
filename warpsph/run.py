"""Run a scene into a folder, or go on with a run."""

from pathlib import Path
from typing import Any

from .errors import InputError
from .job import Job
from .messages import files
from .progress import Progress
from .scene import Scene
from .solver import Solver
from .storage import atomic, checkpoint, facts, folder
from .storage.writer import PENDING

NEEDED = {
    "time": facts.not_negative, "until": facts.positive, "interval": facts.positive, "next_snapshot": facts.natural,
    "next_row": facts.not_negative, "wall": facts.not_negative, "step_wall": facts.not_negative, "device": facts.text,
    "solver": facts.record, "balance": facts.record, "parameters": facts.record, "peaks": facts.record,
    "neighbours": facts.numbers,
}  # fmt: skip
"""Facts of a checkpoint that a run goes on from, and what they have to be."""


def run(
    scene: Scene,
    out: Path,
    *,
    device: str = "cpu",
    precision: str = "float64",
    threads: int | None = None,
    until: float | None = None,
    force: bool = False,
    parameters: dict[str, Any] | None = None,
    source: str | None = None,
    frames: bool = True,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run a scene into a folder and give its summary.

    Args:
        scene: The scene.
        out: Output folder; made if missing, must be empty unless ``force``.
        device: ``cpu`` or ``cuda:N``.
        precision: ``float64``, ``float32``, or ``mixed``: float32 with positions in float64.
        threads: CPU threads; all cores by default.
        until: End time [s]; the scene's own by default.
        force: Clear an earlier run's files from ``out``.
        parameters: Scene parameters, for the summary and for `resume`.
        source: Text of the scene file, for `resume`.
        frames: Draw a frame of every snapshot at the end.
        progress: Where progress goes.

    Raises:
        InputError: Bad input; nothing has been written.
        RunError: The run had to stop; a last snapshot has been written.
        KeyboardInterrupt: After a clean ending on Ctrl-C.
    """
    progress = progress or Progress()
    data = scene.finalize()
    solver = Solver(
        data, device=device, precision=precision, threads=threads, copies=PENDING, say=progress.message
    )
    out = Path(out)
    folder.prepare(out, force)
    if source is not None:
        atomic.write(out / "scene.py", source.encode())
    job = Job(solver, out, data.until if until is None else until, parameters or {}, progress)
    job.begin()
    return job.finish(frames)


def resume(
    out: Path,
    *,
    until: float | None = None,
    threads: int | None = None,
    device: str | None = None,
    frames: bool = True,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Go on with the run in a folder from its checkpoint, bit for bit as if it had not stopped there.

    Args:
        out: Folder of the run.
        until: New end time [s]; the run's own by default.
        threads: CPU threads; all cores by default.
        device: Another device than the run's.
        frames: Draw a frame of every snapshot at the end.
        progress: Where progress goes.

    Raises:
        InputError: The folder holds no run that can go on, or it has already ended.
        RunError: The run had to stop; a last snapshot has been written.
        KeyboardInterrupt: After a clean ending on Ctrl-C.
    """
    from .library import load

    out = Path(out)
    for name in ("checkpoint.h5", "scene.py"):
        if not (out / name).is_file():
            raise InputError(f"{out} cannot be resumed: {name} is missing; allowed: the folder of a run")
    arrays, info = checkpoint.load(out / "checkpoint.h5")
    _check(out, info)
    end = info["until"] if until is None else until
    if info["time"] >= end:
        raise InputError(
            f"until = {end:g} s is not after the checkpoint's time; allowed: more than {info['time']:g}"
        )
    data = load(out / "scene.py").build(**info["parameters"]).finalize()
    progress = progress or Progress()
    solver = Solver(
        data, device=device or info["device"], precision=info["solver"]["precision"], threads=threads,
        copies=PENDING, say=progress.message,
    )  # fmt: skip
    job = Job(solver, out, end, info["parameters"], progress)
    try:
        job.go_on(arrays, info)
    except (LookupError, TypeError, AttributeError, OverflowError) as error:
        raise files.damaged(out / "checkpoint.h5", checkpoint.FORM, error) from error
    return job.finish(frames)


def _check(out: Path, info: dict[str, Any]) -> None:
    """Check the facts of a checkpoint that a run goes on from.

    Raises:
        InputError: If one is missing or of a wrong type.
    """
    try:
        facts.check(info, NEEDED)
        if info["next_snapshot"] * info["interval"] < (1.0 - 1e-6) * info["time"]:
            raise ValueError("its snapshots lag behind its time")
    except ValueError as error:
        raise files.damaged(out / "checkpoint.h5", checkpoint.FORM, error) from None
