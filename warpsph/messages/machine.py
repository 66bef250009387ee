"""Devices, memory and libraries that a run asks for in vain: what is there, and what would do."""

from collections.abc import Sequence

from warpsph.errors import InputError, RunError

BEYOND = 1e24
"""Particles from which on nobody wants to know the number."""

PREFIXES = ("", "k", "M", "G", "T", "P", "E")
"""SI prefixes of bytes."""


def no_room(need: str, place: str, free: int, fits: Sequence[str]) -> InputError:
    """A run needs more memory than there is.

    Args:
        need: The particles and what they need.
        place: Where they need it.
        free: Bytes that are free there.
        fits: What would fit.
    """
    return InputError(f"{need} on {place}, where {size(free)} are free; allowed: {', or '.join(fits)}")


def too_fine(
    spacing: float, what: str, points: float, need: float, free: int | None, fits: str
) -> InputError:
    """A lattice has more points than there is memory for, or numbers for particles.

    Args:
        spacing: Its spacing [m].
        what: What is filled with it.
        points: Number of points.
        need: Bytes that building them takes.
        free: Bytes that are free; None where nothing tells.
        fits: What would be allowed.
    """
    left = "" if free is None else f", {size(free)} are free"
    count = f"about {points:.2g}" if points < BEYOND else f"more than {BEYOND:.0e}"
    takes = f"building them takes {size(need)}"
    return InputError(
        f"spacing = {spacing:g} m of {what} gives {count} particles; {takes}{left}; allowed: {fits}"
    )


def used_up(what: str, need: int, place: str, free: int | None) -> RunError:
    """Memory that a run asks for on its way is not there.

    Args:
        what: What it is for.
        need: Bytes asked for.
        place: Where.
        free: Bytes that are free there; None where nothing tells.
    """
    left = "" if free is None else f", where {size(free)} are free"
    return RunError(
        f"no memory for {what}: {size(need)} needed on {place}{left}; "
        "run it with more memory, fewer particles or in single precision"
    )


def out_of_memory(reason: str) -> RunError:
    """Memory has run out; the reason is what the library says that asked for it."""
    return RunError(
        f"out of memory{f' ({reason})' if reason else ''}; run it with more memory, fewer particles or in single precision"
    )


def device_failed(reason: str) -> RunError:
    """A GPU has failed, for whatever reason; the reason is what Warp says."""
    return RunError(f"the GPU has failed ({reason}); a run goes on from its checkpoint with `warpsph resume`")


def size(count: float) -> str:
    """Bytes for people: ``38.2 MB``."""
    if count >= 1e21:
        return "more than 1000 EB"
    power = 0
    while count >= 999.5 and power < len(PREFIXES) - 1:
        count, power = count / 1000.0, power + 1
    return f"{count:.3g} {PREFIXES[power]}B"


def no_device(error: InputError, said: str) -> InputError:
    """A device is not there; ``said``: what Warp said about the drivers, if anything."""
    return InputError(f"{error} ({said})" if said else str(error))


def no_package(what: str, package: str, extra: str) -> InputError:
    """Something needs a package that is not installed."""
    return InputError(f'{what} needs the package {package}; install it with: pip install "warpsph[{extra}]"')


def no_film(reason: str) -> RunError:
    """The encoder of films failed, and not for lack of room."""
    return RunError(f"no film could be made: {reason}")


def no_drawing() -> RunError:
    """There is no OpenGL."""
    return RunError(
        "this machine cannot draw off screen: OpenGL is missing; install Mesa (apt install libegl1)"
    )
