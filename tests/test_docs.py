"""Documentation that must stay true: scenes run as printed, links lead somewhere, tables agree with the code."""

import json
import re
import runpy
from pathlib import Path

import pytest

from warpsph import cli
from warpsph.quality import report
from warpsph.schemes import SCHEMES

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


def printed_scene(page: str) -> str:
    """The one Python block of a page."""
    (scene,) = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    return scene


@pytest.mark.parametrize(
    ("page", "options"),
    [
        ("README.md", ["--spacing", "1e-3", "--until", "2e-7"]),
        ("docs/scenes.md", ["--spacing", "2e-3", "--until", "2e-7"]),
    ],
)
def test_printed_scene_runs(page, options, tmp_path):
    path = tmp_path / "printed.py"
    path.write_text(printed_scene(page))
    with pytest.raises(SystemExit) as ended:
        cli.main(["run", str(path), *options, "--no-frames", "--out", str(tmp_path / "out")])
    assert ended.value.code == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["steps"] > 0 and summary["measures"] and summary["energy_error"] < 1e-12


def test_readme_scene_is_short():
    assert len([line for line in printed_scene("README.md").splitlines() if line.strip()]) <= 20


def test_readme_names_every_scheme():
    table = (ROOT / "README.md").read_text().partition("<!-- schemes -->")[2].partition("\n\n")[0]
    first_column = "".join(row.split("|")[1] for row in table.splitlines()[3:])
    assert set(re.findall(r"`(\w+)`", first_column)) == {name.split("-")[0] for name in SCHEMES}


def test_symbols_are_those_of_the_code():
    rows = runpy.run_path(str(ROOT / "scripts" / "symbols"))["rows"]()
    page = (ROOT / "docs" / "symbols.md").read_text()
    table = page.partition("<!-- begin symbols -->")[2].partition("<!-- end symbols -->")[0]
    assert table.strip().splitlines()[2:] == report.markdown((), rows).splitlines()[2:], "run scripts/symbols"


def test_benchmarks_have_a_place_for_the_report():
    page = (ROOT / "docs" / "benchmarks.md").read_text()
    for name in ("cpu", "cuda"):
        assert page.count(f"<!-- begin {name} -->") == page.count(f"<!-- end {name} -->") == 1


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_and_file_names_lead_somewhere(page):
    text = page.read_text()
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
        assert "://" in target or (page.parent / target).exists(), target
    for name in re.findall(r"`((?:kernels|scenes|warpsph|tests|scripts|docs)/[\w./]+)`", text):
        assert (ROOT / name).exists(), name
