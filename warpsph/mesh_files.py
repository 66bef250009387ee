"""Surfaces from STL, OBJ and PLY files: polygons as they are written there, with memory and time in proportion to the file.

What a file says about its own size is compared with the file before anything is made of that size, and what is not
understood is refused, for a part that is missing would change the body without a word.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
from .messages import files

MOST_BYTES = 2**31
"""Longest file that is read: some forty million triangles."""

MOST_CORNERS = 255
"""Most corners of a polygon; cutting one up takes the square of its corners."""

LONGEST_WORD = 40
"""Most characters of a number in a text."""

FARTHEST = 1e12
"""Largest coordinate: beyond it squares and volumes lose their meaning."""


@dataclass(frozen=True)
class Polygons:
    """A surface of polygons.

    Attributes:
        points: Points, shape [n, 3].
        corners: Indices of the corners of all polygons, one polygon after the other, int64, shape [sum of sizes].
        sizes: Number of corners of each polygon, int64, shape [m].
    """

    points: np.ndarray
    corners: np.ndarray
    sizes: np.ndarray

    def check(self) -> None:
        """Check that the polygons are polygons of the points.

        Raises:
            ValueError: If not; says what is wrong.
        """
        if not len(self.sizes):
            raise ValueError("it holds no polygons")
        if self.sizes.min() < 3 or self.sizes.max() > MOST_CORNERS:
            wrong = self.sizes[(self.sizes < 3) | (self.sizes > MOST_CORNERS)][0]
            raise ValueError(f"a polygon has {wrong} corners, and 3 to {MOST_CORNERS} are allowed")
        if self.corners.min() < 0 or self.corners.max() >= len(self.points):
            raise ValueError(f"a polygon has a corner that is none of its {len(self.points)} points")
        if not np.isfinite(self.points).all():
            raise ValueError("it holds points that are not finite")
        if np.abs(self.points).max() > FARTHEST:
            raise ValueError(f"a coordinate is beyond {FARTHEST:g}")


def read(path: Path) -> Polygons:
    """Read a mesh file.

    Raises:
        InputError: If there is no such file, or it is no sound STL, OBJ or PLY file; says why.
    """
    if path.suffix.lower() not in READERS:
        raise files.mesh(path, f"its name ends in {path.suffix or 'nothing'!r}")
    if not path.is_file():
        raise files.no_mesh(path)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise ValueError(f"it has more than {MOST_BYTES} bytes")
        polygons = READERS[path.suffix.lower()](path.read_bytes())
        polygons.check()
        return polygons
    except InputError:
        raise
    except OSError as error:
        raise files.mesh(path, error.strerror or str(error)) from None
    except (ValueError, OverflowError, MemoryError) as error:
        raise files.mesh(path, str(error) or "it does not fit into the memory") from None


BINARY_FACET = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
"""A facet of a binary STL file."""

_NUMBER = rb"\s++([^\s]{1,%d}+)" % LONGEST_WORD

ASCII_FACET = re.compile(
    rb"facet\s++normal(?:\s++[^\s]++){3}\s++outer\s++loop"
    + 3 * (rb"\s++vertex" + 3 * _NUMBER)
    + rb"\s++endloop\s++endfacet\b",
    re.IGNORECASE,
)
"""A facet of an STL file in text, with the nine numbers of its corners. It never goes back over what it has matched."""


def _stl(data: bytes) -> Polygons:
    """Facets of an STL file, binary or text; each has points of its own."""
    facets = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + facets * BINARY_FACET.itemsize:
        points = np.frombuffer(data, BINARY_FACET, offset=84)["points"]
    elif data.lstrip()[:5].lower() == b"solid":
        points = _ascii_facets(data)
    else:
        raise ValueError(
            f"{len(data)} bytes; {facets} facets, as it says, take {84 + facets * BINARY_FACET.itemsize}"
        )
    points = points.reshape(-1, 3).astype(np.float32)
    return Polygons(points, np.arange(len(points)), np.full(len(points) // 3, 3))


def _ascii_facets(data: bytes) -> np.ndarray:
    """Points of the facets of a text, shape [n, 3, 3]."""
    parts = ASCII_FACET.split(data)  # what is between the facets, and nine numbers of each
    rest = [line.split()[0].lower() for line in b"".join(parts[::10]).splitlines() if line.strip()]
    for number, word in enumerate(rest):
        if word != (b"solid", b"endsolid")[number % 2]:
            if word == b"facet":
                raise ValueError(f"a facet is not whole, after {len(parts) // 10} that are")
            raise ValueError(f"{_shown(word)} where facets, solid or endsolid should stand")
    if len(rest) % 2:
        raise ValueError("it ends without endsolid")
    return np.array([list(map(float, parts[k::10])) for k in range(1, 10)]).T.reshape(-1, 3, 3)


OBJ_IGNORED = frozenset(
    b"vn vt g o s l p usemtl mtllib usemap maplib lod bevel c_interp d_interp shadow_obj trace_obj".split()
)
"""Words of an OBJ file that say nothing about the surface; files that they name are not opened."""


def _obj(data: bytes) -> Polygons:
    """Points and faces of an OBJ file."""
    points, corners, sizes = [], [], []
    for number, line in enumerate(data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines(), start=1):
        word, *values = line.partition(b"#")[0].split() or [b"#"]
        try:
            if word == b"v" and len(values) >= 3:
                points.append([float(value) for value in values[:3]])
            elif word == b"f":
                corners += [_obj_index(value, len(points)) for value in values]
                sizes.append(len(values))
            elif word not in OBJ_IGNORED and word != b"#":
                raise ValueError
        except ValueError:
            raise ValueError(f"line {number}, {_shown(line)}, is not understood") from None
    return Polygons(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.array(corners, dtype=np.int64),
        np.array(sizes, dtype=np.int64),
    )


def _obj_index(text: bytes, points: int) -> int:
    """Index of a corner: it counts from 1, or backwards from the last point so far."""
    index = int(text.partition(b"/")[0])
    if index == 0 or abs(index) >= 2**63:
        raise ValueError
    return index - 1 if index > 0 else points + index


PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
"""Names of types in a PLY header."""

PLY_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
"""Byte orders by the name of the format."""

PLY_HEADER = 2**16
"""Longest header."""

Property = tuple[str, str, str | None]
"""Name and type of a PLY property, and the type of its length if it is a list."""

Column = tuple[np.ndarray, np.ndarray | None]
"""All entries of a PLY property, and how many of them belong to each row if it is a list."""


def _ply(data: bytes) -> Polygons:
    """Points and faces of a PLY file, text or binary."""
    end = re.search(rb"\nend_header[ \t]*\r?\n", data[:PLY_HEADER])
    lines = [line.split() for line in data[: end.start()].decode("ascii").splitlines()] if end else [[]]
    if lines[0] != ["ply"]:
        raise ValueError("it has no PLY header")
    order, elements = _ply_header(lines[1:])
    body = data[end.end() :]
    if not order:  # numbers of a text are laid out as if all were doubles
        words = body.split()
        if max(map(len, words), default=0) > LONGEST_WORD:
            raise ValueError("it holds a word that is too long for a number")
        body = np.array([float(word) for word in words], dtype="<f8").tobytes()
    table, place = {}, 0
    for name, count, properties in elements:
        table[name], place = _ply_rows(body, place, name, count, properties)
    if place < len(body):
        raise ValueError("it holds more than its header says")
    points = [_ply_column(table, "vertex", axis)[0] for axis in "xyz"]
    corners, sizes = _ply_column(table, "face", "vertex_indices", "vertex_index")
    if sizes is None or len({len(column) for column in points}) > 1:
        raise ValueError("vertices are numbers and faces are lists in a surface")
    if corners.dtype.kind == "f" and not (corners == np.floor(corners)).all():
        raise ValueError("a corner is no whole number")
    return Polygons(np.stack(points, axis=1).astype(np.float64), corners.astype(np.int64), sizes)


def _ply_header(lines: list[list[str]]) -> tuple[str, list[tuple[str, int, list[Property]]]]:
    """Byte order, and name, number of rows and properties of each element."""
    order, elements = None, []
    for words in lines:
        match words:
            case ["format", kind, "1.0"] if kind in PLY_ORDERS and order is None:
                order = PLY_ORDERS[kind]
            case ["element", name, count] if re.fullmatch(r"\d{1,18}", count) and name not in [
                e[0] for e in elements
            ]:
                elements.append((name, int(count), []))
            case ["property", "list", length, kind, name] if (
                elements and length in PLY_TYPES and kind in PLY_TYPES
            ):
                elements[-1][2].append((name, _ply_type(kind, order), _ply_type(length, order)))
            case ["property", kind, name] if elements and kind in PLY_TYPES:
                elements[-1][2].append((name, _ply_type(kind, order), None))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise ValueError(f"header line {_shown(' '.join(words).encode())} is not understood")
    if order is None or not all(properties for _, _, properties in elements):
        raise ValueError("its header lacks the format or the properties of an element")
    return order, elements


def _ply_type(name: str, order: str | None) -> str:
    """Numpy's name of a type; doubles in a text."""
    return order + PLY_TYPES[name] if order else "<f8"


def _ply_rows(
    body: bytes, place: int, name: str, count: int, properties: list[Property]
) -> tuple[dict[str, Column], int]:
    """Read an element's rows from a place on; rows whose lists are as long as those of the first are read at once.

    Returns:
        The columns by name, and the place behind the rows.

    Raises:
        ValueError: If the file ends before.
    """
    runs, done, most = [], 0, 1
    while done < count:
        row, lengths = _ply_row(body, place, properties)
        rows = np.frombuffer(body, row, min(most, count - done, (len(body) - place) // row.itemsize), place)
        alike = np.ones(len(rows), dtype=bool)
        for k, length in lengths.items():
            alike &= rows[k] == length
        rows, most = (rows, 2 * most) if alike.all() else (rows[: np.argmin(alike)], 1)
        if not len(rows):
            raise ValueError(f"it ends in row {done} of the {count} of element {name!r}")
        runs.append(rows)
        done, place = done + len(rows), place + rows.nbytes
    columns = {}
    for k, (title, _, length) in enumerate(properties):
        entries = np.concatenate([run[title].reshape(-1) for run in runs]) if runs else np.empty(0)
        sizes = np.concatenate([run[f"#{k}"] for run in runs]).astype(np.int64) if length and runs else None
        columns[title] = entries, sizes
    return columns, place


def _ply_row(body: bytes, place: int, properties: list[Property]) -> tuple[np.dtype, dict[str, int]]:
    """Layout of the row at a place, and the lengths of its lists by the name of their entry in it."""
    parts, lengths, end = [], {}, place
    for k, (name, kind, length) in enumerate(properties):
        shape = ()
        if length:
            start, end = end, end + np.dtype(length).itemsize
            number = np.frombuffer(body[start:end].ljust(end - start, b"\0"), length)[0]
            lengths[f"#{k}"] = int(number)
            if not 0 <= number == lengths[f"#{k}"] <= MOST_CORNERS:
                raise ValueError(f"a list has {number} entries, and up to {MOST_CORNERS} are allowed")
            parts.append((f"#{k}", length))
            shape = (lengths[f"#{k}"],)
        parts.append((name, kind, shape))
        end += np.dtype(parts[-1][1:]).itemsize
    return np.dtype(parts), lengths


def _ply_column(table: dict[str, dict[str, Column]], element: str, *names: str) -> Column:
    """The column of one of these names."""
    for name in names:
        if name in table.get(element, {}):
            return table[element][name]
    raise ValueError(f"it has no {names[0]!r} of element {element!r}")


def _shown(text: bytes) -> str:
    """The beginning of a piece of a file, as it may be printed."""
    return repr(text[:LONGEST_WORD].decode("latin-1"))


READERS: dict[str, Callable[[bytes], Polygons]] = {".stl": _stl, ".obj": _obj, ".ply": _ply}
"""Readers by the ending of the name."""
