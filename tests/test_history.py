import math
from pathlib import Path

import numpy as np
import pytest

from warpsph.errors import DiskError, InputError
from warpsph.storage import history
from warpsph.storage.history import History

COLUMNS = [("time", "s"), ("step", "1"), ("kinetic_energy", "J/m"), ("width, outer", "m")]


def test_rows_come_back_exactly_while_the_file_grows(tmp_path):
    path = tmp_path / "history.csv"
    with History(path, COLUMNS) as table:
        table.write([0.0, 0, math.pi, math.nan])
        table.write([np.float64(1e-7) / 3, np.int64(7), np.float32(0.1), -math.inf])
        names, units, columns = history.read(path)  # before it is closed
    assert list(zip(names, units, strict=True)) == COLUMNS
    assert columns["time"].tolist() == [0.0, 1e-7 / 3]
    assert columns["step"].tolist() == [0, 7]
    assert columns["kinetic_energy"].tolist() == [math.pi, float(np.float32(0.1))]
    assert math.isnan(columns["width, outer"][0]) and columns["width, outer"][1] == -math.inf


def test_first_line_names_columns_and_units(tmp_path):
    History(tmp_path / "history.csv", COLUMNS[:3]).close()
    assert (tmp_path / "history.csv").read_text() == "time [s],step [1],kinetic_energy [J/m]\n"
    assert all(len(column) == 0 for column in history.read(tmp_path / "history.csv")[2].values())


def test_reopening_drops_later_rows(tmp_path):
    path = tmp_path / "history.csv"
    with History(path, COLUMNS[:2]) as table:
        for step in range(5):
            table.write([step * 0.1, step])
    before = path.read_text().splitlines()
    with History.reopen(path, 2 * 0.1) as table:
        assert table.columns == COLUMNS[:2]
        table.write([0.25, 3])
    assert path.read_text().splitlines() == [*before[:4], "0.25,3"]


def test_row_cut_short_by_a_crash_does_not_count(tmp_path):
    path = tmp_path / "history.csv"
    with History(path, COLUMNS[:2]) as table:
        table.write([0.5, 12])
    path.write_text(path.read_text() + "0.6,1")
    assert history.read(path)[2]["time"].tolist() == [0.5]
    History.reopen(path, 1.0).close()
    assert path.read_text() == "time [s],step [1]\n0.5,12\n"


def test_wrong_number_of_values(tmp_path):
    with (
        History(tmp_path / "history.csv", COLUMNS) as table,
        pytest.raises(ValueError, match="2 values for 4"),
    ):
        table.write([0.0, 1])


def test_column_twice(tmp_path):
    with pytest.raises(InputError, match="column 'step' does not go with another of that name"):
        History(tmp_path / "history.csv", [*COLUMNS, ("step", "1")])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is no history"),
        (b"a,b\n1,2\n", "is no history"),
        (b"time [s],dt [s]\n1.0,2.0\n1.0\n", "line 3 is not a row of 2 numbers"),
        (b"time [s],dt [s]\n1.0,x\n", "line 2 is not a row of 2 numbers"),
        (b"\xff\xfe\x00", "not readable"),
    ],
)
def test_foreign_or_damaged_file(tmp_path, content, message):
    path = tmp_path / "history.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        history.read(path)
    with pytest.raises(InputError, match=message):
        History.reopen(path, 1.0)
    assert path.read_bytes() == content


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        history.read(tmp_path / "history.csv")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_full_disk_stops_the_run(tmp_path):
    table = History(tmp_path / "history.csv", COLUMNS[:1])
    table._stream = open("/dev/full", "wb", buffering=0)
    with pytest.raises(DiskError, match="could not be written: No space left"):
        table.write([0.0])
