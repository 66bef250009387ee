"""Films of a sequence of frames."""

import importlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from warpsph.errors import RunError
from warpsph.messages import machine, values

SECONDS = 6.0
"""How long a film lasts if its frames suffice."""


def check(path: Path) -> None:
    """Refuse early what `write` could not do.

    Raises:
        InputError: If it is no .mp4 file, its folder is missing, or the packages for films are not installed.
    """
    path = Path(path)
    if path.suffix.lower() != ".mp4":
        raise values.refuse("movie", str(path), "a name that ends in .mp4")
    if not path.parent.is_dir():
        raise values.refuse(
            "movie", str(path), f"a file in a folder that exists, which {path.parent} does not"
        )
    try:
        for package in ("imageio", "imageio_ffmpeg"):
            importlib.import_module(package)
    except ImportError as error:
        raise machine.no_package("movie", error.name, "movie") from None


def write(path: Path, frames: Iterable[np.ndarray], count: int) -> None:
    """Write a film in H.264.

    Args:
        path: An .mp4 file; a film of that name is replaced.
        frames: Pictures of one size, shape [height, width, 3], uint8.
        count: How many there are, which sets the speed.

    Raises:
        RunError: If the file cannot be written.
    """
    import imageio.v2

    path = Path(path)
    speed = min(max(count / SECONDS, 4.0), 30.0)
    part = path.with_name(f".{path.stem}.part.mp4")
    try:
        with imageio.v2.get_writer(
            part, fps=speed, quality=8, macro_block_size=2, ffmpeg_log_level="error"
        ) as film:
            for frame in frames:
                film.append_data(frame)
        part.replace(path)
    except OSError as error:
        raise RunError(
            f"{path} could not be written: {error.strerror or str(error).splitlines()[0]}"
        ) from error
    finally:
        part.unlink(missing_ok=True)
