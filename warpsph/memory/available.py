"""How much memory there is to be had: what a run is held against before it allocates anything."""

import os
from collections.abc import Iterator
from pathlib import Path

import warp as wp

SYSTEM = Path("/")
"""Where Linux shows what it knows of memory."""

LIBRARIES = 400_000_000
"""Bytes of address space that kernels and libraries map once a run has begun: HDF5, VTK, stacks of threads."""

_VERSIONS = {
    "": ("sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"),
    "memory": ("sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
}  # fmt: skip
"""Control groups, the second and the first version: folder, limit, what is in use, and what of that can be had back."""


def on_device(device: wp.Device) -> int | None:
    """Bytes that can be had on a device; None where nothing tells."""
    if not device.is_cuda:
        return on_host()
    wp.synchronize_device(device)  # what was given back goes back to the driver now
    return device.free_memory


def on_host(root: Path = SYSTEM) -> int | None:
    """Bytes that this process can have from the system, within its limits; None where nothing tells.

    The least of what Linux has to give away without swapping, of what the control groups leave (containers, batch
    systems), and of the address space (``ulimit -v``).
    """
    known = [*_system(root), *_groups(root), *_address_space(root)]
    return max(min(known), 0) if known else None


def _system(root: Path) -> Iterator[int]:
    for line in _text(root / "proc/meminfo").splitlines():
        if line.startswith("MemAvailable:"):
            yield int(line.split()[1]) * 1024


def _groups(root: Path) -> Iterator[int]:
    """What each control group above this process leaves; files in the cache count as free."""
    for line in _text(root / "proc/self/cgroup").splitlines():
        _, controllers, path = line.split(":", 2)
        kinds = {"memory"} & set(controllers.split(",")) if controllers else {""}
        for folder, limit, used, cached in map(_VERSIONS.get, kinds):
            top = root / folder
            group = top / path.strip("/")
            for level in (group, *group.parents):
                most, now = _text(level / limit).strip(), _text(level / used).strip()
                if most.isdecimal() and now.isdecimal():
                    facts = dict(entry.split() for entry in _text(level / "memory.stat").splitlines())
                    yield int(most) - int(now) + int(facts.get(cached, 0))
                if level == top:
                    break


def _address_space(root: Path) -> Iterator[int]:
    try:
        import resource
    except ImportError:  # not a Unix
        return
    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    pages = _text(root / "proc/self/statm").split()
    if most != resource.RLIM_INFINITY and pages:
        yield most - int(pages[0]) * os.sysconf("SC_PAGE_SIZE") - LIBRARIES


def _text(path: Path) -> str:
    """Text of a file; nothing if it cannot be read."""
    try:
        return path.read_text()
    except (OSError, ValueError):
        return ""
