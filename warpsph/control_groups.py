"""Control groups of Linux, by which containers and batch systems give a process its share of a machine."""

from collections.abc import Iterator
from pathlib import Path

SYSTEM = Path("/")
"""Where Linux shows what it knows."""


def levels(controller: str, root: Path = SYSTEM) -> Iterator[tuple[int, Path]]:
    """Version (1 or 2) and folder of each group that this process is in, from its own up, for ``memory`` or ``cpu``."""
    for line in text(root / "proc/self/cgroup").splitlines():
        _, controllers, path = line.split(":", 2)
        if not controllers:
            version, top = 2, root / "sys/fs/cgroup"
        elif controller in controllers.split(","):
            version, top = 1, root / "sys/fs/cgroup" / controller
        else:
            continue
        group = top / path.strip("/")
        for level in (group, *group.parents):
            yield version, level
            if level == top:
                break


def text(path: Path) -> str:
    """Text of a file; nothing if it cannot be read."""
    try:
        return path.read_text()
    except (OSError, ValueError):
        return ""
