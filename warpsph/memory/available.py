"""How much memory there is to be had: what a run is held against before it allocates anything."""

import os
from collections.abc import Iterator
from pathlib import Path

import warp as wp

from warpsph.control_groups import SYSTEM, levels, text

LIBRARIES = 400_000_000
"""Bytes of address space that kernels and libraries map once a run has begun: HDF5, VTK, stacks of threads."""

_FILES = {
    2: ("memory.max", "memory.current", "inactive_file"),
    1: ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
}
"""Control groups by version: limit, what is in use, and what of that can be had back."""


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
    for line in text(root / "proc/meminfo").splitlines():
        if line.startswith("MemAvailable:"):
            yield int(line.split()[1]) * 1024


def _groups(root: Path) -> Iterator[int]:
    """What each control group above this process leaves; files in the cache count as free."""
    for version, group in levels("memory", root):
        limit, used, cached = _FILES[version]
        most, now = text(group / limit).strip(), text(group / used).strip()
        if most.isdecimal() and now.isdecimal():
            facts = dict(entry.split() for entry in text(group / "memory.stat").splitlines())
            yield int(most) - int(now) + int(facts.get(cached, 0))


def _address_space(root: Path) -> Iterator[int]:
    try:
        import resource
    except ImportError:  # not a Unix
        return
    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    pages = text(root / "proc/self/statm").split()
    if most != resource.RLIM_INFINITY and pages:
        yield most - int(pages[0]) * os.sysconf("SC_PAGE_SIZE") - LIBRARIES
