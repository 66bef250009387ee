"""The check of a GPU, rehearsed on the CPU: what it covers, what it calls wrong, and that nothing is lost."""

import sys
import time

import pytest

from warpsph.quality import gpu_check, gpu_stages
from warpsph.quality.gpu_check import LIMITS, Sheet, run_stage, write_report
from warpsph.quality.gpu_stages import STAGES, WORST, Comparison, compare_one, comparisons, impact, judge
from warpsph.schemes import SCHEMES


def found(**changed):
    """A comparison in which all is well, but for what is given."""
    small = dict.fromkeys(("x", "v", "rho", "p"), 1e-14)
    return {"difference": small, "expected": small, "energy": 1e-15, "repeats": True} | changed


def test_every_scheme_is_compared_in_both_dimensions_and_precisions():
    plain = {(c.scheme, c.dim, c.precision) for c in comparisons(quick=False) if not c.contact}
    assert plain == {(name, dim, real) for name in SCHEMES for dim in (2, 3) for real in WORST}
    assert any(c.contact for c in comparisons(quick=False))


def test_every_stage_has_a_limit_and_all_of_them_eight_minutes():
    assert list(STAGES) and set(STAGES) == set(LIMITS)
    assert sum(LIMITS.values()) <= 480


@pytest.mark.parametrize("dim", [2, 3])
def test_the_impact_has_about_as_many_particles_as_asked_for(dim):
    data = impact(dim, 3000).finalize()
    assert len(data.x) == pytest.approx(3000, rel=0.1)


def test_the_same_device_passes():
    case = Comparison("adaptle-mixed-as", 2, "float64", contact=True)
    result = compare_one(case, "cpu", quick=True)
    assert judge(case, result) == "" and result["steps"] > 20
    assert max(result["difference"].values()) == 0.0 < min(result["expected"].values())


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"difference": {"x": 1e-11}}, "x differs"),
        ({"difference": {"x": float("nan")}}, "x differs"),
        ({"difference": {"x": 1e-6}, "expected": {"x": 1e-7}}, "allowed 1e-09"),
        ({"repeats": False}, "other bits"),
        ({"energy": 1e-9}, "energy"),
        ({"energy": float("nan")}, "energy"),
    ],
)
def test_what_is_wrong_is_said(changed, told):
    assert judge(Comparison("sav1", 2, "float64"), found()) == ""
    assert told in judge(Comparison("sav1", 2, "float64"), found(**changed))


def test_a_scheme_that_loses_energy_as_published_may():
    assert judge(Comparison("av-explicit", 2, "float64"), found(energy=1e-3)) == ""


def test_what_was_found_before_a_stage_was_cut_off_is_in_the_report(tmp_path):
    sheet = Sheet(tmp_path / "graph.json", "Graphs", ("scheme", "time"))
    sheet.add(["sav1", "3"], {"seconds": 3.0})
    report = (tmp_path / "report.md").read_text()
    assert "## Graphs (cut off)" in report and "| sav1 | 3 |" in report
    sheet.done = True
    sheet.failed.append("too slow")
    sheet.write()
    write_report(tmp_path)
    assert "cut off" not in (tmp_path / "report.md").read_text()
    assert "**failed:** too slow" in (tmp_path / "report.md").read_text()


def test_a_stage_that_hangs_is_stopped(tmp_path):
    start = time.monotonic()
    command = [sys.executable, "-c", "import time; print('begun', flush=True); time.sleep(60)"]
    assert "stopped at its limit" in run_stage(command, tmp_path / "log.txt", 2.0)
    assert time.monotonic() - start < 20.0
    assert "begun" in (tmp_path / "log.txt").read_text()


def test_a_stage_that_crashes_costs_no_other(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(gpu_check, "LIMITS", {"facts": 60, "graph": 60})
    code = gpu_check.main(["--device", "cuda:99", "--quick", "--out", str(tmp_path)])
    told = capsys.readouterr().out
    assert code == 1 and "facts" in told and "graph" in told and told.count("ended with code 1") == 2
    assert (tmp_path / "report.md").read_text().count("(cut off)\n\n**failed:** ended with code 1") == 2


def test_a_stage_has_the_time_that_is_left_when_it_begins(tmp_path, monkeypatch):
    """Not counted from when its process has come to life, which may take seconds."""
    seen = []
    monkeypatch.setattr(gpu_check, "LIMITS", {"facts": 60})
    monkeypatch.setattr(
        gpu_check, "run_stage", lambda command, log, limit: seen.append((command, limit)) or ""
    )
    start = time.monotonic()
    gpu_check.main(["--out", str(tmp_path)])
    ((command, limit),) = seen
    told = float(command[command.index("--deadline") + 1])
    assert told - start == pytest.approx(60.0 - gpu_check.TAIL, abs=1.0)
    assert limit == pytest.approx(60.0, abs=1.0)


def test_tests_that_do_not_stop_are_killed(tmp_path, monkeypatch):
    """What the stage knows is in the report all the same."""
    monkeypatch.setattr(gpu_stages, "TAIL_OF_TESTS", 0.1)
    code = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); time.sleep(60)"
    fake = tmp_path / "python"
    fake.write_text(f"#!/bin/sh\nexec {sys.executable} -c '{code}'\n")
    fake.chmod(0o755)
    monkeypatch.setattr(gpu_stages.sys, "executable", str(fake))
    sheet = Sheet(tmp_path / "tests.json", "Tests", ("passed", "failed", "skipped"))
    start = time.monotonic()
    gpu_stages.tests(sheet, "cpu", True, start + 1.0)
    assert time.monotonic() - start < 20.0
    assert "Stopped at the time limit" in sheet.notes[0] and sheet.failed == ["no test passed"]


def test_a_comparison_whose_time_is_up_does_not_wait_for_its_workers(tmp_path, monkeypatch):
    submit = gpu_stages.ProcessPoolExecutor.submit
    asleep = lambda pool, *given: submit(pool, time.sleep, 60.0)  # noqa: E731
    monkeypatch.setattr(gpu_stages, "comparisons", lambda quick: ["a case"])
    monkeypatch.setattr(gpu_stages.ProcessPoolExecutor, "submit", asleep)
    sheet = Sheet(tmp_path / "compare.json", "Comparison", ("scheme",))
    start = time.monotonic()
    gpu_stages.compare(sheet, "cpu", True, start + 1.0)
    assert time.monotonic() - start < 20.0 and "1 of 1 were not reached." in sheet.notes
