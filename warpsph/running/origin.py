"""Where a checkpoint comes from: what it says of its run, what of that has to be there, and how a later run differs."""

from pathlib import Path
from typing import Any

import warp as wp

from warpsph import __version__
from warpsph.device.processor import processor
from warpsph.kernels.guards import GUARDS
from warpsph.messages import files, remarks
from warpsph.solver import Solver
from warpsph.storage import checkpoint, facts

KEPT = {
    "interval": facts.positive, "row_interval": facts.positive, "ends": facts.many(facts.finite), "due": facts.natural,
    "next_snapshot": facts.natural, "next_row": facts.not_negative, "neighbours": facts.many(facts.finite),
    "peaks": facts.each(facts.number), "remarks": facts.many(facts.text), "wall": facts.not_negative,
    "step_wall": facts.not_negative,
}  # fmt: skip
"""Attributes of a `Job` that a checkpoint keeps, its fact ``job``, and what they have to be."""

CASE = facts.record_of({
    "value": facts.number, "particle": facts.natural, "body": facts.text, "material": facts.text,
    "position": facts.many(facts.number), "time": facts.finite, "step": facts.natural,
})  # fmt: skip
"""What a guard has found at one look, see `warpsph.watching.watch.Watch`."""

FOUND = facts.record_of({
    "looks": facts.natural, "particles": facts.natural, "first": CASE, "limit": facts.number, "action": facts.text, "worst": CASE,
})  # fmt: skip
"""What it has found in a run."""

SOLVER = {
    "precision": facts.text, "cuda": facts.truth, "batch": facts.natural, "builds": facts.natural, "tile_width": facts.positive,
    "watch": facts.record_of({
        "guards": facts.record, "start": facts.optional(facts.number), "found": facts.each(FOUND, GUARDS),
    }),
}  # fmt: skip
"""What `warpsph.solver.Solver.save` gives besides arrays."""

BALANCE = {
    "start": facts.each(facts.number), "energy_error": facts.number, "momentum_error": facts.number,
    "angular_momentum_error": facts.number, "kinetic": facts.number,
}  # fmt: skip
"""What `warpsph.running.balance.Balance.save` gives."""

NEEDED = {
    "time": facts.not_negative, "until": facts.positive, "row_time": facts.finite, "device": facts.text, "precision": facts.text,
    "device_name": facts.text, "version": facts.text, "warp": facts.text, "scene_sha256": facts.text, "frames": facts.truth,
    "parameters": facts.record, "solver": facts.record_of(SOLVER), "balance": facts.record_of(BALANCE),
    "job": facts.record_of(KEPT),
}  # fmt: skip
"""Facts of a checkpoint that a run goes on from, and what they have to be."""

SHORTEST = 1e-9
"""Shortest interval of outputs, as a share of the end time."""


def checked(found: checkpoint.Found) -> checkpoint.Found:
    """Give a checkpoint with the facts that a run goes on from, each as it has to be, and no others.

    Raises:
        InputError: If one is missing or of a wrong type.
    """
    try:
        info = facts.check(found.info, NEEDED)
        if min(info["job"]["interval"], info["job"]["row_interval"]) < SHORTEST * info["until"]:
            raise ValueError("its outputs have no end")
    except ValueError as error:
        raise files.damaged(found.path, checkpoint.FORM, error) from None
    return found._replace(info=info)


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


def _arithmetic(info: dict[str, Any]) -> str:
    kind = "CUDA" if info["device"] != "cpu" else "CPU"
    return f"on the {kind} {info['device_name']} in {info['precision']}"


def _versions(info: dict[str, Any]) -> str:
    return f"warpsph {info['version']} with Warp {info['warp']}"
