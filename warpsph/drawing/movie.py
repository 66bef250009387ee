"""Films of a sequence of frames."""

import importlib
import itertools
import os
import subprocess
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from warpsph.messages import machine, output, values
from warpsph.storage import atomic

SECONDS = 6.0
"""How long a film lasts if its frames suffice."""


def check(path: Path) -> None:
    """Refuse early what `write` could not do.

    Raises:
        InputError: If it is no .mp4 file, its folder is missing, or the package for films is not installed.
    """
    path = Path(path)
    if path.suffix.lower() != ".mp4":
        raise values.refuse("movie", str(path), "a name that ends in .mp4")
    if not path.parent.is_dir():
        raise values.refuse(
            "movie", str(path), f"a file in a folder that exists, which {path.parent} does not"
        )
    try:
        importlib.import_module("imageio_ffmpeg")
    except ImportError as error:
        raise machine.no_package("movie", error.name, "movie") from None


def write(path: Path, frames: Iterable[np.ndarray], count: int) -> None:
    """Write a film in H.264.

    Args:
        path: An .mp4 file; a film of that name is replaced.
        frames: Pictures of one size, shape [height, width, 3], uint8.
        count: How many there are, which sets the speed.

    Raises:
        DiskError: If the file cannot be written; an older film stays whole.
        RunError: If the film cannot be made for another reason.
    """
    path = Path(path)
    part = path.with_name(f".{path.stem}.part.mp4")
    frames = iter(frames)
    first = next(frames)
    try:
        with atomic.naming(path):
            _encode(part, itertools.chain([first], frames), first.shape, count)
            os.replace(part, path)
    finally:
        atomic.discard(part)


def _encode(part: Path, frames: Iterable[np.ndarray], shape: tuple[int, ...], count: int) -> None:
    """Let ffmpeg encode frames; sizes are rounded up to even ones, which H.264 asks for.

    Raises:
        OSError: What the system told ffmpeg.
        RunError: If ffmpeg fails for another reason.
    """
    from imageio_ffmpeg import get_ffmpeg_exe

    speed = min(max(count / SECONDS, 4.0), 30.0)
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{shape[1]}x{shape[0]}", "-r", f"{speed:.4f}"]
    coding = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "10"]
    command = [get_ffmpeg_exe(), "-y", "-v", "error", *source, "-i", "-", "-an", *coding, str(part)]
    pipe = (
        subprocess.PIPE
    )  # with Python's signals a file that is too large is an error, not the end of ffmpeg
    with subprocess.Popen(command, stdin=pipe, stderr=pipe, restore_signals=False) as film:
        try:
            for frame in frames:
                film.stdin.write(np.ascontiguousarray(frame))
        except BrokenPipeError:  # it has given up, and says why
            pass
        except BaseException:
            film.kill()
            film.communicate()
            raise
        said = film.communicate()[1].decode(errors="replace")
    for code in output.REMEDIES:
        if os.strerror(code) in said:
            raise OSError(code, os.strerror(code))
    if film.returncode:
        reason = said.strip().splitlines() or [f"exit code {film.returncode}"]
        raise machine.no_film(reason[-1])
