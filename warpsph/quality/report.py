"""Reports that commands write into a checkout's documentation: tables between markers, with where they come from."""

import datetime
import os
import platform
import subprocess
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path

import warp as wp

from warpsph import __version__
from warpsph.device.cores import count_cores
from warpsph.device.processor import processor
from warpsph.messages import measuring
from warpsph.storage import atomic

LIBRARIES = ("warp-lang", "numpy")
"""Libraries whose versions matter to a figure."""


def checkout() -> Path | None:
    """Root of the source tree that this package runs from; None for an installed package."""
    root = Path(__file__).resolve().parents[2]
    return root if (root / "pyproject.toml").is_file() and (root / "docs").is_dir() else None


def facts(device: wp.Device) -> dict[str, str]:
    """Where and from what a figure was measured: date, device and its load, operating system, commit, versions."""
    versions = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    driver = wp.get_cuda_driver_version() if device.is_cuda else None
    return {
        "date": today(),
        "device": device.name if device.is_cuda else _processor(),
        **({"driver": "CUDA " + ".".join(map(str, driver))} if driver else {}),
        "load average": f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown",
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "warpsph": f"{__version__}, commit {commit()}",
        "libraries": versions,
    }


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Lay rows of text out as a Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def write_section(path: Path, name: str, text: str) -> None:
    """Replace what stands between the markers ``<!-- begin NAME -->`` and ``<!-- end NAME -->`` of a file.

    Raises:
        InputError: If the file does not have both markers, once and in order.
    """
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    before, found, rest = path.read_text(encoding="utf-8").partition(begin)
    _, closed, after = rest.partition(end)
    if not found or not closed:
        raise measuring.no_place(path, begin, end)
    atomic.write(path, f"{before}{begin}\n{text.strip()}\n{end}{after}".encode())


def today() -> str:
    """Date of a report."""
    return datetime.date.today().isoformat()


def _processor() -> str:
    """Name and number of cores of the processor."""
    return f"{processor()}, {count_cores()} cores"


def commit() -> str:
    """Commit of the checkout, marked where files have changed since; ``unknown`` outside of one."""
    root = checkout()
    if root is None:
        return "unknown"
    command = ["git", "-C", str(root), "describe", "--always", "--dirty=, with changes", "--exclude=*"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
