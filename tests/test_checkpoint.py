import h5py
import numpy as np
import pytest

from warpsph.errors import InputError, RunError
from warpsph.storage import checkpoint

RNG = np.random.default_rng(0)
ARRAYS = {
    "rho": RNG.normal(size=1000),
    "x": RNG.normal(size=(1000, 3)).astype(np.float32),
    "id": RNG.permutation(1000).astype(np.int32),
    "sig": np.full((1000, 3, 3), [np.nan, -0.0, np.inf]),
    "empty": np.zeros((0, 3)),
    "time": np.float64(1.0 / 3.0),
}
INFO = {
    "time": 0.1 + 0.2,
    "scene": "hvi_2d",
    "parameters": {"scheme": "sav1", "size": None},
    "list": [1, 2.5, "é"],
}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "checkpoint.h5"
    checkpoint.save(path, ARRAYS, INFO)
    return path


def test_everything_comes_back_bit_for_bit(path):
    arrays, info = checkpoint.load(path)
    assert info == INFO
    assert list(arrays) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert arrays[name].dtype == array.dtype and arrays[name].shape == array.shape
        assert np.asarray(arrays[name]).tobytes() == np.asarray(array).tobytes()


def test_saving_replaces_the_older_one(path):
    checkpoint.save(path, {"x": np.zeros(3)}, {"step": 2})
    arrays, info = checkpoint.load(path)
    assert list(arrays) == ["x"] and info == {"step": 2}
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_flipped_bit_is_found(path):
    content = bytearray(path.read_bytes())
    content[content.index(ARRAYS["rho"][500].tobytes())] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"checkpoint.h5 is damaged"):
        checkpoint.load(path)


def test_truncated_file_is_refused(path):
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(InputError, match=r"checkpoint.h5 is damaged or no warpsph checkpoint"):
        checkpoint.load(path)


def test_missing_or_foreign_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        checkpoint.load(tmp_path / "checkpoint.h5")
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = np.zeros(3)
    with pytest.raises(InputError, match="no warpsph checkpoint"):
        checkpoint.load(tmp_path / "foreign.h5")


def test_other_version_is_refused(path, monkeypatch):
    monkeypatch.setattr(checkpoint, "VERSION", 99)
    checkpoint.save(path, ARRAYS, INFO)
    monkeypatch.undo()
    with pytest.raises(
        InputError, match=f"has format version 99; this warpsph reads version {checkpoint.VERSION}"
    ):
        checkpoint.load(path)


def test_unwritable_folder_stops_the_run(tmp_path):
    with pytest.raises(RunError, match="could not be written: No such file or directory"):
        checkpoint.save(tmp_path / "missing" / "checkpoint.h5", ARRAYS, INFO)
