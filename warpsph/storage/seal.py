"""The seal at the end of a file: what the file holds and where, with checksums, so that nothing in it is taken on trust.

After the content come an index (JSON) and a last line with the index's length and checksum. The index has the length
and the checksum of the content. HDF5 and VTK do not look at what follows the end of their data.
"""

import hashlib
import json
import re
from typing import Any, BinaryIO

LAST = re.compile(rb"\nwarpsph seal (\d{12}) ([0-9a-f]{64})\n")
"""The last line: length of the index in bytes, and its SHA-256."""

LAST_BYTES = 92
"""Length of the last line."""

LONGEST = 2**24
"""Most bytes of an index: what a file says about itself must not fill the memory."""

PIECE = 2**20
"""Bytes that are read at a time."""


def put(stream: BinaryIO, index: dict[str, Any]) -> None:
    """Seal a file that is otherwise complete.

    Args:
        stream: The file, open to read and write.
        index: What it holds, as JSON can say it; ``size`` and ``sha256`` of the content are added.

    Raises:
        ValueError: If the index is longer than `LONGEST`.
        OSError: If the file cannot be written.
    """
    size = stream.seek(0, 2)
    text = json.dumps(index | {"size": size, "sha256": _sha256(stream, size)}).encode()
    if len(text) > LONGEST:
        raise ValueError(f"the index of a file has {len(text)} bytes; allowed: {LONGEST}")
    stream.seek(0, 2)
    stream.write(text + b"\nwarpsph seal %012d %s\n" % (len(text), hashlib.sha256(text).hexdigest().encode()))


def index(stream: BinaryIO) -> dict[str, Any]:
    """Read what a sealed file holds, without its content.

    Raises:
        ValueError: If the file is not sealed, or the index is damaged or does not fit the file's length.
    """
    end = stream.seek(0, 2)
    last = LAST.fullmatch(_piece(stream, end - LAST_BYTES, LAST_BYTES))
    if last is None:
        raise ValueError("it has no seal: cut short, changed by another program, or of an older warpsph")
    length = int(last[1])
    if length > min(LONGEST, end - LAST_BYTES):
        raise ValueError(f"its index claims {length} bytes")
    text = _piece(stream, end - LAST_BYTES - length, length)
    if hashlib.sha256(text).hexdigest().encode() != last[2]:
        raise ValueError("its index does not match its checksum")
    found = json.loads(text)
    if not isinstance(found, dict) or found.get("size") != end - LAST_BYTES - length:
        raise ValueError("its index is of a file of another length")
    return found


def verify(stream: BinaryIO, index: dict[str, Any]) -> None:
    """Compare the content with its checksum.

    Raises:
        ValueError: If they differ.
    """
    if _sha256(stream, index["size"]) != index.get("sha256"):
        raise ValueError("its content does not match its checksum")


def _sha256(stream: BinaryIO, size: int) -> str:
    """Checksum of the first ``size`` bytes."""
    stream.seek(0)
    digest, piece = hashlib.sha256(), memoryview(bytearray(PIECE))
    while size > 0:
        read = stream.readinto(piece[: min(PIECE, size)])
        if not read:
            break
        digest.update(piece[:read])
        size -= read
    return digest.hexdigest()


def _piece(stream: BinaryIO, start: int, length: int) -> bytes:
    """Some bytes of a file; fewer where it ends before or would start before its beginning."""
    stream.seek(max(start, 0))
    return stream.read(length)
