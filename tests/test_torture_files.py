"""The trial of broken and hostile files, in short."""

import os
import signal

from warpsph.quality.torture import files
from warpsph.quality.torture.trial import Means


def test_spoilt_files_are_refused_or_make_sense(tmp_path):
    found = files.run(Means(tmp_path, True, lambda _: None))
    assert found.failed == []
    rows = {row[0]: dict(zip(found.header[1:8], map(int, row[1:8]), strict=True)) for row in found.rows}
    assert set(rows) == {
        "snapshot",
        "checkpoint",
        "history",
        "summary",
        "stl",
        "stl (text)",
        "obj",
        "ply",
        "ply (text)",
    }
    assert sum(row["tried"] for row in rows.values()) > 150
    assert all(
        row["refused"] > 0 and row["crash"] == row["hang"] == row["traceback"] == 0 for row in rows.values()
    )


def test_a_process_that_dies_or_hangs_is_told_apart_and_replaced(tmp_path, monkeypatch):
    (tmp_path / "history.csv").write_text("time [s]\n1.0\n")
    with files.Victim() as victim:
        assert victim.read("nonsense", tmp_path)["outcome"] == "traceback"
        victim._process.kill()
        assert victim.read("history", tmp_path / "history.csv")["outcome"] == "crash"
        assert victim.read("history", tmp_path / "history.csv")["outcome"] == "read"
        os.kill(victim._process.pid, signal.SIGSTOP)
        monkeypatch.setattr(files, "PATIENCE", 0.2)
        assert victim.read("history", tmp_path / "history.csv")["outcome"] == "hang"
