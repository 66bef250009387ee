"""Device memory: what a particle takes, and that thrift changes no number."""

import itertools
import json
import re
import weakref
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp
from tools import PLASTIC, SPACING, by_id, collision, jittered, run, scene

from warpsph.config import Contact, Conversion
from warpsph.errors import InputError, RunError
from warpsph.fields import FIELDS
from warpsph.kernels.cells import ALONG, FEWEST
from warpsph.kernels.ledger import SUMS
from warpsph.kernels.spec import COLUMNS, Spec
from warpsph.memory import admission, available, census, exhaustion
from warpsph.memory.need import AT_HAND, Need
from warpsph.memory.policy import GENEROUS, THRIFTY
from warpsph.memory.usage import usage
from warpsph.particles import Particles
from warpsph.quality.torture import memory as trial
from warpsph.quality.torture.trial import Means
from warpsph.run import run as run_scene
from warpsph.search import rows
from warpsph.search.block import Block
from warpsph.search.cells import FEWEST_CELLS, PER_PARTICLE, count_cells, order_of
from warpsph.search.neighbours import Neighbours
from warpsph.solver import Solver
from warpsph.storage import snapshot

MOST = 700
"""Bytes that a particle may take in single precision, with its rows: 57 neighbours within the support."""


def block_of(n, precision="float32"):
    """A jittered cube of n³ particles at rest under the policy of a GPU."""
    made = scene(3, scheme="sav1")
    made.add_body("block", jittered(3, n, amount=0.15), "aluminium")
    return Solver(made.finalize(), precision=precision, policy=THRIFTY)


def test_a_particle_in_space_takes_at_most_700_bytes():
    """Rows are counted as if all were as long as in the middle: those in the skin of a small cube are shorter."""
    solver = block_of(24)
    n, found = solver.particles.n, usage(solver)
    entries = found.pop("neighbours.block") / n
    counts, x = solver.neighbours.n_neigh.numpy(), solver.particles.x.numpy()
    groups = np.arange(0, n, COLUMNS)
    longest = np.maximum.reduceat(counts, groups)
    middle = np.logical_and.reduceat(np.all(np.abs(x - x.mean(axis=0)) < 8 * SPACING, axis=1), groups)
    assert middle.sum() > 20
    fixed = sum(value for name, value in found.items() if value >= n) / n  # not what any run has
    assert fixed + entries * longest[middle].mean() / longest.mean() < MOST
    assert solver.mean_neighbours() > 50


def test_usage_counts_every_field_once():
    solver = block_of(6)
    found, n = usage(solver), solver.particles.n
    assert found["particles.dvdx"] == 36 * n and found["particles.tau"] == 24 * n
    assert sum(name.startswith("particles.") for name in found) == len(solver.particles.fields)
    assert found["neighbours.block"] == 4 * solver.neighbours.block.size >= 4 * solver.neighbours.neigh.size


@pytest.mark.parametrize(
    ("scheme", "options"),
    [
        ("sav1", {}),
        ("bal-mixed-as", {"contact": Contact(stiffness=0.25)}),
        ("ts2-mixed", {}),
        ("ts1", {}),
        ("adaptle-mixed", {"conversion": Conversion(strain=0.05), "contact": Contact(stiffness=0.25)}),
        ("adaptle", {"conversion": Conversion(strain=0.05)}),
    ],
)
def test_loops_of_a_gpu_give_the_same_physics(scheme, options):
    """They handle one pair at a time, leave out what is beyond the support, and add in the order of the row."""
    made = collision(2, speed=900.0, scheme=scheme, **options)
    rich, poor = (run(made, 3e-6, policy=policy) for policy in (GENEROUS, THRIFTY))
    assert rich.neighbours.builds == poor.neighbours.builds > 2
    for name in ("x", "v", "rho", "e", "p", "sig", "kernel_type"):
        a, b = by_id(rich, name), by_id(poor, name)
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-9 * np.abs(a).max(), err_msg=name)
    assert poor.neighbours.neigh.size < rich.neighbours.neigh.size


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize("scheme", ["sav1", "ts2", "tl", "adaptle-mixed"])
def test_rows_in_pieces_are_the_same_rows(monkeypatch, scheme, policy):
    """Where there are more particles than one array has entries for."""
    made = collision(
        2, speed=900.0, scheme=scheme, contact=None if scheme == "ts2" else Contact(stiffness=0.25)
    )
    whole = run(made, 2e-6, policy=policy)
    monkeypatch.setattr(rows, "LENGTH", 32)
    cut = run(made, 2e-6, policy=policy, threads=2)
    assert len(cut.neighbours.neigh.arrays) == -(-cut.particles.n // 32) > 2
    for name, values in whole.particles.arrays().items():
        np.testing.assert_array_equal(values, cut.particles.arrays()[name], err_msg=name)


def test_a_lagrangian_body_alone_keeps_no_work_space():
    made = scene(2, scheme="tl")
    made.add_body("block", jittered(2, 12, amount=0.0), "aluminium", velocity=(10.0, 0.0, 0.0))
    solver = run(made, 1e-7)
    assert usage(solver)["neighbours.block"] < solver.particles.n
    assert usage(solver)["reference.rows"] >= 4 * solver.reference.n_neigh0.numpy().sum()


def test_fields_that_a_run_has_no_use_for_take_nothing():
    free, held = collision(2), collision(2)
    held.fix("right", lambda x: x[:, 0] > 0.0)
    free, held = (run(made, 1e-6) for made in (free, held))
    names = {f.name for f in free.particles.fields}
    assert not names & {"fixed", "impulse", "twist", "work", "thickness", "av_switch"}
    assert {f.name for f in held.particles.fields} - names == {"fixed", "impulse", "twist", "work"}
    assert free.particles.e_parts.dtype._shape_ == (1,)  # viscosity alone
    # and yet everything is reported
    assert not free.state().fixed.any() and held.state().fixed.any()
    assert (
        set(free.state().fields)
        == set(held.state().fields)
        >= {f.name for f in FIELDS if f.output and not f.group}
    )
    assert set(free.ledger()) == set(held.ledger()) >= set(SUMS)
    assert free.ledger()["work"] == free.ledger()["contact_work"] == 0.0 != free.ledger()["viscous_work"]


def test_stress_of_the_state_is_a_whole_tensor():
    made = collision(2, material=PLASTIC)
    solver = run(made, 2e-6)
    tau = solver.state().tau
    assert tau.shape == (solver.particles.n, 3, 3) and solver.particles.tau.numpy().shape[1:] == (6,)
    np.testing.assert_array_equal(tau, tau.swapaxes(1, 2))
    assert np.abs(tau[:, 0, 1]).max() > 0.0 == np.abs(tau[:, 2, :2]).max()


def test_views_of_a_block_do_not_overlap():
    block = Block(wp.get_device("cpu"))
    a, b = block.views((wp.int32, 5), (wp.vec3d, 7))
    a.fill_(1)
    b.fill_(2.0)
    assert (a.numpy() == 1).all() and (b.numpy() == 2.0).all() and b.ptr % 64 == block.lines.ptr % 64
    moved, size = block.generation, block.size
    block.views((wp.int32, 3))
    assert (block.generation, block.size) == (moved, size)
    block.grow(size + 1)
    assert block.generation == moved + 1


@pytest.mark.parametrize("n", [100, 100_000])
@pytest.mark.parametrize("extent", [(1.0, 1.0, 1.0), (0.01, 1.0, 1.0), (5.0, 0.1), (1.0,)])
def test_cells_fit_the_scene_and_the_number_of_particles(n, extent):
    dim, spacing = len(extent), (np.prod(extent) / n) ** (1.0 / len(extent))
    x = np.zeros((n, 3))
    x[1, :dim] = extent
    most = max(PER_PARTICLE * n, FEWEST_CELLS)
    needed = np.array([ALONG, 1, 1])[:dim] * extent / (8.0 * spacing)
    for mirrored in ([], [0]):
        found = count_cells(x, dim, 8.0 * spacing, mirrored)
        assert all(c >= few and c & (c - 1) == 0 for c, few in zip(found[:dim], FEWEST, strict=False))
        assert found[dim:] == (1,) * (3 - dim) and most / 2 < np.prod(found) <= most
        images = [2.0 if axis in mirrored else 1.0 for axis in range(dim)]
        assert all(c >= k * size for c, k, size in zip(found, images, needed, strict=False))


def test_cells_of_a_scene_that_is_nearly_empty():
    """Two particles of millimetres, a hundred kilometres apart in all directions."""
    counts = count_cells(np.array([[0.0, 0.0, 0.0], [1e5, 1e5, 1e5]]), 3, 1e-3)
    assert FEWEST_CELLS // 2 < np.prod(counts) <= FEWEST_CELLS


def small(dim=2, **numerics):
    """A scene of a few particles."""
    made = scene(dim, **numerics)
    made.add_body("block", jittered(dim, 9, amount=0.0), "aluminium", velocity=(10.0, 0.0, 0.0))
    return made


@pytest.mark.parametrize("policy", [GENEROUS, THRIFTY], ids=["generous", "thrifty"])
@pytest.mark.parametrize(
    ("scheme", "options"),
    [
        ("sav1", {}),
        ("bal-mixed-as", {"contact": Contact(stiffness=0.25)}),
        ("ts2-mixed", {}),
        ("tl", {"contact": Contact(stiffness=0.25)}),
        ("adaptle-mixed", {"conversion": Conversion(strain=0.05), "contact": Contact(stiffness=0.25)}),
    ],
)
def test_the_estimate_is_what_the_solver_takes(scheme, options, policy):
    """Neighbours of so few particles are all counted: what is left are roundings of memory, and what is not counted."""
    solver = Solver(collision(2, scheme=scheme, **options).finalize(), policy=policy)
    assert solver.need.on_device == pytest.approx(sum(usage(solver).values()), rel=0.01)
    assert solver.need.outputs == 0 and solver.need.particles == solver.particles.n


def test_the_estimate_knows_mirror_images_and_copies():
    made = small()
    made.add_symmetry_plane("y", -0.5 * SPACING)
    solver = Solver(made.finalize(), copies=2)
    assert solver.need.on_device == pytest.approx(sum(usage(solver).values()), rel=0.01)
    fields = sum(size for name, size in usage(solver).items() if name.startswith("particles."))
    assert solver.need.device["fields"] == fields
    n = solver.particles.n
    saved = sum(array.nbytes for array in solver.save()[0].values() if len(array) == n)
    assert saved > fields and solver.need.outputs == 2 * saved + AT_HAND * n


@pytest.mark.parametrize("planes", [(), ((0, -0.4e-3),), ((0, -0.4e-3), (1, -0.3e-3))])
@pytest.mark.parametrize("same_body", [False, True])
def test_neighbours_are_counted_exactly(planes, same_body):
    """Against all pairs, images and other bodies included."""
    x = jittered(3, 6, amount=0.1)
    data = SimpleNamespace(x=x, dim=3, planes=planes, body=(x[:, 2] > 2.4e-3).astype(int))
    radius, chosen = 2.3e-3, np.array([0, 100, 215])
    images = [x]
    for axis, position in planes:
        images += [np.where(np.arange(3) == axis, 2.0 * position - image, image) for image in images]
    expected = [
        sum(
            int(
                (
                    (np.linalg.norm(image - x[i], axis=1) < radius)
                    & (~same_body | (data.body == data.body[i]))
                ).sum()
            )
            for image in images
        )
        - 1
        for i in chosen
    ]
    assert census.neighbours(data, chosen, radius, same_body).tolist() == expected


def test_groups_of_rows_are_those_of_the_order_in_memory():
    """What the estimate takes for groups, where all are looked at, and where some are."""
    solver, data = block_of(12), small(3).finalize()
    cells = solver.neighbours.cells
    order = order_of(solver.data.x, cells.period, solver.neighbours.radius)
    assert (order == solver.particles.id.numpy()).mean() > 0.95  # rounding may tell the odd cell
    found = census.groups(order, COLUMNS)
    np.testing.assert_array_equal(found.ravel(), order)
    assert census.groups(np.arange(len(data.x)), COLUMNS)[-1].tolist() == [*range(704, 729), *7 * [728]]
    some = census.groups(np.arange(100_000), COLUMNS)
    assert some.shape == (census.GROUPS, COLUMNS) and len(np.unique(some)) == some.size
    np.testing.assert_array_equal(some - some[:, :1], np.broadcast_to(np.arange(COLUMNS), some.shape))


def test_a_sample_is_good_to_a_few_per_cent():
    data = small(3).finalize()
    x = jittered(3, 20, amount=0.0)
    data = replace(data, x=x, body=np.zeros(len(x), dtype=np.int32))
    counts = census.neighbours(data, census.sample(len(x)), 2.4 * SPACING)
    inside = np.arange(-2, 3)
    steps = [s for s in itertools.product(inside, repeat=3) if 0 < np.dot(s, s) < 2.4**2]
    exact = sum(np.prod([1.0 - abs(c) / 20 for c in s]) for s in steps)
    assert len(counts) == census.SAMPLE and counts.mean() == pytest.approx(exact, rel=0.03)


def test_a_run_says_what_it_needs_before_it_allocates(monkeypatch):
    said = []
    monkeypatch.setattr(available, "on_host", lambda: 21_300_000_000)
    monkeypatch.setattr(Particles, "__init__", lambda *_, **__: said.append("allocated"))
    with pytest.raises(AttributeError):
        Solver(small().finalize(), copies=2, say=said.append)
    assert re.fullmatch(
        r"81 particles: about \d+ kB on cpu of 21.3 GB free "
        r"\(fields 30.8 kB, neighbours \d+ kB, work [\d.]+ kB, output copies 78.4 kB\)",
        said[0],
    )
    assert said[1] == "allocated"


def test_a_run_that_cannot_fit_is_refused_with_what_would(monkeypatch):
    monkeypatch.setattr(wp, "get_cuda_devices", list)  # none to go to, wherever this runs
    made = small(3).finalize()
    need = Solver(made).need.on_device
    monkeypatch.setattr(available, "on_host", lambda: int(0.9 * need))
    with pytest.raises(InputError) as refused:
        Solver(made)
    message = str(refused.value)
    assert re.match(
        r"729 particles need about [\d.]+ [kM]B on cpu, where [\d.]+ kB are free; allowed: ", message
    )
    assert "up to about 656 particles, with a spacing of 0.0011 m, or --precision float32" in message
    monkeypatch.setattr(available, "on_host", lambda: need // 10)
    with pytest.raises(InputError, match=r"up to about 72 particles, with a spacing of 0\.0023 m$"):
        Solver(made)
    monkeypatch.setattr(available, "on_host", lambda: None)
    Solver(made)


def test_outputs_count_where_they_are_made(monkeypatch):
    need = Solver(small().finalize(), copies=2).need
    monkeypatch.setattr(available, "on_host", lambda: need.on_device + need.outputs - 1)
    with pytest.raises(InputError, match="need about"):
        Solver(small().finalize(), copies=2)
    Solver(small().finalize())


def test_a_gpu_is_held_against_its_own_memory_and_the_host_against_the_copies(monkeypatch):
    monkeypatch.setattr(wp, "get_cuda_devices", list)  # none to go to, wherever this runs
    gpu = SimpleNamespace(is_cuda=True, is_cpu=False, alias="cuda:0")
    need = Need(1000, {"fields": 600_000}, 2, 100_000, later=50_000)
    monkeypatch.setattr(available, "on_device", lambda device: 1_000_000)
    monkeypatch.setattr(available, "on_host", lambda: 90_000)
    assert admission.line(need, gpu) == (
        "1000 particles: about 600 kB on cuda:0 of 1 MB free (fields 600 kB), 100 kB on the host of 90 kB free "
        "(output copies 100 kB); 50 kB more if all of them turn Eulerian"
    )
    spec, data = Spec(3, wp.float32, lanes=1), SimpleNamespace(dim=3, spacing=1e-3)
    with pytest.raises(
        InputError, match="100 kB on the host, where 90 kB are free; allowed: up to about 900 particles"
    ):
        admission.admit(data, need, spec, gpu)
    with pytest.raises(InputError, match="particles = 268435457 is out of range"):
        admission.admit(data, replace(need, particles=2**28 + 1), spec, gpu)


def files(root, **texts):
    """Write a system's files."""
    for name, text in texts.items():
        path = root / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_memory_that_is_to_be_had_is_the_least_of_what_limits_it(tmp_path):
    assert available.on_host(tmp_path) is None
    files(tmp_path, proc__meminfo="MemTotal: 9000 kB\nMemAvailable:    5000 kB\n")
    assert available.on_host(tmp_path) == 5_120_000
    files(tmp_path, proc__self__cgroup="0::/job/step\n")
    step, job = tmp_path / "sys/fs/cgroup/job/step", tmp_path / "sys/fs/cgroup/job"
    step.mkdir(parents=True)
    for folder, limit, used in ((step, "max", "70"), (job, "4000000", "2500000")):
        (folder / "memory.max").write_text(limit + "\n")
        (folder / "memory.current").write_text(used + "\n")
    (job / "memory.stat").write_text("anon 5\ninactive_file 500000\n")
    assert available.on_host(tmp_path) == 2_000_000
    files(tmp_path, proc__self__cgroup="4:cpu,memory:/far\n3:cpu:/\n")
    old = tmp_path / "sys/fs/cgroup/memory"
    old.mkdir()
    (old / "memory.limit_in_bytes").write_text("1000000\n")
    (old / "memory.usage_in_bytes").write_text("1200000\n")
    assert available.on_host(tmp_path) == 0


def test_the_address_space_is_a_limit(tmp_path):
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (1 << 50, hard))
    try:
        files(tmp_path, proc__self__statm="1000 500 1 1 0 1 0\n")
        assert available.on_host(tmp_path) == (1 << 50) - 1000 * resource.getpagesize() - available.LIBRARIES
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.parametrize("scheme", ["sav1", "ts2"])
def test_rows_that_outgrow_their_memory_are_gone_before_they_get_more(device, monkeypatch, scheme):
    """No launch that was bound to them keeps them: a run never has two sets of rows."""
    solver = run(collision(3, scheme=scheme), 1e-6, device=str(device))
    block, search = solver.neighbours.block, solver.neighbours.search
    old, empty, seen = [weakref.ref(block.lines)], wp.empty, []

    def watched(size, dtype, device):
        made = empty(size, dtype=dtype, device=device)
        if size > 1:
            seen.append(old[-1]() is None)
            old.append(weakref.ref(made))
        return made

    monkeypatch.setattr(wp, "empty", watched)
    search._rooms = [1]
    search._starts.zero_()
    block.release()
    solver.relist()
    assert len(seen) > 1 and all(seen)  # sorting takes some first, then the rows
    solver.advance(2e-6)


def test_rows_that_outgrow_memory_stop_the_run_with_its_last_snapshot(monkeypatch, tmp_path):
    """The block asks for more than there is in the middle of a run."""
    grow, asked = Block.grow, []

    def narrow(self, words):
        if words > self.size and len(asked) > 2:
            monkeypatch.setattr(available, "on_host", lambda: 1000)
        asked.append(words)
        return grow(self, words)

    made = collision(2, speed=900.0, skin=0.1)
    made.until, made.snapshots = 2e-6, 4
    monkeypatch.setattr(Block, "grow", narrow)
    build = Neighbours.build

    def crowded(self):
        if self.builds > 6:
            self.search._rooms = [1]
            self.search._starts.zero_()
            self.block.release()
        return build(self)

    monkeypatch.setattr(Neighbours, "build", crowded)
    with pytest.raises(RunError) as stopped:
        run_scene(made, tmp_path / "out", frames=False)
    message = str(stopped.value)
    assert re.match(r"no memory for neighbour rows: [\d.]+ kB needed on cpu, where 1 kB are free; ", message)
    assert "\n" not in message and "test_00" in message and len(snapshot.find(tmp_path / "out")) >= 2
    assert message.partition(";")[0] in json.loads((tmp_path / "out/summary.json").read_text())["warnings"][0]


@pytest.mark.parametrize(
    "trouble",
    [
        MemoryError("Unable to allocate 2 GiB"),
        RuntimeError("Failed to allocate 7 bytes on device 'cpu'"),
        ImportError("vtk.so: failed to map segment from shared object (no room to allocate)"),
    ],
)
def test_memory_that_runs_out_elsewhere_stops_the_run_in_one_line(trouble, monkeypatch, tmp_path):
    monkeypatch.setattr(Solver, "advance", lambda *_: (_ for _ in ()).throw(trouble))
    with pytest.raises(RunError, match=r"out of memory .*allocate.*last snapshot: .*test_0001") as stopped:
        with exhaustion.told():  # as the command line does
            run_scene(small(), tmp_path / "out", frames=False)
    message = str(stopped.value)
    assert "\n" not in message and message.count("out of memory") == 1


def test_a_gpu_that_fails_ends_the_run_in_one_line(monkeypatch, tmp_path):
    """Whatever is asked of it from then on fails too: the last snapshot is the one before."""
    failure = "Warp copy error: CUDA error 700: an illegal memory access was encountered"
    advance = Solver.advance

    def fail(*_):
        raise RuntimeError(failure)

    def advance_once(solver, *given):
        advance(solver, *given)
        monkeypatch.setattr(Solver, "advance", fail)
        monkeypatch.setattr(Solver, "save", fail)

    monkeypatch.setattr(Solver, "advance", advance_once)
    with pytest.raises(RunError) as stopped, exhaustion.told():
        run_scene(small(), tmp_path / "out", frames=False)
    assert re.fullmatch(
        rf"the GPU has failed \({failure}\); a run goes on from its checkpoint with `warpsph resume`; "
        r"last snapshot: .*test_0000.vtkhdf",
        str(stopped.value),
    )


def test_a_block_without_memory_stays_usable(monkeypatch):
    block = Block(wp.get_device("cpu"))
    block.grow(1000)
    monkeypatch.setattr(available, "on_host", lambda: 4096)
    with pytest.raises(RunError, match=r"8 kB needed on cpu, where 4\.1 kB are free"):
        block.grow(2000)
    moved = block.generation
    assert block.size < 1000 and block.grow(1000) and block.generation == moved + 1


def test_the_trial_holds(tmp_path):
    found = trial.run(Means(tmp_path, True, lambda line: None))
    assert not found.failed and len(found.rows) == 3
