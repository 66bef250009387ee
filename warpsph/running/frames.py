"""The frames that a run draws of its snapshots when all steps are done."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from warpsph.errors import DiskError, Ended, InputError, RunError
from warpsph.memory import exhaustion
from warpsph.messages import output, stops
from warpsph.storage import snapshot
from warpsph.storage import summary as summaries

from .walltime import Deadline


def are_missing(out: Path) -> bool:
    """Whether a run has fewer frames than snapshots."""
    return len(list(Path(out, "frames").glob("*.png"))) < len(snapshot.find(out))


def draw(out: Path, summary: dict[str, Any], deadline: Deadline) -> None:
    """Draw a frame of every snapshot; where that cannot be done the scene has still been run, and the summary says why.

    Args:
        out: Folder of the run.
        summary: Its summary, which is on the disk; takes the warning.
        deadline: When to have ended.

    Raises:
        DiskError: A frame could not be written.
        Ended: By a signal, at once, or because the wall time is up; `warpsph resume` draws the frames later.
    """
    from warpsph.render import render

    try:
        with exhaustion.told():
            render(out, on_frame=_watch(deadline))
    except Ended as ended:
        raise stops.undrawn(ended, out) from None
    except DiskError as error:
        raise output.no_frames(error, out) from error
    except (RunError, InputError) as error:
        line = f"no frames: {error}"
        if line not in summary["warnings"]:  # of a run that was done before
            summary["warnings"].append(line)
            summaries.write(out, summary)


def _watch(deadline: Deadline) -> Callable[[], None]:
    """What is called before each frame: measures the last one, and ends the drawing in time."""
    marks: list[float] = []

    def on_frame() -> None:
        now = time.monotonic()
        if marks:
            deadline.batch(now - marks[-1])
        marks.append(now)
        if deadline.is_near():
            raise stops.time_is_up()

    return on_frame
