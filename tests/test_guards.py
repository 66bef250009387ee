"""What a run watches for: each trouble is found in time, named, and stops the run or is counted, the same after a resume."""

import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp
from tools import SPACING, collision, packed

from warpsph import Guards, InputError, Numerics, RunError, cli
from warpsph.device.blocks import Blocks
from warpsph.device.launch import Launcher
from warpsph.guards import EXACT, LOSSY, WATCHED
from warpsph.kernels.guards import COLUMNS, FINDINGS, GUARDS, LAGRANGIAN, SUMS, make_guards
from warpsph.quality.torture import guards as trial
from warpsph.quality.torture.trial import Means
from warpsph.shapes import Box
from warpsph.solver import Solver
from warpsph.storage import checkpoint
from warpsph.watching.penetration import cover_at, interpenetration
from warpsph.watching.watch import EVERY

MICRO = 1e-6


def test_every_trouble_is_found_in_time_and_named(tmp_path):
    found = trial.run(Means(tmp_path, True, lambda line: None))
    assert found.failed == []
    assert {row[0] for row in found.rows} == {case.name for case in trial.CASES}


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"energy_error": 0.0}, "energy_error"), ({"energy_error": math.nan}, "energy_error"),
        ({"interpenetration": None}, "interpenetration"), ({"neighbours": "many"}, "neighbours"),
        ({"domain": (0.0, 1.0, 2.0)}, "domain"), ({"domain": ((0.0, 0.0), (1.0,))}, "domain"),
        ({"domain": ((0.0, 2.0), (1.0, 1.0))}, "domain"), ({"domain": ((0.0,), (math.nan,))}, "domain"),
        ({"stop": "domain"}, "stop"), ({"stop": ("J",)}, "stop of Guards 'J'"),
    ],
)  # fmt: skip
def test_guards_are_checked(values, named):
    with pytest.raises(InputError, match=f"{named}.*allowed: .*") as refused:
        Guards(**values)
    assert "\n" not in str(refused.value)


def test_limits_may_be_none():
    guards = Guards(energy_error=math.inf, interpenetration=math.inf, neighbours=math.inf, domain=[[0], [1]])
    assert guards.domain == ((0.0,), (1.0,)) and guards.energy_limit(Numerics()) == math.inf


@pytest.mark.parametrize(
    ("numerics", "limit"),
    [
        ({}, EXACT), ({"scheme": "ts2"}, EXACT), ({"scheme": "tl"}, EXACT), ({"scheme": "av-explicit"}, LOSSY),
        ({"scheme": "adaptle", "interface_stress": "eulerian"}, EXACT), ({"scheme": "adaptle", "coupling": "printed"}, LOSSY), ({"scheme": "adaptle-as", "interface_stress": "eulerian"}, LOSSY),
    ],
)  # fmt: skip
def test_a_scheme_that_loses_energy_by_design_has_a_wider_limit(numerics, limit):
    assert Guards().energy_limit(Numerics(**numerics)) == limit
    assert Guards(energy_error=1e-6).energy_limit(Numerics(**numerics)) == 1e-6


def test_the_command_line_changes_what_guards_do():
    assert Guards().changed(on_trouble="stop").stop == WATCHED
    assert Guards().changed(1e-5, "warn") == Guards(energy_error=1e-5, stop=())
    assert Guards().changed() == Guards()
    with pytest.raises(InputError, match="on_trouble 'shout' is unknown; allowed: stop, warn"):
        Guards().changed(on_trouble="shout")


def test_a_scene_starts_inside_of_its_domain():
    made = collision()
    made.guards = Guards(domain=((-1.0, -1.0), (8e-3, 1.0)))
    with pytest.raises(
        InputError,
        match=r"body 'right' has a particle at \(.*outside of the domain .* 12 particles start there",
    ):
        made.finalize()
    made.guards = Guards(domain=((-1.0,), (1.0,)))
    with pytest.raises(InputError, match="corners of 2 components"):
        made.finalize()


@pytest.mark.parametrize("depth", [0.2, 0.5, 1.0, 2.0])
def test_interpenetration_and_cover_are_each_others_inverse(depth):
    kernel = ("cubic_spline", 3, 1.3e-3, 1e-3)
    assert interpenetration(cover_at(depth, *kernel), *kernel) == pytest.approx(depth, rel=1e-3)
    assert cover_at(math.inf, *kernel) == math.inf


def drawn(spec, n=300):
    """Particles drawn at random, some of them in trouble."""
    rng = np.random.default_rng(3)
    values = {
        name: rng.uniform(1.0, 2.0, n) for name in ("m", "rho", "e", "p", "ep", "T", "D", "cover", "work")
    }
    values |= {name: rng.uniform(-1.0, 1.0, (n, 3)) for name in ("x", "v")}
    values |= {"tau": rng.uniform(-1.0, 1.0, (n, 3, 3)), "F": np.broadcast_to(np.eye(3), (n, 3, 3)).copy()}
    values |= {name: rng.integers(0, 50, n).astype(np.int32) for name in ("n_neigh", "inverted")}
    values["rho"][[7, 40, 200]] = [-3.0, 0.0, -5.0]
    values["x"][17] = (0.0, 5.0, 0.0)
    values["F"][250, 1, 2] = np.nan
    values["tau"][99, 0, 0] = np.inf
    return values


def test_a_look_counts_and_names_the_worst(precision, eps):
    n, values = 300, drawn(precision)
    blocks = Blocks(n, False, 7)
    kinds = {(3, 3): precision.mat, (3,): precision.vec, (6,): precision.sym, (): precision.real}
    values["tau"] = packed(values["tau"])
    arrays = {
        name: wp.array(a, dtype=wp.int32 if a.dtype.kind == "i" else kinds[a.shape[1:]], device="cpu")
        for name, a in values.items()
    }
    found = wp.zeros((blocks.count, COLUMNS), dtype=wp.float64, device="cpu")
    point = precision.point
    Launcher("cpu", 1).launch(
        make_guards(precision), blocks.count, blocks, SimpleNamespace(**arrays), found=found, has=LAGRANGIAN,
        low=point(-2.0, -2.0, -2.0), high=point(2.0, 2.0, 2.0), most_cover=0.0, most_neighbours=40.0,
    )  # fmt: skip
    seen = found.numpy()
    kinetic = 0.5 * values["m"] * (values["v"] ** 2).sum(axis=1)
    held = values["m"] * values["e"]
    assert seen[:, :3].sum(axis=0) == pytest.approx([kinetic.sum(), held.sum(), 0.0], rel=50 * eps)
    each = seen[:, len(SUMS) :].reshape(-1, len(GUARDS), len(FINDINGS))
    worst = {}
    for k, guard in enumerate(GUARDS):
        b = int(np.argmax(each[:, k, 1]))
        worst[guard] = (int(each[:, k, 0].sum()), each[b, k, 1], int(each[b, k, 2]))
    assert worst["state"] == (2, 1.0, 99)
    assert worst["density"] == (3, 5.0, 200)
    assert worst["domain"] == (1, 3.0, 17)
    crowd, over = values["n_neigh"], values["inverted"]
    assert worst["neighbours"] == ((crowd > 40).sum(), crowd.max(), crowd.argmax())
    assert worst["inverted"] == ((over > 0).sum(), over.max(), over.argmax())
    assert worst["interpenetration"][0] == 0, "the run has no contact"
    assert worst["energy_error"][0] == 0 and worst["energy_error"][2] == (kinetic + held).argmax()


def thrown(**guards):
    """Two balls that go through each other's place and out of a narrow domain."""
    made = collision(speed=1500.0)
    made.guards = Guards(domain=((-12e-3, -6.5e-3), (12e-3, 8.5e-3)), **guards)
    return made.finalize()


def watched(data, until=8 * MICRO):
    solver = Solver(data)
    solver.watch.say = lambda text: None
    solver.advance(until)
    return solver


def test_what_is_found_depends_on_no_batch_and_no_stop(monkeypatch):
    data = thrown(stop=())
    whole = watched(data)
    found = whole.watch.report()["domain"]
    assert found["looks"] >= 2 and found["worst"]["value"] > found["first"]["value"] > 0.0
    assert found["first"]["step"] % EVERY == 0

    monkeypatch.setattr("warpsph.solver.MAX_BATCH", 5)
    assert watched(data).watch.report() == whole.watch.report()

    stopped = Solver(data)
    stopped.watch.say = lambda text: None
    stopped.advance(8 * MICRO, lambda now: now.steps >= found["first"]["step"] + 7)
    again = Solver(data)
    again.watch.say = pytest.fail  # said once
    arrays, info = stopped.save()
    again.restore(arrays, json.loads(json.dumps(info)))
    again.advance(8 * MICRO)
    assert json.dumps(again.watch.report()) == json.dumps(whole.watch.report())


def test_without_anyone_to_tell_python_warns():
    with pytest.warns(UserWarning, match=r"domain at t = .*particle \d+ of body .* has left the domain"):
        Solver(thrown(stop=())).advance(8 * MICRO)


SCENE = '''
"""A ball that flies out of its domain."""
from warpsph import Disc, Guards, Scene


def build() -> Scene:
    """Build it."""
    guards = Guards(domain=((-6e-3, -6e-3), (8e-3, 6e-3)))
    scene = Scene("ball", dim=2, spacing=1e-3, until=12e-6, snapshots=3, guards=guards)
    scene.add_body("ball", Disc(4.5e-3), "aluminium", velocity=(800.0, 0.0))
    return scene
'''


def command(*tokens):
    with pytest.raises(SystemExit) as ended:
        cli.main(tokens)
    return ended.value.code


def test_a_run_stops_and_goes_on_as_the_user_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("ball.py").write_text(SCENE)
    assert command("run", "ball.py", "--out", "out", "--no-frames") == 3
    stopped = capsys.readouterr().err
    assert (
        "has left the domain by" in stopped
        and "--on-trouble warn" in stopped
        and "last snapshot: out/" in stopped
    )
    assert json.loads(Path("out/summary.json").read_text())["guards"]["domain"]["action"] == "stop"

    assert command("resume", "out", "--on-trouble", "warn", "--no-frames") == 0
    said = [
        line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: domain at t = ")
    ]
    assert len(said) == 1 and "the run goes on" in said[0]
    summary = json.loads(Path("out/summary.json").read_text())
    entry = summary["guards"]["domain"]
    assert summary["time"] == 12e-6 and entry["action"] == "warn" and entry["looks"] >= 1
    assert entry["first"]["body"] == "ball" and entry["worst"]["value"] > 1e-3
    assert any(text.startswith("domain at") for text in summary["warnings"])

    assert (
        command(
            "run", "ball.py", "--out", "quiet", "--on-trouble", "warn", "--energy-limit", "1", "--no-frames"
        )
        == 0
    )
    assert json.loads(Path("quiet/summary.json").read_text())["guards"]["domain"] == entry
    guards = checkpoint.load(Path("quiet/checkpoint.h5"))[1]["solver"]["watch"]["guards"]
    assert (guards["energy_error"], guards["stop"]) == (1.0, []), "a resume keeps to them"
    assert command("run", "ball.py", "--out", "none", "--energy-limit", "-1") == 2
    assert not Path("none").exists()
    capsys.readouterr()


def test_a_run_without_trouble_has_nothing_to_report():
    solver = watched(collision().finalize(), 4 * MICRO)
    assert solver.watch.report() == {} and solver.watch.warnings() == []


def test_a_body_at_rest_has_no_energy_error():
    """Energies of nothing but round-off are compared with each other, not with zero."""
    made = collision(speed=0.0)
    made.add_body("plate", Box((-20 * SPACING, -20 * SPACING), (20 * SPACING, -18 * SPACING)), "steel")
    assert watched(made.finalize(), 12 * MICRO).watch.report() == {}


def test_an_eulerian_particle_that_converts_its_neighbours_never_stops_a_run():
    solver = Solver(trial._crushed(2, "stop").finalize())
    solver.watch.say = pytest.fail
    solver.particles.kernel_type.zero_()
    solver.particles.inverted.fill_(1)
    solver.advance(1e-13)
    assert solver.watch.report()["inverted"]["action"] == "convert"


def test_the_state_is_looked_at_where_the_time_step_does_not_see_it():
    solver = Solver(collision().finalize())
    D = solver.particles.D.numpy()
    D[5] = np.nan
    solver.particles.D.assign(D)
    with pytest.raises(RunError, match=r"step \d+: particle \d+ of body .*: damage not finite"):
        solver.advance(20 * MICRO)
    assert solver.reading.steps <= EVERY
