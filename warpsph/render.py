"""From the snapshots of a run to pictures and films."""

import io
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from .drawing import movie as films
from .drawing.look import Look, choose
from .drawing.painter import Painter
from .messages import files, values
from .state import State
from .storage import atomic, snapshot


def render(
    folder: Path,
    *,
    field: str = "pressure",
    view: str | None = None,
    output: Path | None = None,
    range: tuple[float, float] | None = None,
    movie: Path | None = None,
    cut: str | None = None,
    size: tuple[int, int] = (1280, 960),
    every: int = 1,
    cmap: str | None = None,
    on_frame: Callable[[], None] | None = None,
) -> list[Path]:
    """Draw the snapshots of a run, all with one camera and one colour range.

    Args:
        folder: Output folder of the run.
        field: What gives the colour, see `warpsph.scalars.scalar`.
        view: Name of the view, see `warpsph.drawing.camera.VIEWS`; None for the usual one of the dimension, or
            straight on a cut.
        output: Folder for the frames ``FIELD_0000.png``, numbered as the snapshots; ``folder/frames`` if None.
        range: Lowest and highest value of the colour range [SI]; None to fit it to the sequence.
        movie: An .mp4 file to write as well.
        cut: Cut plane in 3D, ``"y"`` or ``"y=0.01"`` [m]; the half towards the camera is not drawn.
        size: Width and height [pixels].
        every: Draw every n-th snapshot only.
        cmap: A matplotlib colour map; None for one that suits the values.
        on_frame: Called before each frame; what it raises ends the drawing.

    Returns:
        The files written, in order; the film comes last.

    Raises:
        InputError: If an argument makes no sense or there are no snapshots.
        RunError: If this machine cannot draw off screen.
        DiskError: If a file cannot be written.
    """
    if every < 1:
        raise values.outside("every", every, "1, 2, 3, ...")
    paths = snapshot.find(folder)[::every]
    if not paths:
        raise files.no_snapshots(folder)
    if movie is not None:
        films.check(movie)
    states = (snapshot.read(path) for path in paths)
    look = choose(states, field=field, view=view, range=range, cut=cut, size=size, cmap=cmap)
    output = atomic.make_folder(Path(folder) / "frames" if output is None else Path(output))
    pictures = [output / f"{field}_{path.stem.rpartition('_')[2]}.png" for path in paths]
    frames = _frames(look, paths, pictures, on_frame or (lambda: None))
    if movie is None:
        for _ in frames:
            pass
        return pictures
    films.write(movie, frames, len(paths))
    return [*pictures, Path(movie)]


def frame(state: State, path: Path, look: Look) -> None:
    """Draw one state to a file.

    Args:
        state: The particles.
        path: A .png file.
        look: Camera and colours, from `warpsph.drawing.look.choose`.

    Raises:
        RunError: If this machine cannot draw off screen.
        DiskError: If the file cannot be written.
    """
    with Painter(look) as painter:
        write_png(path, painter.draw(state))


def write_png(path: Path, picture: np.ndarray) -> None:
    """Write a picture, shape [height, width, 3], uint8.

    Raises:
        DiskError: If it cannot be written.
    """
    from PIL import Image

    memory = io.BytesIO()
    Image.fromarray(picture).save(memory, format="png", compress_level=4)
    atomic.write(path, memory.getbuffer())


def _frames(
    look: Look, paths: list[Path], files: list[Path], on_frame: Callable[[], None]
) -> Iterator[np.ndarray]:
    """Draw the snapshots one by one, to their files and for the film."""
    with Painter(look) as painter:
        for path, file in zip(paths, files, strict=True):
            on_frame()
            picture = painter.draw(snapshot.read(path))
            write_png(file, picture)
            yield picture
