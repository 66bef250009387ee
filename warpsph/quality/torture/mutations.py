"""Ways to spoil a file. Each takes random numbers and the content, and gives the new content."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpsph.storage import seal

Mutation = Callable[[np.random.Generator, bytes], bytes]

HUGE = (2**31 - 1, 2**31, 2**63 - 1, 2**64, 10**15, 10**400, -1, -(2**63), 0)
"""Whole numbers that nobody expects."""

ODD = (
    *HUGE, 1e308, -1e308, 5e-324, float("nan"), float("inf"), 0.5, -0.0, None, True, "", "x" * 10**5, "\x1b[2J\n\0",
    "../../../etc/passwd", "__class__", "$\\frac{", [], {}, [[]], [10**15], ["<f8", [10**15], 0], "|O", {"a": {"b": []}},
)  # fmt: skip
"""Values of any type that nobody expects."""

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
"""A number in a text."""


def cut(rng: np.random.Generator, data: bytes) -> bytes:
    """Cut short."""
    return data[: rng.integers(len(data))]


def flip(rng: np.random.Generator, data: bytes) -> bytes:
    """1 to 64 bits flipped."""
    bits = np.unpackbits(np.frombuffer(data, np.uint8))
    bits[rng.integers(len(bits), size=rng.integers(1, 65))] ^= 1
    return np.packbits(bits).tobytes()


def splice(rng: np.random.Generator, data: bytes) -> bytes:
    """Up to 512 random bytes written over others."""
    noise, start = rng.bytes(rng.integers(1, 513)), rng.integers(len(data))
    return data[:start] + noise + data[start + len(noise) :]


def double(rng: np.random.Generator, data: bytes) -> bytes:
    """A block is there twice."""
    start, end = np.sort(rng.integers(len(data) + 1, size=2))
    return data[:end] + data[start:]


def drop(rng: np.random.Generator, data: bytes) -> bytes:
    """A block is missing."""
    start, end = np.sort(rng.integers(len(data) + 1, size=2))
    return data[:start] + data[end:]


def number(rng: np.random.Generator, data: bytes) -> bytes:
    """A number of the text is huge, negative or none."""
    places = list(NUMBER.finditer(data))
    if not places:
        return data[::-1]
    place, value = (
        places[rng.integers(len(places))],
        (*HUGE, "nan", "-inf", "1e999", "0x10")[rng.integers(13)],
    )
    return data[: place.start()] + str(value).encode() + data[place.end() :]


def word(rng: np.random.Generator, data: bytes) -> bytes:
    """Four or eight bytes of a binary file are a huge or a negative number, as a rule near the beginning."""
    size = int(rng.choice((4, 8)))
    start = int(rng.integers(min(len(data), 200) if rng.random() < 0.7 else len(data)))
    value = rng.choice(np.array([0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**32 - 2], dtype=np.uint64))
    return data[:start] + int(value).to_bytes(8, "little")[:size] + data[start + size :]


def line(rng: np.random.Generator, data: bytes) -> bytes:
    """A line is replaced by an odd one."""
    lines = data.split(b"\n")
    odd = (
        b"\0" * 100,
        b"9" * 10**6,
        b"\x1b[2J",
        b"\xff\xfe",
        b",,,,",
        b"[" * 10**5,
        b'"',
        b"f 1 2 -99",
        b"element vertex 10000000000",
    )
    lines[rng.integers(len(lines))] = odd[rng.integers(len(odd))]
    return b"\n".join(lines)


def facts(rng: np.random.Generator, data: bytes) -> bytes:
    """An entry of the JSON of a file is odd, renamed or missing."""
    return json.dumps(_spoilt(rng, json.loads(data))).encode()


def index(rng: np.random.Generator, data: bytes) -> bytes:
    """The same in the index of a sealed file, with a right seal."""
    inner, content = _opened(data)
    return _sealed(content, _spoilt(rng, inner))


def values(rng: np.random.Generator, data: bytes) -> bytes:
    """Numbers of an array are random bits, with a right seal."""
    return _filled(rng, data, lambda array: rng.bytes(array.nbytes))


def extremes(rng: np.random.Generator, data: bytes) -> bytes:
    """A number in three of an array is huge, infinite, tiny or none, with a right seal."""

    def sprinkle(array: np.ndarray) -> bytes:
        odd = (
            (2**31 - 1, -(2**31), -1, 99)
            if array.dtype.kind == "i"
            else (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e200, 5e-324)
        )
        with np.errstate(over="ignore"):
            return (
                np.where(rng.random(array.shape) < 0.3, rng.choice(odd, array.shape), array)
                .astype(array.dtype)
                .tobytes()
            )

    return _filled(rng, data, sprinkle)


def _filled(rng: np.random.Generator, data: bytes, fill: Callable[[np.ndarray], bytes]) -> bytes:
    """A sealed file with other bytes in one of its arrays, as a rule one that warpsph reads."""
    inner, content = _opened(data)
    names = [name for name in inner["arrays"] if "Connectivity" not in name and "Offsets" not in name]
    kind, shape, start = inner["arrays"][names[rng.integers(len(names))]]
    array = np.frombuffer(content, kind, count=int(np.prod(shape)), offset=start).reshape(shape)
    return _sealed(content[:start] + fill(array) + content[start + array.nbytes :], inner)


BYTES: tuple[Mutation, ...] = (cut, flip, splice, double, drop)
"""Mutations of any content."""

OF_FORMAT: dict[str, tuple[Mutation, ...]] = {
    "snapshot": (word, number), "checkpoint": (word, number), "history": (number, line), "summary": (facts, number, line),
    "stl": (word,), "stl (text)": (number, line), "obj": (number, line), "ply": (word, number, line), "ply (text)": (number, line),
}  # fmt: skip
"""Those that make sense for a format besides."""


def structures(folder: Path, good: Path) -> list[Path]:
    """HDF5 files of hostile structure, without a seal and with the seal of a sound one; gives their paths."""

    def cycle(file: h5py.File) -> None:
        file["VTKHDF/loop"] = file["VTKHDF"]
        file["VTKHDF/PointData/pressure"] = h5py.SoftLink("/VTKHDF/PointData/pressure")

    def external(file: h5py.File) -> None:
        file["VTKHDF"] = h5py.ExternalLink(str(good), "/VTKHDF")

    def raw(file: h5py.File) -> None:
        file.create_dataset("VTKHDF/Points", (16, 3), "f8", external=[("/etc/passwd", 0, 384)])

    def bomb(file: h5py.File) -> None:
        file.create_dataset(
            "VTKHDF/Points", (10**12, 3), "f8", chunks=(10**4, 3), compression="gzip", fillvalue=1.0
        )

    def virtual(file: h5py.File) -> None:
        layout = h5py.VirtualLayout((10**9, 3), "f8")
        layout[:10] = h5py.VirtualSource(str(good), "VTKHDF/Points", (10, 3))
        file.create_virtual_dataset("VTKHDF/Points", layout)

    def types(file: h5py.File) -> None:
        file["VTKHDF/Points"] = np.array([b"a", b"bc"], dtype=object)
        file["VTKHDF/NumberOfPoints"] = np.zeros(3, dtype=[("a", "f4"), ("b", "S3")])
        file.attrs["format"] = np.zeros(5)

    def deep(file: h5py.File) -> None:
        file.create_group("/".join("a" * 2000))

    made = []
    for build in (cycle, external, raw, bomb, virtual, types, deep):
        for sealed in (False, True):
            path = folder / f"{build.__name__}_{sealed:d}.vtkhdf"
            with h5py.File(path, "w") as file:
                file.attrs.update({"format": "warpsph snapshot", "format_version": 2})
                file.require_group("VTKHDF/PointData") if build is cycle else None
                build(file)
            if sealed:
                path.write_bytes(_sealed(path.read_bytes(), _opened(good.read_bytes())[0]))
            made.append(path)
    return made


def _opened(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Index and content of a sealed file."""
    import io

    inner = seal.index(io.BytesIO(data))
    return inner, data[: inner["size"]]


def _sealed(content: bytes, inner: Any) -> bytes:
    """A sealed file of some content, whatever the index says."""
    import io

    stream = io.BytesIO(content)
    seal.put(stream, inner if isinstance(inner, dict) else {"facts": inner})
    return stream.getvalue()


def _spoilt(rng: np.random.Generator, whole: Any) -> Any:
    """Replace, rename or remove one entry, drawn level by level."""
    if not isinstance(whole, dict | list) or not whole or rng.random() < 0.05:
        return ODD[rng.integers(len(ODD))]
    keys = list(whole) if isinstance(whole, dict) else list(range(len(whole)))
    key = keys[rng.integers(len(keys))]
    spoilt = whole.copy()
    draw = rng.random()
    if draw < 0.1:
        del spoilt[key]
    elif draw < 0.2 and isinstance(whole, dict):
        spoilt[str(ODD[rng.integers(len(ODD))])] = spoilt.pop(key)
    else:
        spoilt[key] = _spoilt(rng, whole[key])
    return spoilt
