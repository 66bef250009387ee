"""Run a scene into a folder, or go on with a run."""

from pathlib import Path
from typing import Any

from . import footprint
from .errors import InputError
from .guards import Action
from .job import Job
from .messages import files
from .progress import Progress
from .scene import Scene
from .solver import Solver
from .storage import atomic, checkpoint, folder
from .storage.writer import PENDING


def run(
    scene: Scene,
    out: Path,
    *,
    device: str = "cpu",
    precision: str = "float64",
    threads: int | None = None,
    until: float | None = None,
    energy_limit: float | None = None,
    on_trouble: Action | None = None,
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
        energy_limit: Limit of the energy error, in place of the scene's guards'.
        on_trouble: What all guards do, in place of what the scene says.
        force: Clear an earlier run's files from ``out``.
        parameters: Scene parameters, for the summary and for `resume`.
        source: Text of the scene file, for `resume`.
        frames: Draw a frame of every snapshot at the end.
        progress: Where progress goes.

    Raises:
        InputError: Bad input; nothing has been written.
        RunError: The run had to stop; a last snapshot has been written.
        DiskError: Output could not be written; what was written before is whole.
        KeyboardInterrupt: After a clean ending on Ctrl-C.
    """
    progress = progress or Progress()
    data = scene.finalize()
    solver = Solver(
        data, device=device, precision=precision, threads=threads, copies=PENDING, say=progress.message
    )
    solver.watch.change(energy_limit, on_trouble)
    out = Path(out)
    if warning := footprint.check(out, solver, data.snapshots + 1):
        progress.message(warning)
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
    energy_limit: float | None = None,
    on_trouble: Action | None = None,
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
        energy_limit: Another limit of the energy error from now on.
        on_trouble: What all guards do from now on, in place of what they did.
        threads: CPU threads; all cores by default.
        device: Another device than the run's.
        precision: Another precision than the run's.
        frames: Draw a frame of every snapshot at the end.
        progress: Where progress goes.

    Raises:
        InputError: The folder holds no run that can go on, or is past ``until``.
        RunError: The run had to stop; a last snapshot has been written.
        DiskError: Output could not be written; what was written before is whole.
        KeyboardInterrupt: After a clean ending on Ctrl-C.
    """
    from .library import load

    out = Path(out)
    source = out / "scene.py"
    found = checkpoint.load_newest(out)
    info = found.info
    if not source.is_file():
        raise files.no_checkpoint(out, source.name)
    if checkpoint.digest(source) != info["scene_sha256"]:
        raise files.scene_changed(source)
    end = info["until"] if until is None else until
    if info["time"] > end:
        raise InputError(
            f"until = {end:g} s is before the checkpoint's time; allowed: {info['time']:g} or more"
        )
    data = load(source).build(**info["parameters"]).finalize()
    progress = progress or Progress()
    solver = Solver(
        data, device=device or info["device"], precision=precision or info["precision"], threads=threads,
        copies=PENDING, say=progress.message,
    )  # fmt: skip
    job = Job(solver, out, end, info["parameters"], progress)
    job.go_on(found)
    solver.watch.change(energy_limit, on_trouble)
    return job.finish(frames)
