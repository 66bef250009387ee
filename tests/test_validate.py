"""Validation: the case table, the comparison, the report, and the measures of hvi_2d on pictures of known answer."""

import numpy as np
import pytest

from warpsph import library
from warpsph.errors import InputError, RunError
from warpsph.quality import cases, report, validate
from warpsph.quality.cases import CASES
from warpsph.quality.cases.tables import Case, Convergence, Figure, Row, Table
from warpsph.state import State

HVI = library.load("hvi_2d")


def test_every_row_can_be_built():
    for case in CASES.values():
        file = library.load(case.scene)
        names = [row.name for part in case.tables for row in part.rows]
        assert len(set(names)) == len(names)
        for part in case.tables:
            for row in part.rows:
                file.build(**row.parameters)


def test_figures_exist():
    summary = {
        "energy_error",
        "momentum_error",
        "steps",
        "wall_s",
        "converted_share",
        "interpenetration",
        "inverted",
    }
    for case in CASES.values():
        measures = set(library.load(case.scene).build().finalize().measures)
        for part in case.tables:
            names = {figure.name for figure in part.figures}
            assert names <= summary | measures
            published = [row.paper for row in part.rows] + list(part.others.values())
            assert all(set(values) <= names for values in published)


def test_full_resolution_of_the_paper():
    for row in (row for part in CASES["hvi_2d"].tables for row in part.rows):
        projectile = 8012 if "rings" in row.name or "adaptle" in row.name else 7830
        assert len(HVI.build(**row.parameters)) == projectile + 10020


def test_verdict_is_at_the_printed_precision():
    length = Figure("d", "d", expected=(1.9, 2.3), decimals=1)
    row = Row("a")
    assert [validate.verdict(length, row, v) for v in (1.86, 1.84, 2.34, 2.36)] == ["✓", "✗", "✓", "✗"]
    strict = Figure("e", "e", expected=(0.0, 1e-10))
    assert [validate.verdict(strict, row, v) for v in (1e-10, 1.1e-10, np.nan)] == ["✓", "✗", "✗"]
    assert validate.verdict(strict, Row("b", unexpected=("e",)), 1.0) == ""
    assert validate.verdict(Figure("f", "f"), row, 1.0) == ""


@pytest.fixture
def small(monkeypatch, tmp_path):
    """A case of two short runs, and a checkout with a place for the report."""
    figures = (
        Figure("l1_rho", "density", style=".3f", expected=(0.0, 0.5)),
        Figure("steps", "steps", style=".0f"),
        Figure("l1_v", "velocity", style=".3f", expected=(2.0, 3.0)),
    )
    rows = (Row("sav1", {"particles": 40}, {"l1_rho": 0.25}), Row("mon", {"particles": 40, "scheme": "mon"}))
    case = Case("sod", (Table("Errors", figures, rows, {"a paper": {"l1_v": 0.5}}),))
    monkeypatch.setattr(validate, "CASES", {"sod": case})
    monkeypatch.setattr(report, "checkout", lambda: tmp_path)
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "validation.md").write_text("# V\n<!-- begin sod -->\nold\n<!-- end sod -->\nend\n")
    return tmp_path


def test_report_of_a_checkout(small, capsys):
    outside = validate.validate("sod", small / "runs")
    assert len(outside) == 2 and outside[0].startswith("sav1: l1_v 0.") and "expected 2 to 3" in outside[0]
    text = (small / "docs" / "validation.md").read_text()
    assert "old" not in text and text.startswith("# V\n") and text.endswith("end\n")
    assert "- date: 20" in text and "### Errors" in text
    assert "(0.250) ✓ |" in text and "| a paper |  |  | (0.500) |" in text
    printed = capsys.readouterr().out
    assert "sod: Errors" in printed and "mon: l1_v" in printed
    assert (small / "runs" / "sod" / "mon" / "summary.json").is_file()


def test_orders_of_convergence(small, monkeypatch, capsys):
    """One order for each doubling, in the report and on the screen; none where a run stopped."""
    errors = {"a, 1": 0.4, "a, 2": 0.2, "a, 4": 0.05, "b, 1": 0.4}
    found = {name: {"measures": {"l1_rho": error}} for name, error in errors.items()} | {"b, 2": "stopped"}
    figure = Figure("l1_rho", "density")
    part = Convergence("Orders", (figure,), {"a": ("a, 1", "a, 2", "a, 4"), "b": ("b, 1", "b, 2")})
    case = Case("sod", (Table("Errors", (figure,), tuple(map(Row, found))),), convergence=part)
    monkeypatch.setattr(validate, "CASES", {"sod": case})
    monkeypatch.setattr(validate, "_run_case", lambda *_: found)
    validate.validate("sod", small / "runs")
    text = (small / "docs" / "validation.md").read_text()
    assert "### Orders" in text and "| a | 1.00, 2.00 |" in text and "| b | nan |" in text
    assert "sod: Orders" in capsys.readouterr().out


def test_report_of_an_installed_package(small, monkeypatch):
    monkeypatch.setattr(report, "checkout", lambda: None)
    validate.validate(None, small / "runs")
    assert (small / "runs" / "sod.md").read_text().startswith("# sod\n")


def test_a_run_that_stops_is_reported(small, monkeypatch):
    def stop(*_, **__):
        raise RunError("stopped at t = 1 s")

    monkeypatch.setattr(validate, "run", stop)
    assert validate.validate("sod", small / "runs") == ["sav1: stopped at t = 1 s", "mon: stopped at t = 1 s"]
    assert "✗ stopped at t = 1 s" in (small / "docs" / "validation.md").read_text()


def test_unknown_case(tmp_path):
    with pytest.raises(InputError, match="case 'hvi' is unknown; allowed: hvi_2d, "):
        validate.validate("hvi", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_documentation_has_a_place_for_every_case():
    text = (report.checkout() / "docs" / "validation.md").read_text(encoding="utf-8")
    for name in cases.CASES:
        assert text.count(f"<!-- begin {name} -->") == text.count(f"<!-- end {name} -->") == 1


SPACING = 4e-4


@pytest.fixture(scope="module")
def coarse():
    return HVI.build(spacing=SPACING).finalize()


def picture(data, x, p_high=None):
    """State of the scene with its particles moved to ``x``."""
    n = len(x)
    zero = np.zeros(n)
    fields = {"x": x, "body": data.body, "p": zero, "p_low": zero, "kernel_type": zero}
    fields["p_high"] = zero if p_high is None else p_high
    return State(0.0, 0, 2, data.spacing, data.h, data.name, data.bodies, ["aluminium"], fields)


def measured(data, state):
    return {name: measure.function(state) for name, measure in data.measures.items()}


def test_measures_at_the_start(coarse):
    found = measured(coarse, picture(coarse, coarse.x))
    assert found["crater_diameter"] == found["cavity_diameter"] == found["projectile_spalled"] == 0.0
    assert found["projectile_extension"] == found["projectile_span"] == pytest.approx(1e-2, abs=SPACING)
    assert found["projectile_travel"] == pytest.approx(-2.3 * SPACING)
    assert found["peak_pressure"] == found["peak_tension"] == 0.0


def perforated(data):
    """The disc flown through; the plate opened by 1 cm, bulged out to 1.6 cm behind, with strays in the hole."""
    x = data.x.copy()
    plate = data.body == 1
    x[~plate, 0] += 20e-3
    side = np.where(x[:, 1] >= 0.0, 1.0, -1.0)
    x[plate, 1] += 5e-3 * side[plate]
    bubble = plate & (np.abs(x[:, 1]) > 20e-3)  # taken off the ends
    k = np.arange(bubble.sum())
    x[bubble, 0] = 5e-3 + 2e-4 * (k // 2)
    x[bubble, 1] = np.where(k % 2, 8e-3, -8e-3)
    strays = np.flatnonzero(plate & ~bubble & (np.abs(x[:, 1]) < 5.5e-3))[:2]
    x[strays] = [(1e-3, 0.0, 0.0), (1e-3, 2e-4, 0.0)]
    return x


def test_crater_and_cavity(coarse):
    found = measured(coarse, picture(coarse, perforated(coarse)))
    assert found["crater_diameter"] == pytest.approx(1e-2, abs=2 * SPACING)
    assert found["cavity_diameter"] == pytest.approx(1.6e-2)


def test_spalled_particles_are_no_bulk(coarse):
    x = coarse.x.copy()
    disc = np.flatnonzero(coarse.body == 0)
    x[disc[:3], 0] += 50e-3
    found = measured(coarse, picture(coarse, x))
    assert found["projectile_spalled"] == 3
    assert found["projectile_span"] == pytest.approx(1e-2, abs=SPACING)
    assert found["projectile_travel"] < 0.0


def test_wings_count_in_the_span_only(coarse):
    x = coarse.x.copy()
    disc = np.flatnonzero(coarse.body == 0)
    top = disc[np.argsort(-x[disc, 1])[:5]]
    x[top, 0] = x[disc, 0].min() - 2.0 * SPACING * np.arange(5)
    x[top, 1] = 2e-3
    found = measured(coarse, picture(coarse, x))
    assert found["projectile_extension"] == pytest.approx(1e-2, abs=SPACING)
    assert found["projectile_span"] > 1e-2 + 6.0 * SPACING


def test_a_state_that_is_not_finite_can_be_measured(coarse):
    found = measured(coarse, picture(coarse, np.full_like(coarse.x, np.nan)))
    assert found["crater_diameter"] == 0.0 and np.isnan(found["projectile_extension"])


@pytest.mark.parametrize("scheme", ["sav1", "mon-mixed-as"])
def test_scheme_is_one_of_the_table(scheme):
    assert HVI.build(scheme=scheme).numerics.scheme == scheme


def test_unknown_scheme():
    with pytest.raises(
        InputError, match=r"scheme 'sav3' is unknown .did you mean 'sav2'.*; allowed: sav1, sav1-as"
    ):
        HVI.build(scheme="sav3")
