"""The history of a run: one row of numbers per output interval, as a table that any program reads."""

import contextlib
import csv
import errno
import io
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Self

import numpy as np

from warpsph.messages import files, values

from . import atomic, text

LONGEST = 2**26
"""Longest file that is read [bytes]; a run writes some hundred thousand."""


class History:
    """A growing ``history.csv``. Every row is on its way to the disk when `write` returns.

    Attributes:
        path: The file.
        columns: Name and unit of each column; the first one is the time.
        last: Time of the last row that was there when the file was opened [s]; None: there was none.
    """

    last: float | None = None

    def __init__(self, path: Path, columns: Sequence[tuple[str, str]]):
        """Start a new table, replacing an older file.

        Args:
            path: The file.
            columns: Name and unit of each column; the first is ``("time", "s")``.

        Raises:
            InputError: If two columns have one name.
            DiskError: If the file cannot be written.
        """
        self.path, self.columns = Path(path), list(columns)
        names = [name for name, _ in self.columns]
        for name in names:
            if names.count(name) > 1:
                raise values.clash(f"history column {name!r}", "another of that name", "names that differ")
        self._start([])

    @classmethod
    def reopen(cls, path: Path, time: float) -> Self:
        """Go on with a table from a time: rows later than that are dropped.

        Args:
            path: The file.
            time: Time to go on from [s].

        Raises:
            InputError: If the file is missing or no history.
            DiskError: If the file cannot be written.
        """
        history = cls.__new__(cls)
        history.path = Path(path)
        history.columns, rows = _parse(history.path)
        rows = [row for row in rows if float(row[0]) <= time]
        history.last = float(rows[-1][0]) if rows else None
        history._start(rows)
        return history

    def write(self, values: Sequence[float]) -> None:
        """Append one row, or nothing of it.

        Args:
            values: One number per column [unit of the column].

        Raises:
            ValueError: If there are too few or too many.
            DiskError: If the disk takes no more, or the file has been removed.
        """
        if len(values) != len(self.columns):
            raise ValueError(f"{len(values)} values for {len(self.columns)} columns")
        with atomic.naming(self.path):
            self._append(_line([_text(value) for value in values]).encode())

    def sync(self) -> None:
        """Wait until all rows are on the disk, which may refuse them only then.

        Raises:
            DiskError: If it does, or the file has been removed.
        """
        with atomic.naming(self.path):
            self._size()
            os.fsync(self._stream.fileno())

    def close(self) -> None:
        """Close the file.

        Raises:
            DiskError: If the disk refuses rows that it had taken.
        """
        with atomic.naming(self.path):
            self._stream.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _start(self, rows: list[list[str]]) -> None:
        """Write header and rows and leave the file open at its end."""
        header = [f"{name} [{unit}]" for name, unit in self.columns]
        atomic.write(self.path, "".join(_line(row) for row in [header, *rows]).encode())
        with atomic.naming(self.path):
            self._stream = open(self.path, "ab", buffering=0)

    def _append(self, line: bytes) -> None:
        """Write a line to the end of the file; if that fails half-way, take back what is there of it."""
        before, rest = self._size(), memoryview(line)
        try:
            while rest:
                rest = rest[self._stream.write(rest) :]
        except OSError:
            with contextlib.suppress(OSError):
                self._stream.truncate(before)
            raise

    def _size(self) -> int:
        """Bytes in the file, which must still have a name: the system would go on writing where nobody can see it."""
        there = os.fstat(self._stream.fileno())
        if there.st_nlink == 0:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        return there.st_size


def read(path: Path) -> tuple[list[str], list[str], dict[str, np.ndarray]]:
    """Read a history, also one that is still being written.

    Returns:
        Names, units, and each column by its name, float64, shape [rows].

    Raises:
        InputError: If the file is missing or no history.
    """
    columns, rows = _parse(Path(path))
    table = np.array([[float(cell) for cell in row] for row in rows]).reshape(len(rows), len(columns))
    names = [name for name, _ in columns]
    return names, [unit for _, unit in columns], dict(zip(names, table.T, strict=True))


def _parse(path: Path) -> tuple[list[tuple[str, str]], list[list[str]]]:
    """Columns and rows of a file. A last line that a crash cut short does not count."""
    content = text.read(path, "history", LONGEST)
    try:
        header, *rows = list(csv.reader(content[: content.rfind("\n") + 1].splitlines())) or [[]]
    except csv.Error as error:
        raise files.unreadable(path, "history", error) from error
    matches = [re.fullmatch(r"(.+) \[(.*)\]", cell) for cell in header]
    names = [match[1] for match in matches if match and match[1].isprintable() and match[2].isprintable()]
    if len(set(names)) < len(header) or names[:1] != ["time"]:
        raise files.no_history(path)
    for number, row in enumerate(rows, start=2):
        if len(row) != len(header) or not all(map(_is_number, row)):
            raise files.torn_history(path, number, len(header))
    return [(match[1], match[2]) for match in matches], rows


def _line(cells: list[str]) -> str:
    """One line of comma-separated cells."""
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(cells)
    return line.getvalue()


def _text(value: float) -> str:
    """Shortest text that reads back as the same number."""
    return str(int(value)) if isinstance(value, int | np.integer) else repr(float(value))


def _is_number(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
