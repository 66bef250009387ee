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
    "time": facts.not_negative, "until": facts.positive, "row_time": facts.finite, "device": facts.text, "precision": facts.text,
    "device_name": facts.text, "version": facts.text, "warp": facts.text, "solver": facts.record, "balance": facts.record,
    "parameters": facts.record, "job": facts.record,
}  # fmt: skip
"""Facts of a checkpoint that a run goes on from, and what they have to be."""

OF_JOB = {
    "interval": facts.positive, "row_interval": facts.positive, "ends": facts.numbers, "due": facts.natural,
    "next_snapshot": facts.natural, "next_row": facts.not_negative, "neighbours": facts.numbers, "peaks": facts.record,
    "remarks": facts.texts, "wall": facts.not_negative, "step_wall": facts.not_negative,
}  # fmt: skip
"""Those of its `Job`."""

SHORTEST = 1e-9
"""Shortest interval of outputs, as a share of the end time."""


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
    precision: str | None = None,
    frames: bool = True,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Go on with the run in a folder from its newest whole checkpoint, bit for bit as if it had not stopped there.

    On another device or in another precision it goes on too, and says that it is no longer bit for bit.

    Args:
        out: Folder of the run.
        until: New end time [s]; the run's own by default.
        threads: CPU threads; all cores by default.
        device: Another device than the run's.
        precision: Another precision than the run's.
        frames: Draw a frame of every snapshot at the end.
        progress: Where progress goes.

    Raises:
        InputError: The folder holds no run that can go on, or it has already ended.
        RunError: The run had to stop; a last snapshot has been written.
        KeyboardInterrupt: After a clean ending on Ctrl-C.
    """
    from .library import load

    out = Path(out)
    source = out / "scene.py"
    found = checkpoint.load_newest(out)
    info = found.info
    _check(found)
    if not source.is_file():
        raise files.no_checkpoint(out, source.name)
    if checkpoint.digest(source) != info["scene_sha256"]:
        raise files.scene_changed(source)
    end = info["until"] if until is None else until
    if info["time"] >= end:
        raise InputError(
            f"until = {end:g} s is not after the checkpoint's time; allowed: more than {info['time']:g}"
        )
    data = load(source).build(**info["parameters"]).finalize()
    progress = progress or Progress()
    solver = Solver(
        data, device=device or info["device"], precision=precision or info["precision"], threads=threads,
        copies=PENDING, say=progress.message,
    )  # fmt: skip
    job = Job(solver, out, end, info["parameters"], progress)
    try:
        job.go_on(found)
    except (LookupError, TypeError, AttributeError, OverflowError) as error:
        raise files.damaged(found.path, checkpoint.FORM, error) from error
    return job.finish(frames)


def _check(found: checkpoint.Found) -> None:
    """Check the facts of a checkpoint that a run goes on from.

    Raises:
        InputError: If one is missing or of a wrong type.
    """
    try:
        facts.check(found.info, NEEDED)
        facts.check(found.info["job"], OF_JOB)
        if found.info["job"].keys() != OF_JOB.keys():
            raise ValueError("its job has facts that no job has")
        if (
            min(found.info["job"]["interval"], found.info["job"]["row_interval"])
            < SHORTEST * found.info["until"]
        ):
            raise ValueError("its outputs have no end")
    except ValueError as error:
        raise files.damaged(found.path, checkpoint.FORM, error) from None
