"""Where a checkpoint comes from: what it says of its run, and in what the one that goes on from it differs."""

from pathlib import Path
from typing import Any

import warp as wp

from . import __version__
from .messages import remarks
from .processor import processor
from .solver import Solver
from .storage import checkpoint


def header(solver: Solver, out: Path) -> dict[str, Any]:
    """What a checkpoint says of a run into a folder: versions, scene, numbers, device (see `storage.checkpoint.HEADER`)."""
    data, device = solver.data, solver.launcher.device
    return {
        "version": __version__, "warp": wp.__version__, "scene": data.name,
        "scene_sha256": checkpoint.digest(out / "scene.py"), "dim": data.dim, "particles": len(data.x),
        "scheme": data.numerics.scheme, "precision": solver.precision, "device": device.alias,
        "device_name": device.name if device.is_cuda else processor(),
    }  # fmt: skip


def differences(then: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """What the user is to be told about a run that goes on: why it may not end in the bits of an unbroken one.

    Args:
        then: Facts of the checkpoint.
        now: Header of the run that goes on from it.
    """
    said = []
    if _arithmetic(then) != _arithmetic(now):
        said.append(remarks.other_arithmetic(_arithmetic(then), _arithmetic(now), then["time"]))
    if _versions(then) != _versions(now):
        said.append(remarks.other_version(_versions(then), _versions(now), then["time"]))
    return said


def _arithmetic(facts: dict[str, Any]) -> str:
    kind = "CUDA" if facts["device"] != "cpu" else "CPU"
    return f"on the {kind} {facts['device_name']} in {facts['precision']}"


def _versions(facts: dict[str, Any]) -> str:
    return f"warpsph {facts['version']} with Warp {facts['warp']}"
