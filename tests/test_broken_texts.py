"""Texts, facts and numbers that are read back: what is odd is refused in one line, or shown as it is."""

import contextlib
import copy
import json
import os

import numpy as np
import pytest
from states import impact
from tools import body, jittered

from warpsph import info, library, plot, scalars
from warpsph.device import blocks
from warpsph.drawing import look
from warpsph.errors import InputError
from warpsph.quality.torture.mutations import ODD
from warpsph.running import origin
from warpsph.storage import checkpoint, history, text


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"time [s],a [1]\n1.0," + b"9" * 200_000 + b"\n", "field larger than field limit"),
        (b"time [s],\x1b[2J [1]\n1.0,2.0\n", "is no history"),
        (b"time [s],a [\x1b]\n1.0,2.0\n", "is no history"),
        (b"time [s],a [1],a [1]\n1.0,2.0,3.0\n", "is no history"),
        (b"time [s],a [1]\n1.0,\0\n", "line 2 is not a row"),
        (b"\0" * 1000, "is no history"),
    ],
)
def test_odd_histories(tmp_path, content, message):
    (tmp_path / "history.csv").write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        history.read(tmp_path / "history.csv")
    assert str(caught.value).isprintable()


def test_a_text_is_a_plain_file_of_sensible_length(tmp_path):
    (tmp_path / "long").write_text("12345")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    (tmp_path / "latin").write_bytes("é".encode("latin-1"))
    assert text.read(tmp_path / "long", "note", 5) == "12345"
    for name, cause in (
        ("long", "it has 5 bytes; allowed: 4"),
        ("pipe", "it is no plain file"),
        (".", "it is no plain file"),
        ("loop", "Too many levels of symbolic links"),
        ("none", "No such file"),
        ("latin", "can't decode"),
    ):
        with pytest.raises(InputError, match=f"is not readable as a note .*{cause}"):
            text.read(tmp_path / name, "note", 4 if name == "long" else 100)


@pytest.mark.parametrize(
    "content", ["[" * 100_000, '{"a":' * 600 + "1" + "}" * 600, "[1]", "3", '{"warnings": 5}', "9" * 5000, '{"a": '],
    ids=["deep", "nested", "list", "number", "warnings", "digits", "cut"],
)  # fmt: skip
def test_odd_summaries_are_refused(tmp_path, content):
    (tmp_path / "summary.json").write_text(content)
    with pytest.raises(InputError, match=r"summary\.json") as caught:
        info.describe(tmp_path)
    assert str(caught.value).isprintable() and len(str(caught.value)) < 400


def test_odd_entries_of_a_summary_are_shown_as_they_are(tmp_path):
    odd = {
        "scene": "\x1b[2J",
        "\n": [{"a": None}],
        "wall_s": float("inf"),
        "time": float("nan"),
        "dt_min": 1e308,
        "steps": 10**50,
    }
    (tmp_path / "summary.json").write_text(json.dumps(odd | {"warnings": ["\x07", 3]}))
    shown = info.describe(tmp_path)
    assert "\\x1b[2J" in shown and "warning: \\x07\nwarning: 3" in shown
    assert all(line.isprintable() for line in shown.split("\n"))


def test_odd_scene_files(tmp_path, monkeypatch):
    path = tmp_path / "scene.py"
    path.write_text("x = " + "(" * 100_000)
    with pytest.raises(InputError, match=r"scene\.py"):
        library.load(path)
    path.write_text("from warpsph import Scene\ndef build(speed: float = 1.0): return None\n")
    for values in ({"self": 1}, {"speed": 10**400}, {"speed": [1.0]}):
        with pytest.raises(InputError, match=r"allowed: (speed|number)"):
            library.load(path).build(**values)
    monkeypatch.setattr(library, "LONGEST", 10)
    with pytest.raises(InputError, match="is not readable as a scene"):
        library.load(path)


CASE = {
    "value": float("inf"),
    "particle": 1,
    "body": "a",
    "material": "b",
    "position": [0.0],
    "time": 1.0,
    "step": 64,
}
FOUND = {"limit": 0.0, "looks": 1, "particles": 2, "first": CASE, "action": "warn", "worst": CASE}
FACTS = {
    "time": 1.0, "frames": True, "until": 2.0, "row_time": 1.0, "device": "cpu", "precision": "float64", "device_name": "", "version": "", "warp": "",
    "parameters": {}, "scene_sha256": "",
    "solver": {
        "precision": "float64", "cuda": False, "batch": 32, "builds": 1, "tile_width": 0.1,
        "watch": {"guards": {}, "start": None, "found": {"density": FOUND}},
    },
    "balance": {"start": {"work": 0.0}, "energy_error": float("inf"), "momentum_error": 0, "angular_momentum_error": 0.0, "kinetic": 1.0},
}  # fmt: skip
JOB = {
    "interval": 0.5, "row_interval": 0.01, "ends": [2.0], "due": 3, "next_snapshot": 3, "next_row": 1.0, "neighbours": [3.0],
    "peaks": {}, "remarks": [], "wall": 1.0, "step_wall": 1.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("change", "job", "message"),
    [
        ({"until": float("inf")}, {}, "until is not a positive number"),
        ({"parameters": [1]}, {}, "parameters is not a record"),
        ({"device": "\x1b"}, {}, "device is not a printable text"),
        ({}, {"next_row": -1.0}, "next_row is not a number that is not negative"),
        ({}, {"interval": 5e-324}, "outputs have no end"),
        ({}, {"neighbours": ["1"]}, "neighbours is not a finite number"),
        (
            {"balance": {"start": {}}},
            {},
            "energy_error, momentum_error, angular_momentum_error, kinetic is missing",
        ),
        ({"solver": {"precision": "float64", "cuda": 0}}, {}, "batch, builds, tile_width, watch is missing"),
        ({}, {"peaks": {"pressure": "1"}}, "peaks is not a number"),
    ],
)
def test_a_run_goes_on_from_sound_facts_only(tmp_path, change, job, message):
    def check(change, job):
        return origin.checked(
            checkpoint.Found({}, FACTS | {"job": JOB | job} | change, tmp_path / "checkpoint.h5", [])
        )

    assert check({}, {}).info == FACTS | {"job": JOB}
    assert check({}, {"finish": 1}).info == FACTS | {"job": JOB}, "what no job has is left out"
    with pytest.raises(InputError, match=rf"checkpoint\.h5 is damaged .*{message}"):
        check(change, job)


def places(facts, above=()):
    """Where each fact of a checkpoint is, those within others too."""
    for name, value in facts.items():
        yield (*above, name)
        if isinstance(value, dict):
            yield from places(value, (*above, name))


def test_whatever_is_odd_in_a_checkpoint_is_refused_or_makes_sense(tmp_path):
    """Each fact in turn takes each odd value, and is missing."""
    whole = FACTS | {"job": JOB}
    for *above, name in places(whole):
        for odd in (*ODD, None):
            info = inner = copy.deepcopy(whole)
            for key in above:
                inner = inner[key]
            del inner[name]
            if odd is not None:
                inner[name] = odd
            with contextlib.suppress(InputError):
                checked = origin.checked(checkpoint.Found({}, info, tmp_path, [])).info
                assert {type(checked[key]) for key in ("time", "until", "row_time")} == {float}
                assert [checked[key].keys() for key in ("job", "solver", "balance")] == [
                    whole[key].keys() for key in ("job", "solver", "balance")
                ]


def test_arrays_of_a_checkpoint_fit_the_run():
    going = body(2, jittered(2, 4))
    arrays, info = going.save()
    arrays = {name: array.copy() for name, array in arrays.items()}
    going.restore(arrays, info)
    n = going.particles.n
    for name, array, message in (
        ("x", arrays["x"][:-1], "holds x as float64 of shape"),
        ("x_listed", arrays["x"][:-1], "holds x_listed as float64 of shape"),
        ("clock", np.zeros((3, 3)), "holds clock as"),
        ("tau", arrays["tau"][:, :3], "this run needs shape"),
        ("rho", arrays["rho"].astype(np.int32), "holds rho as int32"),
        ("body", np.full(n, 1, dtype=np.int32), "stand for nothing"),
        ("mat", np.full(n, -1, dtype=np.int32), "stand for nothing"),
        ("id", np.zeros(n, dtype=np.int32), "stand for nothing"),
    ):
        with pytest.raises(InputError, match=message):
            going.restore(arrays | {name: array}, info)


def test_figures_without_bounds_do_not_stop_a_description():
    state = impact()
    state.fields["F"][3] = np.nan
    state.fields["F"][4, 0, 1] = np.inf
    state.fields["F"][5] = 1e308
    strain = scalars.scalar(state, "equivalent_strain").values
    assert np.flatnonzero(~np.isfinite(strain)).tolist() == [3, 4, 5]
    assert "3 not finite" in info.describe_state(state)


def test_sums_without_a_value():
    assert blocks.total(np.array([1e16, 1.0, -1e16])) == 1.0
    assert np.isnan(blocks.total(np.array([np.inf, -np.inf])))
    assert blocks.total(np.array([1e308, 1e308])) == np.inf


def test_what_cannot_be_drawn_is_refused(tmp_path):
    state = impact()
    state.fields = {name: np.repeat(array, 60, axis=0) for name, array in state.fields.items()}
    state.fields["x"] = np.zeros_like(state.fields["x"])
    with pytest.raises(InputError, match="nothing can be drawn"):
        look.choose([state])
    names = ["time [s]", *(f"q{k} [1]" for k in range(200))]
    (tmp_path / "history.csv").write_text(",".join(names) + "\n" + ",".join("1" * len(names)) + "\n")
    with pytest.raises(InputError, match="has 200 quantities; a plot holds up to 120"):
        plot.plot(tmp_path)


def test_a_plot_takes_any_numbers(tmp_path):
    rows = [
        "time [s],a_error [1],$\\frac{ [Pa],b [$x^$]",
        "0,1e308,nan,-1e308",
        "1e308,inf,-inf,1e308",
        "nan,0,1,2",
    ]
    (tmp_path / "history.csv").write_text("\n".join(rows) + "\n")
    assert plot.plot(tmp_path).stat().st_size > 10_000
