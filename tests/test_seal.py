"""Sealed files: any change is found, and a seal that lies about the file is refused before anything is read."""

import json

import h5py
import numpy as np
import pytest
import pyvista
from states import impact

from warpsph.errors import InputError
from warpsph.storage import checkpoint, hdf5, seal, snapshot

RNG = np.random.default_rng(3)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "s_0003.vtkhdf"
    snapshot.write(path, impact(3e-6))
    return path


def resealed(path, change):
    """Change the index of a file and seal it again, as a hostile program would."""
    with path.open("r+b") as stream:
        index = seal.index(stream)
        stream.truncate(index["size"])
        seal.put(stream, change(index) or index)


def put(*keys, value):
    """A change that sets one entry of the index."""

    def change(index):
        for key in keys[:-1]:
            index = index[key]
        index[keys[-1]] = value

    return change


def test_every_flipped_bit_and_every_cut_is_found(path):
    whole = path.read_bytes()
    places = RNG.integers(8 * len(whole), size=200)
    for place in [*places, 8 * len(whole) - 1, 8 * (len(whole) - seal.LAST_BYTES)]:
        content = bytearray(whole)
        content[place // 8] ^= 1 << place % 8
        path.write_bytes(content)
        with pytest.raises(InputError, match="is damaged or no warpsph snapshot"):
            snapshot.read(path)
    for length in [*RNG.integers(len(whole), size=50), 0, 1, len(whole) - 1]:
        path.write_bytes(whole[:length])
        for read in (snapshot.read, snapshot.time):
            with pytest.raises(InputError, match="it has no seal"):
                read(path)


def test_other_programs_do_not_see_the_seal(path):
    state = snapshot.read(path)
    with h5py.File(path) as file:
        assert file.id.get_filesize() == path.stat().st_size
        np.testing.assert_array_equal(file["VTKHDF/PointData/pressure"][...], state.p)
    np.testing.assert_array_equal(pyvista.read(path)["pressure"], state.p)


def test_the_index_knows_what_hdf5_knows(path):
    with h5py.File(path) as file, hdf5.reading(path, "warpsph snapshot", 2) as ours:
        assert {"VTKHDF/Points", "VTKHDF/PointData/damage"} < set(ours.names)
        for name in ours.names:
            theirs = file[name][...]
            assert theirs.dtype == ours.array(name).dtype
            np.testing.assert_array_equal(theirs, ours.array(name))


def test_a_changed_file_is_refused(path):
    with h5py.File(path, "a") as file:
        file["VTKHDF/PointData/pressure"][0] = 1.0
    with pytest.raises(InputError, match="it has no seal: cut short, changed by another program"):
        snapshot.read(path)


PRESSURE = "arrays", "VTKHDF/PointData/pressure"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put(*PRESSURE, value=["<f8", [10**15], 0]), r"of shape \[1000000000000000\] does not fit"),
        (put(*PRESSURE, value=["<f8", [2**32, 2**32, 2**32, 0], 0]), "is damaged"),
        (put(*PRESSURE, value=["<f8", [-1], 0]), "of no kind"),
        (put(*PRESSURE, value=["<f8", [72], -8]), "of no kind"),
        (put(*PRESSURE, value=["<f8", [72], 10**9]), "does not fit"),
        (put(*PRESSURE, value=["<f8", [72.0], 0]), "of no kind"),
        (put(*PRESSURE, value=["|O", [72], 0]), "of no kind"),
        (put(*PRESSURE, value=["|V8", [72], 0]), "of no kind"),
        (put(*PRESSURE, value=["<i4", [72], 0]), "has the type int32"),
        (put(*PRESSURE, value=["<f8", [3], 0]), r"'pressure' has shape \(3,\); expected \(72,\)"),
        (put(*PRESSURE, value=["<f8"]), "not enough values"),
        (put(*PRESSURE, value=None), "is damaged"),
        (put("arrays", value={str(k): ["<f8", [2000], 0] for k in range(100)}), "does not fit"),
        (put("arrays", value={}), "'VTKHDF/PointData/id' is missing"),
        (put("arrays", value=[]), "wrong form"),
        (put("facts", value=3), "wrong form"),
        (put("facts", value={}), "time, step, dim, spacing"),
        (put("facts", "time", value=float("nan")), "time is not a finite number"),
        (put("facts", "time", value=10**400), "time is not a finite number"),
        (put("facts", "time", value="0"), "time is not a finite number"),
        (put("facts", "step", value=-1), "step is not a whole number"),
        (put("facts", "step", value=True), "step is not a whole number"),
        (put("facts", "dim", value=4), "dim is not one of 1, 2, 3"),
        (put("facts", "spacing", value=0.0), "spacing is not a positive number"),
        (put("facts", "h", value=-1.0), "h is not a positive number"),
        (put("facts", "scene", value="\x1b[2Jgone"), "scene is not a printable text"),
        (put("facts", "bodies", value=["block"]), "field 'body' has values outside of 0 to 0"),
        (put("facts", "bodies", value="block"), "bodies is not a list"),
        (put("facts", "materials", value=[]), "field 'material' has values outside"),
        (put("format_version", value="\x1b]0;"), r"has format version '\\x1b\]0;'"),
        (put("format", value=["warpsph snapshot"]), "is no warpsph snapshot"),
        (lambda index: {"facts": {}}, "is no warpsph snapshot"),
    ],
)
def test_an_index_that_lies_is_refused_in_one_line(path, change, message):
    resealed(path, change)
    with pytest.raises(InputError, match=message) as caught:
        snapshot.read(path)
    assert "\n" not in str(caught.value) and "\x1b" not in str(caught.value) and len(str(caught.value)) < 500


@pytest.mark.parametrize("text", [b"[" * 10**6, b"9" * 10**5, b'"a', b"[1]", b"\xff\xfe", b'{"size": 1e999}'])
def test_an_index_that_is_no_record_is_refused(path, text):
    import hashlib

    last = b"\nwarpsph seal %012d %s\n" % (len(text), hashlib.sha256(text).hexdigest().encode())
    path.write_bytes(b"content" + text + last)
    with pytest.raises(InputError, match="is damaged or no warpsph snapshot") as caught:
        snapshot.read(path)
    assert "\n" not in str(caught.value)


def test_the_time_is_read_without_the_particles(path, monkeypatch):
    monkeypatch.setattr(seal, "verify", lambda *_: pytest.fail("the content has been read"))
    assert snapshot.time(path) == 3e-6


@pytest.mark.parametrize(
    ("array", "how", "message"),
    [
        (np.zeros(10), {"chunks": (5,)}, "not stored in one piece"),
        (np.zeros(10), {"fletcher32": True}, "not stored in one piece"),
        (np.zeros(10, dtype=bool), {}, "has the type bool, which is not read back"),
        (np.zeros(10, dtype=complex), {}, "has the type complex128"),
    ],
)
def test_what_would_not_be_read_back_is_not_written(tmp_path, array, how, message):
    with pytest.raises(ValueError, match=message), hdf5.writing(tmp_path / "a.h5", "form", 1, {}) as file:
        file.create_dataset("a", data=array, **how)
    assert not list(tmp_path.iterdir())


def test_facts_come_back_exactly(tmp_path):
    facts = {
        "third": 1.0 / 3.0,
        "low": float("-inf"),
        "tiny": 5e-324,
        "zero": -0.0,
        "é": ["\x00", None, 2**70],
    }
    checkpoint.save(tmp_path / "checkpoint.h5", {}, facts)
    back = checkpoint.load(tmp_path / "checkpoint.h5")[1]
    assert json.dumps(back) == json.dumps(facts)
