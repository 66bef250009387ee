"""The benchmark: the block repeats and flows, the model is that of the kernels, and results are kept per device."""

import json

import numpy as np
import pytest
import warp as wp

from warpsph import cli
from warpsph.device.launch import Launcher
from warpsph.errors import InputError
from warpsph.info import table
from warpsph.kernels.ceilings import CHAINS, make_ceilings
from warpsph.kernels.packets import PACKET
from warpsph.memory.usage import of_search, usage
from warpsph.quality import bench, block, ceilings, performance, report, series, startup, trial
from warpsph.quality.stopwatch import REST, ROWS, kernel_times, one_by_one, short_name
from warpsph.quality.traffic import LOOPS, touched_by
from warpsph.solver import PRECISIONS, Solver


@pytest.fixture
def quick(monkeypatch):
    """Few steps, little memory, and no start of a process."""
    monkeypatch.setattr(trial, "WARM_UP", 2)
    monkeypatch.setattr(trial, "STEPS", 4)
    monkeypatch.setattr(trial, "REPEATS", 2)
    monkeypatch.setattr(ceilings, "COPIED_CPU", 1 << 20)
    monkeypatch.setattr(ceilings, "ROUNDS", 10)
    monkeypatch.setattr(startup, "measure", lambda scene, device: START)


START = {"cold": 20.0, "warm": 2.0}


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout of its own, with a page for the results."""
    (tmp_path / "docs" / "images").mkdir(parents=True)
    (tmp_path / "docs" / "performance.md").write_text(
        "a\n<!-- begin performance -->\n<!-- end performance -->\nb\n"
    )
    monkeypatch.setattr(report, "checkout", lambda: tmp_path)
    return tmp_path


@pytest.mark.parametrize("dim", [2, 3])
def test_the_block_is_the_same_every_time(dim):
    first, second = (block.block(dim, 1000).finalize() for _ in range(2))
    np.testing.assert_array_equal(first.x, second.x)
    np.testing.assert_array_equal(first.v, second.v)
    assert len(first.x) == round(1000 ** (1 / dim)) ** dim
    lattice = np.round(first.x[:, :dim] / block.SPACING - 0.5) + 0.5
    off = np.abs(first.x[:, :dim] / block.SPACING - lattice).max()
    assert 0.9 * block.JITTER < off <= block.JITTER + 1e-12


def test_the_flow_shears_and_converges():
    """Its gradient has no trace but for the convergent part."""
    x, step = np.random.default_rng(1).uniform(0.0, 0.1, (50, 3)), 1e-9
    rows = [(block.velocity(x + step * e) - block.velocity(x - step * e)) / (2.0 * step) for e in np.eye(3)]
    k = 2.0 * np.pi / (block.WAVE * block.SPACING)
    div = sum(row[:, c] for c, row in enumerate(rows))
    expected = -block.SPEED * block.CONVERGENCE * k * np.cos(k * x).sum(axis=1)
    np.testing.assert_allclose(div, expected, atol=1e-4 * block.SPEED * k)
    assert np.abs(rows[0][:, 1]).max() > 0.5 * block.SPEED * k


@pytest.mark.parametrize("dim", [2, 3])
def test_neighbour_rows_are_really_rebuilt(dim):
    solver = Solver(block.block(dim, 1000).finalize())
    before = solver.neighbours.builds
    series.advance(solver, 40)
    assert solver.neighbours.builds - before >= 2
    state = solver.state()
    assert state.ep.max() > 0.01 and 0.9 < (state.rho / 2785.0).min() and (state.rho / 2785.0).max() < 1.1


@pytest.mark.parametrize("real", [wp.float32, wp.float64])
def test_ceilings(real, quick):
    found = ceilings.measure(Launcher("cpu", 1), real)
    assert found.bandwidth > 0.0 and found.flops > 0.0


def test_kernels_of_the_ceilings_do_what_is_counted(precision):
    kernels, launcher, n = make_ceilings(precision), Launcher("cpu", 2), 1500
    real = np.dtype(wp.dtype_to_numpy(precision.real))
    numbers = np.arange(n * PACKET // real.itemsize, dtype=real).reshape(n, -1)
    with wp.ScopedDevice("cpu"):
        source, target = wp.array(numbers, dtype=kernels.packet), wp.zeros(n, dtype=kernels.packet)
        total = wp.zeros(n, dtype=precision.real)
    launcher.launch(kernels.copy, n, source=source, target=target)
    np.testing.assert_array_equal(target.numpy(), numbers)
    launcher.launch(kernels.multiply_add, n, rounds=3, factor=0.5, total=total)
    first = np.arange(n)[:, None] + np.arange(CHAINS)
    for _ in range(3):
        first = 0.5 * first + 0.5
    np.testing.assert_allclose(total.numpy(), first.sum(axis=1), rtol=1e-6)


def test_memory_is_counted_array_by_array():
    solver = Solver(block.block(3, 1000).finalize(), precision="float32")
    found, n = usage(solver), solver.particles.n
    assert found["neighbours.x_listed"] == 12 * n
    assert of_search(found) > found["neighbours.block"] + 12 * n
    assert sum(found.values()) > of_search(found) + 200 * n


def test_arrays_that_a_kernel_is_launched_with():
    """drift: x and v, each of three numbers; dt has one entry and does not count."""
    solver = Solver(block.block(2, 1000).finalize(), threads=1)
    found = touched_by(solver, lambda: series.advance(solver, 3))
    assert found["drift"] == 2 * 3 * 8
    assert "execute" not in vars(solver.launcher)


def test_every_pair_loop_of_the_model_is_one_of_the_cases(quick):
    launched = set()
    for case in (case for case in trial.CASES.values() if case.scheme and case.dim == 2):
        solver = Solver(trial.with_scheme(block.block(2, 400).finalize(), case), threads=1)
        launched |= set(touched_by(solver, lambda solver=solver: series.advance(solver, 2)))
    assert set(LOOPS) <= launched


def test_a_pair_in_figures():
    """The velocity gradient in 3D: x_b, v_b, V_b, the slope and the entry; 2 d² + 4 d operations."""
    loop = LOOPS["velocity_gradient"]
    assert loop.bytes(3, 8) == 8 * (3 + 3 + 1) + 4 and loop.operations(3) == 50


def test_stopwatch_leaves_the_solver_as_it_was():
    solver = Solver(block.block(2, 400).finalize())
    spent = kernel_times(solver, lambda: series.advance(solver, 12))
    assert {"momentum", "kick", "drift", "decide", ROWS, REST} <= set(spent)
    assert all(seconds >= 0.0 for name, seconds in spent.items() if name != REST)
    assert "execute" not in vars(solver.launcher) and "build" not in vars(solver.neighbours)


def test_a_captured_graph_is_taken_apart_while_kernels_are_timed():
    class Steps:
        captured = True

    solver = Steps()
    solver.program = Steps()
    with one_by_one(solver):
        assert solver.program.captured is False
    assert solver.program.captured is True


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("forward kernel make_momentum__locals__momentum", "momentum"),
        ("forward kernel make_kinematics__locals__velocity_gradient_0a1b2c3d", "velocity_gradient"),
        ("fill", "fill"),
    ],
)
def test_kernels_have_short_names(key, name):
    assert short_name(key) == name


def test_everything_is_measured(quick, checkout, tmp_path):
    path = tmp_path / "all.json"
    text = bench.bench(
        ["adaptle-2d", "tl-2d"], precisions=["float64"], sizes=[400, 900], threads=1, json=path
    )
    record = json.loads(path.read_text())
    assert [(t["case"], t["particles"]) for t in record["trials"]] == [
        ("tl-2d", 400), ("adaptle-2d", 400), ("tl-2d", 900), ("adaptle-2d", 900)
    ]  # fmt: skip
    tl, adaptle = record["trials"][:2]
    assert (
        tl["eulerian_share"] == 0.0 and tl["steps_per_rebuild"] is None and adaptle["eulerian_share"] == 0.5
    )
    for done in record["trials"]:
        assert len(done["ns_per_particle_step"]) == 2 and min(done["ns_per_particle_step"]) > 0.0
        assert done["pairs_per_s"] == pytest.approx(
            done["particle_steps_per_s"] * done["mean_neighbours"], rel=1e-4
        )
        assert done["bytes_per_particle"] > done["list_bytes_per_particle"] > 0.0
        assert sum(kernel["share"] for kernel in done["kernels"]) == pytest.approx(1.0, rel=1e-4)
        assert done["scene_s"] > 0.0 and done["solver_s"] > 0.0 and done["snapshot_s"] > 0.0
        assert done["commit"] and done["date"]
    forces = next(kernel for kernel in tl["kernels"] if kernel["name"] == "momentum_lagrangian")
    assert forces["pairs_per_s"] > 0.0 and forces["bytes_per_s"] > 0.0 and forces["flops_per_s"] > 0.0
    assert {"facts", "ceilings", "trials"} == set(record)
    for _, header, rows in performance.tables(record):
        assert table(rows, header) in text


def test_all_cases_tell_the_start_as_well(quick, checkout, monkeypatch):
    monkeypatch.setattr(trial, "CASES", {})
    monkeypatch.setattr(bench, "CASES", {"eulerian-2d": trial.Case("eulerian-2d", 2, "sav1")})
    text = bench.bench(precisions=["float64"], sizes=[400])
    assert "Start of a run" in text
    (kept,) = (checkout / "docs" / "performance").iterdir()
    assert json.loads(kept.read_text())["startup"]["hvi_2d"] == START


def test_a_case_that_fails_is_told_and_the_rest_goes_on(quick, checkout, monkeypatch):
    measure = trial.measure

    def full(data, **options):
        if data.numerics.scheme == "tl":
            raise RuntimeError("out of memory")
        return measure(data, **options)

    monkeypatch.setattr(trial, "measure", full)
    text = bench.bench(["tl-2d", "pm-2d"], precisions=["float64"], sizes=[400])
    assert "out of memory" in text and "\npm-2d " in text


def test_no_case_is_begun_when_the_time_is_up(quick, checkout, tmp_path):
    text = bench.bench(precisions=["float64"], sizes=[400], budget=0.0)
    assert "eulerian" not in text and "GFLOP/s" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"cases": ["euler"]},
            "case 'euler' is unknown .did you mean 'eulerian'.*; allowed: eulerian, eulerian-mixed, tl, adaptle, ts2, pm, hvi_2d",
        ),
        ({"precisions": ["half"]}, f"precision 'half' is unknown; allowed: {', '.join(PRECISIONS)}"),
        ({"sizes": [10]}, "-n = 10 is out of range; allowed: 100 to "),
        ({"device": "tpu"}, "device 'tpu' is unknown"),
    ],
)
def test_bad_arguments(arguments, message):
    with pytest.raises(InputError, match=message):
        bench.bench(**arguments)


def test_the_command_line_takes_cases_sizes_and_precisions(monkeypatch, capsys):
    calls = []
    monkeypatch.setattr(bench, "bench", lambda *words, **options: calls.append((words, options)) or "done")
    words = ["bench", "tl", "pm-3d", "-n", "400", "-n", "900", "--precision", "float32", "--threads", "2"]
    with pytest.raises(SystemExit) as ended:
        cli.main(words)
    assert ended.value.code == 0 and capsys.readouterr().out == "done\n"
    ((given, options),) = calls
    assert given == (("tl", "pm-3d"), "cpu") and options.pop("progress")
    assert options == {"precisions": ["float32"], "sizes": [400, 900], "threads": 2, "json": None}


def test_a_name_stands_for_both_dimensions():
    assert [case.name for case in bench.choose(["tl", "pm-3d", "hvi_2d"])] == [
        "tl-2d",
        "tl-3d",
        "pm-3d",
        "hvi_2d",
    ]
    assert len(bench.choose([])) == 14


def result(device, case="tl-3d", asked=30_000, rate=1e6, **more):
    """Results of one case."""
    trial = {
        "case": case, "asked": asked, "particles": asked, "dim": int(case[-2]), "precision": "float64", "threads": 2,
        "ns_per_particle_step": [1e9 / rate], "particle_steps_per_s": rate, "pairs_per_s": 50 * rate,
        "mean_neighbours": 50.0, "eulerian_share": 0.0, "steps_per_rebuild": None, "search_share": 0.0,
        "bytes_per_particle": 700.0, "list_bytes_per_particle": 300.0, "solver_s": 1.0, "snapshot_s": None,
        "scene_s": 0.1, "commit": "abc", "date": "2026-01-01",
        "kernels": [{"name": "rate", "share": 0.5, "ns_per_particle_step": 5.0, "pairs_per_s": 1e8, "bytes_per_s": 1e9,
                     "flops_per_s": 0.0}],
    }  # fmt: skip
    trial["ceilings"] = {"bandwidth": 2e9, "flops": 1e10}
    return {
        "facts": {"device": device, **more},
        "ceilings": {"float64": trial["ceilings"]},
        "trials": [trial],
    }


def test_results_of_two_devices_share_a_page(checkout):
    performance.add(checkout, result("Small CPU"))
    performance.add(checkout, result("Small CPU", asked=1000))
    performance.add(checkout, result("Large GPU", asked=1_000_000, driver="CUDA 13.0"))
    page = (checkout / "docs" / "performance.md").read_text()
    assert page.startswith("a\n<!-- begin") and page.endswith("-->\nb\n")
    assert page.index("## Large GPU") < page.index("## Small CPU") and "- driver: CUDA 13.0" in page
    assert (
        "| tl-3d | 1,000,000 |" in page and "| tl-3d | 30,000 |" in page and "| tl-3d | 1,000 |" not in page
    )
    assert "| rate | 5 | 50% | 100 | 1 | 50% | - | - |" in page
    assert (checkout / "docs" / "images" / "performance.png").read_bytes().startswith(b"\x89PNG")


def test_a_new_result_replaces_the_old_one_of_the_same_case(checkout):
    old, new = result("CPU", rate=1e6), result("CPU", rate=2e6)
    other = result("CPU", case="pm-2d")
    found = performance.merged(performance.merged(old, other), new)
    assert {t["case"]: t["particle_steps_per_s"] for t in found["trials"]} == {"tl-3d": 2e6, "pm-2d": 1e6}


def test_damaged_results_are_bad_input(tmp_path):
    path = tmp_path / "cpu.json"
    path.write_text('{"facts": {}}')
    with pytest.raises(InputError, match="holds no results"):
        performance.read(path)


def test_results_from_elsewhere_are_added(checkout, tmp_path):
    path = tmp_path / "gpu.json"
    path.write_text(json.dumps(result("Large GPU", driver="CUDA 13.0")))
    performance.main([str(path)])
    assert "## Large GPU" in (checkout / "docs" / "performance.md").read_text()
