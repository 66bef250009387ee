import errno
import json
import os
from pathlib import Path

import h5py
import numpy as np
import pytest
from states import impact

from warpsph.errors import InputError, RunError
from warpsph.fields import FIELDS
from warpsph.storage import checkpoint, snapshot


@pytest.mark.parametrize("real", [np.float32, np.float64])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_snapshot_comes_back_bit_for_bit(tmp_path, dim, real):
    state = impact(3e-6, dim, real)
    snapshot.write(tmp_path / "s_0000.vtkhdf", state)
    back = snapshot.read(tmp_path / "s_0000.vtkhdf")
    for name in ("time", "step", "dim", "spacing", "h", "scene", "bodies", "materials"):
        assert getattr(back, name) == getattr(state, name)
        assert type(getattr(back, name)) is type(getattr(state, name))
    assert back.fields.keys() == state.fields.keys()
    for name, array in state.fields.items():
        assert back.fields[name].dtype == array.dtype
        np.testing.assert_array_equal(back.fields[name], array)


def test_pyvista_opens_a_snapshot_as_it_is(tmp_path):
    import pyvista

    state = impact(3e-6)
    snapshot.write(tmp_path / "s_0000.vtkhdf", state)
    mesh = pyvista.read(tmp_path / "s_0000.vtkhdf")
    assert mesh.n_points == mesh.n_verts == mesh.n_cells == len(state.x)
    np.testing.assert_array_equal(mesh.points, state.x)
    np.testing.assert_array_equal(mesh["pressure"], state.p)
    np.testing.assert_array_equal(mesh["deviatoric_stress"], state.tau.reshape(-1, 9))
    assert mesh["id"].dtype == mesh["body"].dtype == mesh["kernel_type"].dtype == np.int32
    assert mesh.field_data["TimeValue"][0] == 3e-6
    assert list(mesh.field_data["bodies"]) == state.bodies


def test_every_output_field_has_unit_and_meaning(tmp_path):
    snapshot.write(tmp_path / "s_0000.vtkhdf", impact())
    with h5py.File(tmp_path / "s_0000.vtkhdf") as file:
        data = file["VTKHDF/PointData"]
        for f in FIELDS:
            if f.output:
                array = file["VTKHDF/Points"] if f.name == "x" else data[f.title]
                assert (array.attrs["unit"], array.attrs["meaning"]) == (f.unit, f.meaning)
        assert file.attrs["generator"].startswith("warpsph ")


def test_fields_without_output_stay_out(tmp_path):
    state = impact()
    state.fields["cs"] = state.rho.copy()
    snapshot.write(tmp_path / "s_0000.vtkhdf", state)
    assert "cs" not in snapshot.read(tmp_path / "s_0000.vtkhdf").fields


@pytest.mark.parametrize("length", [0, 100, 20_000])
def test_truncated_file_is_refused(tmp_path, length):
    path = tmp_path / "s_0000.vtkhdf"
    snapshot.write(path, impact())
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(InputError, match=r"s_0000.vtkhdf is damaged or no warpsph snapshot") as caught:
        snapshot.read(path)
    assert "\n" not in str(caught.value)


def test_foreign_files_are_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        snapshot.read(tmp_path / "missing.vtkhdf")
    (tmp_path / "text").write_text("hello\n" * 100)
    with pytest.raises(InputError, match="damaged or no warpsph snapshot"):
        snapshot.read(tmp_path / "text")
    with h5py.File(tmp_path / "foreign", "w") as file:
        file["VTKHDF/Points"] = np.zeros((3, 3))
    with pytest.raises(InputError, match="no warpsph snapshot"):
        snapshot.read(tmp_path / "foreign")
    checkpoint.save(tmp_path / "checkpoint.h5", {}, {})
    with pytest.raises(InputError, match="its format is 'warpsph checkpoint'"):
        snapshot.read(tmp_path / "checkpoint.h5")


def test_full_disk_loses_nothing(tmp_path, monkeypatch):
    path = tmp_path / "s_0000.vtkhdf"
    snapshot.write(path, impact(1e-6))

    def full(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RunError, match=r"s_0000.vtkhdf could not be written: No space left on device"):
        snapshot.write(path, impact(2e-6))
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    assert snapshot.read(path).time == 1e-6


def test_failure_while_writing_leaves_no_file(tmp_path):
    state = impact()
    state.fields["p"] = state.fields["p"].astype(object)
    with pytest.raises(TypeError):
        snapshot.write(tmp_path / "s_0000.vtkhdf", state)
    assert not list(tmp_path.iterdir())


def test_the_index_loses_snapshots_before_they_go(tmp_path, monkeypatch):
    for number in (1, 2, 3):  # somebody has taken the first one away
        snapshot.write(tmp_path / f"block_{number:04d}.vtkhdf", impact())
    index, unlink, gone = snapshot.series(tmp_path, snapshot.times(tmp_path)), Path.unlink, []

    def checked(path, **options):
        if path.suffix == ".vtkhdf":
            gone.append(path.name)
            names = [entry["name"] for entry in json.loads(index.read_text())["files"]]
            assert names == ["block_0001.vtkhdf"]
        unlink(path, **options)

    monkeypatch.setattr(Path, "unlink", checked)
    snapshot.drop(tmp_path, 4, snapshot.times(tmp_path, 4))
    assert not gone
    snapshot.drop(tmp_path, 2, snapshot.times(tmp_path, 2))
    assert gone == ["block_0002.vtkhdf", "block_0003.vtkhdf"]
    assert [path.name for path in snapshot.find(tmp_path)] == ["block_0001.vtkhdf"]


def test_series_lists_the_snapshots_in_time_order(tmp_path):
    assert snapshot.series(tmp_path, {}) is None
    (tmp_path / "snapshots").mkdir()
    for number in (10_000, 2, 0):
        snapshot.write(tmp_path / "snapshots" / f"block_{number:04d}.vtkhdf", impact(number * 1e-9))
    (tmp_path / "snapshots" / "notes_a.vtkhdf").touch()
    names = ["block_0000.vtkhdf", "block_0002.vtkhdf", "block_10000.vtkhdf"]
    assert [path.name for path in snapshot.find(tmp_path)] == names
    assert snapshot.find(tmp_path / "snapshots") == snapshot.find(tmp_path)
    index = snapshot.series(tmp_path, snapshot.times(tmp_path))
    assert index == tmp_path / "snapshots" / "block.vtkhdf.series"
    content = json.loads(index.read_text())
    assert content["file-series-version"] == "1.0"
    assert [entry["name"] for entry in content["files"]] == names
    assert [entry["time"] for entry in content["files"]] == [0.0, 2e-9, 1e-5]
