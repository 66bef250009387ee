"""Memory that runs out on the way: one line, whoever was refused it."""

import contextlib
from collections.abc import Iterator

from .messages import machine

WARP_SAYS = "Failed to allocate"
"""How Warp begins when a device or the host has no memory for an array."""


@contextlib.contextmanager
def told() -> Iterator[None]:
    """Let what runs out of memory in the body end as other trouble of a run does.

    Raises:
        RunError: In place of a `MemoryError` of Python and numpy, and of what Warp raises.
    """
    try:
        yield
    except MemoryError as error:
        raise machine.out_of_memory(str(error)) from error
    except RuntimeError as error:
        if not str(error).startswith(WARP_SAYS):
            raise
        raise machine.out_of_memory(str(error)) from error
