"""Memory that runs out on the way, or a device that fails: one line, whoever met with it."""

import contextlib
from collections.abc import Iterator

from warpsph.errors import RunError
from warpsph.messages import machine

SAYINGS = ("Failed to allocate", "failed to map segment", "annot allocate memory")
"""What Warp says when there is no memory for an array, and the system when there is none for a library."""

FAILURES = (
    "Failed to synchronize",
    "Warp copy error",
    "Error launching kernel:",
    "Graph launch error",
    "CUDA error",
)
"""What Warp says when a GPU has failed: wherever the host asks for something next."""


@contextlib.contextmanager
def told() -> Iterator[None]:
    """Let what runs out of memory in the body end as other trouble of a run does.

    Raises:
        RunError: In place of a `MemoryError` of Python and numpy, of what Warp raises, and of a library or a process
            that the system has no memory for; or of what Warp raises when a GPU has failed.
    """
    try:
        yield
    except RunError:
        raise
    except MemoryError as error:
        raise machine.out_of_memory(str(error)) from error
    except (RuntimeError, ImportError, OSError) as error:
        if any(saying in str(error) for saying in FAILURES):
            raise machine.device_failed(str(error)) from error
        if not any(saying in str(error) for saying in SAYINGS):
            raise
        raise machine.out_of_memory(str(error)) from error
