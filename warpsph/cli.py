"""The command line: ``warpsph COMMAND``, and the same options for a scene that is run as a script."""

import contextlib
import inspect
import math
import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

from cyclopts import App, CycloptsError, Group, Parameter, UnusedCliTokensError

from . import __version__, library
from .errors import DiskError, Ended, InputError, RunError
from .library import SceneFile
from .memory import exhaustion
from .messages import machine, output, scripts, values
from .messages.values import printable
from .progress import Progress, quiet_warp
from .running import streams
from .running import walltime as wall
from .running.signals import listening
from .storage import folder as output_folder

INPUT, STOPPED, DISK, INTERRUPTED = 2, 3, 4, 130
"""Exit codes besides 0: bad input, a run that had to stop, output that could not be written, Ctrl-C; `Ended` has its own."""

SIGNALLED = (INTERRUPTED, 143)
"""Exit codes of what a signal has ended."""

POSITIONAL, KEYWORD = inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.KEYWORD_ONLY
"""Kinds of parameters in a signature."""

SceneName = Annotated[
    str, Parameter(help="A bundled scene by name (see `warpsph scenes`) or the path of a .py file.")
]
"""The argument that names a scene."""

Flag = Annotated[bool, Parameter(negative="")]
"""An option without a value and without a ``--no-`` form."""


def main(tokens: Sequence[str] | None = None) -> None:
    """Run a command and exit.

    Codes: 0 done, 2 bad input, 3 run stopped, 4 output not written, 5 wall time up, 130 SIGINT, 143 SIGTERM.

    Args:
        tokens: Words after ``warpsph``; those of the process by default.
    """
    tokens = list(sys.argv[1:] if tokens is None else tokens)
    _exit(_exit_code(lambda: _app(tokens), tokens))


def run_file(path: str) -> None:
    """Run a scene file as a script and exit; its command line is that of ``warpsph run`` without the scene's name.

    Args:
        path: ``__file__`` of the scene.
    """
    tokens = sys.argv[1:]

    def make() -> App:
        file = library.load(path)
        return _new_app(Path(path).name, "", default_command=_run_command(file, script=True))

    _exit(_exit_code(make, tokens))


def _exit_code(make: Callable[[], App], tokens: list[str]) -> int:
    """Run an application and empty the streams; every expected failure becomes one line on stderr and its exit code."""
    streams.fill()
    code = _attempt(make, tokens)
    lost = streams.empty()
    if lost is not None and not code:
        code = _complain(output.unwritten("standard output", lost), DISK)
        streams.empty()
    return code


def _attempt(make: Callable[[], App], tokens: list[str]) -> int:
    """Run an application; gives its exit code."""
    try:
        with listening(final=True), exhaustion.told():
            make()(tokens, exit_on_error=False, print_error=False, verbose=False)
    except UnusedCliTokensError as error:
        return _complain(f"unexpected argument {(error.unused_tokens or ['?'])[0]!r}", INPUT)
    except (CycloptsError, InputError) as error:
        return _complain(error, INPUT)
    except BrokenPipeError:  # whoever read the output has left
        return 0
    except OSError as error:
        if output.is_by_name(error):
            return _complain(f"{error.filename}: {error.strerror}", INPUT)
        return _complain(output.unwritten(error.filename or "standard output", error), DISK)
    except DiskError as error:
        return _complain(error, DISK)
    except RunError as error:
        return _complain(error, STOPPED)
    except Ended as ended:
        return _complain(ended, ended.code)
    except KeyboardInterrupt:
        return _complain("interrupted", INTERRUPTED)
    return 0


def _exit(code: int) -> NoReturn:
    """Exit; after a signal without waiting for threads that still compile, as the interpreter would."""
    others = (thread for thread in threading.enumerate() if thread is not threading.main_thread())
    if code in SIGNALLED and not all(thread.daemon for thread in others):
        os._exit(code)  # the streams are empty
    sys.exit(code)


def _complain(problem: object, code: int) -> int:
    """Print one line, whatever the message holds."""
    print("warpsph:", printable(" ".join(str(problem).split())), file=streams.Dropping(sys.stderr))
    return code


def _new_app(name: str, text: str, **settings: Any) -> App:
    """Make an application with this program's habits."""
    return App(
        name=name, help=text, version=__version__, help_format="plaintext", result_action="return_none",
        suppress_keyboard_interrupt=False, default_parameter=Parameter(negative_iterable=""), **settings,
    )  # fmt: skip


def _app(tokens: list[str]) -> App:
    """Make the application; ``run`` gets the parameters of the scene that the tokens name."""
    app = _new_app(
        "warpsph", "Smoothed particle hydrodynamics of high-velocity impact, on NVIDIA Warp kernels."
    )
    app.command(_run_command(_scene_in(tokens)), name="run")
    for command in (resume, render, info, plot, materials, scenes, validate, bench, compare):
        app.command(command)
    return app


def _scene_in(tokens: list[str]) -> SceneFile | None:
    """Load the scene that a ``run`` names: the first word that is one, else the first word, to complain about."""
    words = [token for token in tokens[1:] if not token.startswith("-")]
    if tokens[:1] != ["run"] or not words:
        return None
    return library.load(next(filter(library.exists, words), words[0]))


def _run_command(file: SceneFile | None, *, script: bool = False) -> Callable:
    """Make `run` with the parameters of a scene as options; a script has no argument that names the scene."""
    entries = [] if script else [inspect.Parameter("scene", POSITIONAL, annotation=SceneName)]
    entries += list(inspect.signature(run).parameters.values())[1:-1]
    reserved = {entry.name for entry in entries} | {"scene", "help", "version"}
    group = Group("Parameters of the scene", sort_key=1)
    for p in file.parameters.values() if file else ():
        if p.name in reserved:
            raise scripts.reserved(file.path, p.name)
        hint = Annotated[p.annotation, Parameter(help=p.help, group=group)]
        entries.append(inspect.Parameter(p.name, KEYWORD, default=p.default, annotation=hint))

    def command(_scene: str = "", /, **options):
        run(file, **options)

    command.__signature__ = inspect.Signature(entries)
    command.__doc__ = run.__doc__
    if file:
        command.__doc__ = f"Run {file.name}: {file.summary}\n" + run.__doc__.partition("\n")[2]
    return command


def run(
    file: SceneFile,
    /,
    *,
    out: Path | None = None,
    device: str = "cpu",
    precision: Literal["float64", "float32", "mixed"] = "float64",
    until: float | None = None,
    energy_limit: float | None = None,
    on_trouble: Literal["stop", "warn"] | None = None,
    threads: int | None = None,
    force: Flag = False,
    frames: bool = True,
    walltime: str | None = None,
    **parameters: Any,
) -> None:
    """Run a scene; `warpsph run SCENE --help` shows the scene's own parameters too.

    Args:
        file: The scene.
        out: Folder for the results; runs/SCENE if not given.
        device: Where to compute: cpu, or cuda:0, cuda:1, ...
        precision: Arithmetic of the particles; mixed: positions in float64, the rest in float32.
        until: Time to stop at [s], in place of the scene's.
        energy_limit: Largest energy error before the run stops or warns.
        on_trouble: What all guards do, in place of what the scene says: end the run, or warn and go on.
        threads: CPU threads; all cores if not given.
        force: Replace what an earlier run left in the folder.
        frames: Render a picture for each snapshot.
        walltime: Wall time after which to stop with a checkpoint on the disk: 3600 [s], 45:00, 2:30:00 or 1-12:00:00.
        **parameters: Those of the scene.
    """
    out = out or Path("runs", file.name)
    _check_limits(until, threads)
    limit = _limit(walltime)
    output_folder.check(out, force)
    with _reporting(device) as progress:
        from .run import run as run_scene

        scene = file.build(**parameters)
        values = {name: p.default for name, p in file.parameters.items()} | parameters
        summary = run_scene(
            scene, out, device=device, precision=precision, threads=threads, until=until, force=force,
            energy_limit=energy_limit, on_trouble=on_trouble, parameters=values, source=file.source, frames=frames, progress=progress, walltime=_left(limit),
        )  # fmt: skip
    _print_summary(summary, out)


def resume(
    folder: Path,
    /,
    *,
    until: float | None = None,
    energy_limit: float | None = None,
    on_trouble: Literal["stop", "warn"] | None = None,
    device: str | None = None,
    precision: Literal["float64", "float32", "mixed"] | None = None,
    threads: int | None = None,
    frames: bool | None = None,
    walltime: str | None = None,
) -> None:
    """Go on with a run from its last checkpoint.

    Args:
        folder: Folder of the run.
        until: New time to stop at [s]; that of the run if not given.
        energy_limit: Largest energy error before the run stops or warns; as before if not given.
        on_trouble: What all guards do from here on: end the run, or warn and go on; as before if not given.
        device: Where to compute; as before if not given.
        precision: Arithmetic of the particles; as before if not given.
        threads: CPU threads; all cores if not given.
        frames: Render a picture for each snapshot; as the run was told if not given.
        walltime: Wall time after which to stop with a checkpoint on the disk: 3600 [s], 45:00, 2:30:00 or 1-12:00:00.
    """
    _check_limits(until, threads)
    limit = _limit(walltime)
    output_folder.check_run(folder)
    with _reporting(device) as progress:
        from .run import resume as resume_run

        summary = resume_run(
            folder, until=until, energy_limit=energy_limit, on_trouble=on_trouble, threads=threads, device=device,
            precision=precision, frames=frames, progress=progress, walltime=_left(limit),
        )  # fmt: skip
    _print_summary(summary, folder)


def render(
    folder: Path,
    /,
    *,
    field: str = "pressure",
    view: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    cut: str | None = None,
    range: tuple[float, float] | None = None,
    every: int = 1,
    output: Path | None = None,
    movie: Path | None = None,
    size: tuple[int, int] = (1280, 960),
    cmap: str | None = None,
) -> None:
    """Make pictures, and a movie if you like, of the snapshots of a run.

    Args:
        folder: Folder of a run.
        field: What gives the colour: any quantity that `warpsph info` lists, such as kernel_type.
        view: Where to look from: xy in 2D; iso (obliquely), x, -x, y, -y, z, -z, xy, xz or yz in 3D.
        cut: Plane in 3D; the half towards the camera is left out: y, or y=0.01 [m]. Seen straight on if no view is given.
        range: Lowest and highest value of the colours; from the data if not given.
        every: Take every n-th snapshot.
        output: Folder of the pictures; frames in the run's folder if not given.
        movie: Movie to write as well, .mp4.
        size: Width and height of the pictures [pixels].
        cmap: Colour map of matplotlib, such as viridis; one that suits the values if not given.
    """
    from .render import render as draw

    files = draw(
        folder, field=field, view=view, cut=cut, range=range, every=every, output=output, movie=movie,
        size=size, cmap=cmap,
    )  # fmt: skip
    print("\n".join(map(str, files)))


def info(path: Path, /) -> None:
    """Describe a run (its summary), a snapshot (bodies, time, range of every quantity) or a checkpoint.

    Args:
        path: Folder of a run, a .vtkhdf file, or a checkpoint .h5.
    """
    from .info import describe

    print(describe(path))


def plot(folder: Path, /, *, output: Path | None = None) -> None:
    """Plot energy, momentum and the scene's measures against time.

    Args:
        folder: Folder of a run.
        output: Picture to write, .png, .svg or .pdf; plot.png in the folder if not given.
    """
    from .plot import plot as draw

    print(draw(folder, output))


def materials(name: str | None = None, /) -> None:
    """List the materials of the library, or describe one.

    Args:
        name: Material to describe.
    """
    from .info import table
    from .materials import get, names

    if name is not None:
        print(get(name).describe())
        return
    rows = []
    for material in map(get, names()):
        laws = material.eos.title, material.strength.title
        rows.append((material.name, f"{material.density:g}", *laws))
    print(table(rows, ("material", "density [kg/m^3]", "equation of state", "strength")))


def scenes(name: str | None = None, /) -> None:
    """List the bundled scenes, or describe one with its parameters.

    Args:
        name: Scene to describe: a bundled one or the path of a .py file.
    """
    from .info import table

    if name is None:
        print(
            table([(file.name, file.summary) for file in map(library.load, library.names())], ("scene", ""))
        )
        return
    file = library.load(name)
    rows = [
        (f"--{p.name.replace('_', '-')}", str(p.default), p.kind, p.help) for p in file.parameters.values()
    ]
    print(f"{file.name}: {file.summary}\n{file.path}")
    print("\n" + table(rows, ("parameter", "default", "allowed", "")) if rows else "It has no parameters.")


def validate(case: str | None = None, /, *, out: Path = Path("runs/validation"), device: str = "cpu") -> None:
    """Run a validation case and compare its measures with the published ones.

    Args:
        case: Scene to validate; all that have a case if not given.
        out: Folder for the runs and the report; replaces what an earlier validation left there.
        device: Where to compute: cpu, or cuda:0, cuda:1, ...
    """
    with _reporting(device) as progress:
        from .quality.validate import validate as compare

        compare(case, out, device=device, progress=progress)


def bench(
    *cases: str,
    device: str = "cpu",
    precision: list[str] | None = None,
    particles: Annotated[list[int] | None, Parameter(name=["--particles", "-n"])] = None,
    threads: int | None = None,
    json: Path | None = None,
) -> None:
    """Measure what a step costs on this machine: rates, memory, time and traffic of each kernel.

    Args:
        cases: eulerian, eulerian-mixed, tl, adaptle, ts2 and pm on a block of particles (2D and 3D; -2d or -3d takes
            one), hvi_2d and debris_3d as they are; all if none is given.
        device: Where to compute: cpu, or cuda:0, cuda:1, ...
        precision: Arithmetic of the particles; may be given several times. float64 and float32 if not given.
        particles: Particles of the block; may be given several times. 30000 on a CPU, 1000000 and 10000000 on CUDA if
            not given.
        threads: CPU threads; all cores if not given.
        json: File for everything that was measured.
    """
    _check_limits(None, threads)
    with _reporting(device) as progress:
        from .quality.bench import bench as measure

        print(
            measure(
                cases,
                device,
                precisions=precision,
                sizes=particles,
                threads=threads,
                json=json,
                progress=progress,
            )
        )


def compare(
    *,
    device: str = "cpu",
    peer: list[str] | None = None,
    full: Flag = False,
    lagrangian: Flag = False,
    repeats: int = 5,
) -> None:
    """Measure the steps of a two-dimensional impact beside those of other codes, and what each scheme costs.

    Args:
        device: Where to compute: cpu, or cuda:0, cuda:1, ...
        peer: Command of another code to measure in turn, which prints JSON with ns_per_particle_step and threads in
            its last line; may be given several times.
        full: Measure the whole 8 µs too, once.
        lagrangian: Measure Total Lagrangian and coupled steps on the plate of debris_3d instead; a peer's JSON then
            names its case, plate or taylor.
        repeats: Repetitions of every measurement.
    """
    with _reporting(device) as progress:
        from .quality.compare import compare as measure

        print(
            measure(
                device, peers=peer or (), full=full, lagrangian=lagrangian, repeats=repeats, progress=progress
            )
        )


@contextlib.contextmanager
def _reporting(device: str | None) -> Iterator[Progress]:
    """Start Warp quietly, check the device, and report progress until the end."""
    progress = Progress()
    with quiet_warp(progress) as said:
        _check_device(device or "cpu", said)
        try:
            yield progress
        finally:
            progress.stop()


def _check_device(device: str, said: str) -> None:
    """Check that a device exists.

    Raises:
        InputError: If not; adds what Warp ``said`` about the drivers.
    """
    from .device.launch import find_device

    try:
        find_device(device)
    except InputError as error:
        raise machine.no_device(error, said) from None


def _check_limits(until: float | None, threads: int | None) -> None:
    """Check the numbers that every run takes.

    Raises:
        InputError: Naming the option, its value and what is allowed.
    """
    if until is not None and not 0.0 < until < math.inf:
        raise values.refuse("--until", until, "a positive time [s]")
    if threads is not None and threads < 1:
        raise values.outside("--threads", threads, "1 or more")


def _limit(walltime: str | None) -> float | None:
    """Read the wall time of this process [s]."""
    return None if walltime is None else wall.parse(walltime)


def _left(limit: float | None) -> float | None:
    """What is left now of a limit that counts from the start of this process [s]."""
    return None if limit is None else max(limit - wall.age(), 0.0)


def _print_summary(summary: dict[str, Any], out: Path) -> None:
    """Print the outcome of a run."""
    from .info import describe_summary

    print(describe_summary(summary))
    print(f"results in {out}")
