"""Run a scene into a folder, or go on with a run."""

from pathlib import Path
from typing import Any

from .errors import InputError
from .guards import Action
from .messages import files, restarts, stops
from .progress import Progress
from .running import footprint, origin
from .running import frames as drawn
from .running.job import Job
from .running.signals import Stop, listening
from .running.walltime import Deadline
from .scene import Scene
from .solver import Solver
from .storage import atomic, checkpoint, folder, lock
from .storage import summary as summaries
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
    walltime: float | None = None,
) -> dict[str, Any]:
    """Run a scene into a folder and give its summary.

    In the main thread SIGINT and SIGTERM end the run after the steps it is taking, a second one then without another
    line written; their handlers are then put back. One run at a time in a process: Warp records launches for all of it.

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
        walltime: Wall time until which the run has to be over, counted from now [s]; no limit by default.

    Raises:
        InputError: Bad input; nothing has been written.
        RunError: The run had to stop; a last snapshot has been written.
        DiskError: Output could not be written; what was written before is whole.
        Ended: By SIGINT, SIGTERM, or because the wall time is up; `resume` goes on.
    """
    out, deadline, progress = Path(out), Deadline(walltime), progress or Progress()
    with listening() as stop:
        data = scene.finalize()
        folder.check(out, force)
        with lock.held(out, progress.message):
            solver = Solver(
                data,
                device=device,
                precision=precision,
                threads=threads,
                copies=PENDING,
                say=progress.message,
            )
            solver.watch.change(energy_limit, on_trouble)
            if warning := footprint.check(out, solver, data.snapshots + 1):
                progress.message(warning)
            folder.prepare(out, force)
            if source is not None:
                atomic.write(out / "scene.py", source.encode())
            end = data.until if until is None else until
            job = Job(solver, out, end, parameters or {}, progress, stop, deadline, frames)
            with stop.patience():
                job.begin()
                summary = job.finish()
            return _with_frames(out, summary, frames, stop, deadline)


def resume(
    out: Path,
    *,
    until: float | None = None,
    energy_limit: float | None = None,
    on_trouble: Action | None = None,
    threads: int | None = None,
    device: str | None = None,
    precision: str | None = None,
    frames: bool | None = None,
    progress: Progress | None = None,
    walltime: float | None = None,
) -> dict[str, Any]:
    """Go on with the run in a folder from its newest whole checkpoint, bit for bit as if it had not stopped there.

    A run that is done is left as it is; if it was ended while frames were drawn, they are. Signals are taken as by `run`.
    On another device or in another precision it goes on too, and says that it is no longer bit for bit.

    Args:
        out: Folder of the run.
        until: New end time [s]; the run's own by default.
        energy_limit: Another limit of the energy error from now on.
        on_trouble: What all guards do from now on, in place of what they did.
        threads: CPU threads; all cores by default.
        device: Another device than the run's.
        precision: Another precision than the run's.
        frames: Draw a frame of every snapshot at the end; as the run was told by default.
        progress: Where progress goes.
        walltime: Wall time until which the run has to be over, counted from now [s]; no limit by default.

    Raises:
        InputError: The folder holds no run that can go on or is in use, or the run is past ``until``.
        RunError: The run had to stop; a last snapshot has been written.
        DiskError: Output could not be written; what was written before is whole.
        Ended: By SIGINT, SIGTERM, or because the wall time is up; `resume` goes on.
    """
    from .library import load

    out, deadline, progress = Path(out), Deadline(walltime), progress or Progress()
    folder.check_run(out)
    with listening() as stop, lock.held(out, progress.message):
        folder.tidy(out)
        source = out / "scene.py"
        found = origin.checked(checkpoint.load_newest(out))
        info = found.info
        if checkpoint.digest(source) != info["scene_sha256"]:
            raise restarts.scene_changed(source)
        end = info["until"] if until is None else until
        if info["time"] > end:
            raise restarts.too_early(end, info["time"])
        frames = info["frames"] if frames is None else frames
        summary = _summary_of_the_end(out) if info["time"] == end else None
        if summary is not None:
            progress.message(stops.already_done(out, end))
            return _with_frames(out, summary, frames and drawn.are_missing(out), stop, deadline)
        data = load(source).build(**info["parameters"]).finalize()
        solver = Solver(
            data, device=device or info["device"], precision=precision or info["precision"], threads=threads,
            copies=PENDING, say=progress.message,
        )  # fmt: skip
        job = Job(solver, out, end, info["parameters"], progress, stop, deadline, frames)
        with stop.patience():
            try:
                job.go_on(found)
            except (LookupError, TypeError, AttributeError, OverflowError) as error:
                raise files.damaged(found.path, checkpoint.FORM, error) from error
            del found, info  # a copy of the state, which memory was not asked for
            solver.watch.change(energy_limit, on_trouble)
            summary = job.finish()
        return _with_frames(out, summary, frames, stop, deadline)


def _summary_of_the_end(out: Path) -> dict[str, Any] | None:
    """The summary of a run that is done; None if it was ended before it was written, or it cannot be read."""
    try:
        summary = summaries.read(out / summaries.NAME)
    except InputError:
        return None
    return summary if summary.get("outcome") == "done" else None


def _with_frames(
    out: Path, summary: dict[str, Any], frames: bool, stop: Stop, deadline: Deadline
) -> dict[str, Any]:
    """Draw the frames, if they are wanted and nobody has asked for an end meanwhile; gives the summary."""
    if frames and stop.asked:
        raise stops.undrawn(stop.asked, out)
    if frames:
        drawn.draw(out, summary, deadline)
    return summary
