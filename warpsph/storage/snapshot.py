"""Snapshots: one self-contained VTKHDF file per output time, which ParaView and PyVista open as they are.

The particles are the vertices of a VTKHDF ``PolyData``; each output field of `warpsph.fields` is a point
array under its title (tensors have nine components, row by row) with the attributes ``unit`` and ``meaning``.
Time, step, scene, names, spacing and smoothing length are field data, and facts for `read`.
"""

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpsph.errors import InputError
from warpsph.fields import BY_NAME, FIELDS, Field
from warpsph.messages import files
from warpsph.scalars import KERNEL_TYPES
from warpsph.state import State

from . import atomic, facts, hdf5

if TYPE_CHECKING:
    import h5py

FORM, VERSION = "warpsph snapshot", 2
"""Name and version of the format; the version rises when old readers would fail."""

FACTS = {
    "time": facts.finite,
    "step": facts.natural,
    "dim": facts.one_of(1, 2, 3),
    "spacing": facts.positive,
    "h": facts.positive,
    "scene": facts.text,
    "bodies": facts.many(facts.text),
    "materials": facts.many(facts.text),
}
"""What is said about a snapshot, by the names of `State`, and what it has to be."""

NEEDED = ("id", "body", "mat", "x")
"""Fields that every snapshot has."""

COMPONENTS = {"int": (), "real": (), "vec": (3,), "point": (3,), "mat": (9,), "sym": (9,)}
"""Shape of one particle's entry in the file."""


def write(path: Path, state: State) -> None:
    """Write one snapshot: every output field that the state holds.

    Raises:
        DiskError: If it cannot be written; an older file of that name stays whole.
    """
    said = _facts(state)
    with hdf5.writing(path, FORM, VERSION, said) as file:
        root = file.create_group("VTKHDF", track_order=True)
        root.attrs["Version"] = np.array([2, 2], dtype=np.int64)
        root.attrs["Type"] = np.bytes_("PolyData")  # VTK wants a string of fixed length here
        _write_points(root, state)
        data = root.create_group("PointData", track_order=True)
        for f in FIELDS:
            if f.output and f.name in state.fields and f.name != "x":
                _write_array(data, f.title, f, state.fields[f.name])
        _write_facts(root.create_group("FieldData"), said)


def read(path: Path) -> State:
    """Read a snapshot back, bit for bit.

    Returns:
        The state; it holds the output fields only.

    Raises:
        InputError: If the file is missing, damaged, or no snapshot.
    """
    with hdf5.reading(path, FORM, VERSION) as file:
        said = facts.check(file.facts, FACTS)
        fields = {}
        for f in FIELDS:
            place = "VTKHDF/Points" if f.name == "x" else f"VTKHDF/PointData/{f.title}"
            if place in file.names or f.name in NEEDED:
                fields[f.name] = file.array(place)
        n = len(fields["x"])
        fields = {name: _shaped(BY_NAME[name], array, n) for name, array in fields.items()}
        state = State(**said, fields=fields)
        _check_indices(state)
        return state


def time(path: Path) -> float:
    """Time of a snapshot [s], without reading its particles.

    Raises:
        InputError: As `read`; but damage of the particles stays unseen.
    """
    with hdf5.reading(path, FORM, VERSION, whole=False) as file:
        return facts.check(file.facts, FACTS)["time"]


def find(folder: Path) -> list[Path]:
    """Snapshots of a run in the order of their numbers, which is the order of time.

    Args:
        folder: Output folder of a run, or the folder ``snapshots`` in it.
    """
    folder = Path(folder)
    inner = folder / "snapshots"
    numbered = (inner if inner.is_dir() else folder).glob("*_*.vtkhdf")
    return sorted(
        (path for path in numbered if _number(path) is not None), key=lambda path: (_number(path), path.name)
    )


def times(folder: Path, end: float = math.inf) -> dict[str, float]:
    """Times of the snapshots of a run [s], by their names.

    Args:
        folder: As for `find`.
        end: Only snapshots with lower numbers count.

    Raises:
        InputError: If one of them is damaged; says what to do with it.
    """
    found = {}
    for path in find(folder):
        if _number(path) < end:
            try:
                found[path.name] = time(path)
            except InputError as error:
                raise files.in_the_series(error) from None
    return found


def drop(folder: Path, first: int, kept: Mapping[str, float]) -> None:
    """Remove the snapshots from a number on; the index loses them first, so that it never names one too many.

    Args:
        folder: As for `find`.
        first: The lowest number to go.
        kept: What `times` gives for the others.

    Raises:
        DiskError: If the index cannot be written, or a snapshot not removed.
    """
    later = [path for path in find(folder) if _number(path) >= first]
    if later:
        series(folder, kept)
    for path in later:
        atomic.remove(path)


def series(folder: Path, times: Mapping[str, float]) -> Path | None:
    """Write the index ``NAME.vtkhdf.series`` that ParaView opens as one animation.

    Args:
        folder: As for `find`.
        times: Times [s] by name of the snapshots that it is to name; those that are gone are left out. None is read.

    Returns:
        The index, or None if there is no snapshot yet.

    Raises:
        DiskError: If the index cannot be written.
    """
    paths = [path for path in find(folder) if path.name in times]
    if not paths:
        return None
    entries = [{"name": path.name, "time": times[path.name]} for path in paths]
    index = paths[0].with_name(paths[0].stem.rpartition("_")[0] + ".vtkhdf.series")
    atomic.write(index, json.dumps({"file-series-version": "1.0", "files": entries}, indent=1).encode())
    return index


def _number(path: Path) -> int | None:
    """The number at the end of a snapshot's name: 12 for ``hvi_2d_0012.vtkhdf``."""
    match = re.search(r"_(\d+)$", path.stem)
    return int(match[1]) if match else None


def _write_points(root: "h5py.Group", state: State) -> None:
    """Positions, and one vertex cell on each; VTK asks for the empty cell kinds too."""
    x = state.x
    n = len(x)
    root["NumberOfPoints"] = np.array([n], dtype=np.int64)
    _write_array(root, "Points", BY_NAME["x"], x)
    for kind, cells in (("Vertices", n), ("Lines", 0), ("Polygons", 0), ("Strips", 0)):
        group = root.create_group(kind)
        group["NumberOfCells"] = group["NumberOfConnectivityIds"] = np.array([cells], dtype=np.int64)
        group["Connectivity"] = np.arange(cells, dtype=np.int64)
        group["Offsets"] = np.arange(cells + 1, dtype=np.int64)


def _write_array(group: "h5py.Group", title: str, f: Field, array: np.ndarray) -> None:
    """One field with its unit and meaning."""
    if f.kind == "int":
        array = np.asarray(array, dtype=np.int32)
    data = group.create_dataset(title, data=np.asarray(array).reshape(len(array), *COMPONENTS[f.kind]))
    data.attrs.update({"unit": f.unit, "meaning": f.meaning})


def _facts(state: State) -> dict[str, Any]:
    """What holds for the whole snapshot, for `read`."""
    return {
        "time": float(state.time), "step": int(state.step), "dim": int(state.dim), "spacing": float(state.spacing),
        "h": float(state.h), "scene": state.scene, "bodies": list(state.bodies), "materials": list(state.materials),
    }  # fmt: skip


def _write_facts(group: "h5py.Group", said: dict[str, Any]) -> None:
    """The same for other programs. Text is UTF-8 that is declared ASCII: VTK reads no other."""
    import h5py

    for name, value in said.items():
        title = "TimeValue" if name == "time" else name
        if isinstance(value, int | float):
            group[title] = np.array([value])
            continue
        texts = [value] if isinstance(value, str) else value
        encoded = np.array([text.encode() for text in texts], dtype=object)
        group.create_dataset(title, data=encoded, shape=(len(texts),), dtype=h5py.string_dtype("ascii"))


def _shaped(f: Field, array: np.ndarray, n: int) -> np.ndarray:
    """A field as the state holds it.

    Raises:
        ValueError: If the file gives it another shape or type.
    """
    if array.shape != (n, *COMPONENTS[f.kind]):
        raise ValueError(f"field {f.title!r} has shape {array.shape}; expected {(n, *COMPONENTS[f.kind])}")
    if (f.kind == "int") != (array.dtype.kind == "i"):
        raise ValueError(f"field {f.title!r} has the type {array.dtype}")
    return array.reshape(n, 3, 3) if f.kind in ("mat", "sym") else array


def _check_indices(state: State) -> None:
    """Check the numbers that stand for something.

    Raises:
        ValueError: If one stands for nothing.
    """
    ends = {"id": len(state.x), "body": len(state.bodies), "mat": len(state.materials)}
    ends |= {"kernel_type": len(KERNEL_TYPES), "fixed": 8}
    for name, end in ends.items():
        values = state.fields.get(name, np.empty(0))
        if len(values) and not 0 <= values.min() <= values.max() < end:
            raise ValueError(f"field {BY_NAME[name].title!r} has values outside of 0 to {end - 1}")
