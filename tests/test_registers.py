"""What ptxas tells of kernels: read from its own words, and what follows from the numbers."""

import dataclasses
import itertools
import subprocess
import sys
from pathlib import Path

import pytest
import warp as wp

from warpsph.errors import RunError
from warpsph.kernels.correction import make_correction
from warpsph.kernels.integrate import make_integrate
from warpsph.kernels.kinematics import make_kinematics
from warpsph.kernels.neighbours import make_neighbours
from warpsph.kernels.smoothing import make_smoothing
from warpsph.kernels.spec import Spec
from warpsph.quality import ptxas, registers
from warpsph.quality.ptxas import Usage

LOG = """\
ptxas info    : Overriding maximum register limit 256 for 'spills' with  64 of maxrregcount option
ptxas info    : 272 bytes gmem
ptxas info    : Compiling entry function 'spills' for 'sm_90'
ptxas info    : Function properties for spills
    72 bytes stack frame, 152 bytes spill stores, 160 bytes spill loads
ptxas info    : Used 64 registers, used 0 barriers, 72 bytes cumulative stack size
ptxas info    : Compile time = 17.564 ms
ptxas info    : Compiling entry function 'indexed' for 'sm_90'
ptxas info    : Function properties for indexed
    72 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 27 registers, used 0 barriers, 72 bytes cumulative stack size, 1024 bytes smem
ptxas info    : Compile time = 2.054 ms
ptxas info    : Compiling entry function 'plain' for 'sm_80'
ptxas info    : Function properties for plain
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 10 registers, used 0 barriers, 368 bytes cmem[0]
ptxas info    : Function properties for __internal_accurate_pow
    0 bytes stack frame, {called} bytes spill stores, 0 bytes spill loads
"""
"""What ptxas 13.0 writes of a file with a kernel of each sort, and of a function that it did not inline."""

PTX = b"""
.version 99.0
.target sm_80
.address_size 64
.visible .entry store(.param .u64 to)
{
    .reg .b64 %rd<3>;
    ld.param.u64 %rd1, [to];
    cvta.to.global.u64 %rd2, %rd1;
    st.global.u32 [%rd2], 7;
    ret;
}
\0"""
SPEC = Spec(3, wp.float64)


def row(usage, **changes):
    plain = registers.Row("f.k", "", dim=3, precision="f64", arch=90, shown=True, pairs=True, usage=usage)
    return dataclasses.replace(plain, **changes)


def test_each_kernel_of_a_log_has_its_numbers():
    assert ptxas.parse(LOG.format(called=0)) == {
        "spills": Usage(64, stack=72, stores=152, loads=160),
        "indexed": Usage(27, stack=72, shared=1024),
        "plain": Usage(10),
    }


def test_spills_of_a_called_function_count_for_every_kernel():
    found = ptxas.parse(LOG.format(called=8))
    assert [usage.stores for usage in found.values()] == [160, 8, 8]
    assert all(usage.spilled for usage in found.values())


def test_newer_ptx_is_read_under_the_newest_version_that_ptxas_knows(tmp_path):
    path = tmp_path / "store.ptx"
    path.write_bytes(PTX)
    old, new = (ptxas.Assembler(path, "1.0", reads) for reads in ((9, 0), (99, 0)))
    assert old.outdated(PTX) and not new.outdated(PTX)
    assert old.text(path) == PTX.replace(b"99.0", b"9.0").rstrip(b"\0")
    assert new.text(path) == PTX.rstrip(b"\0")


@pytest.mark.skipif(ptxas.find() is None, reason="no ptxas here")
def test_assembles_and_refuses(tmp_path):
    path, assembler = tmp_path / "store.ptx", ptxas.find()
    path.write_bytes(PTX)
    (usage,) = assembler.assemble(path, 80).values()
    assert usage == Usage(usage.registers) and 0 < usage.registers < 32
    path.write_bytes(PTX.replace(b"ret", b"return"))
    with pytest.raises(RunError, match=r"refuses store\.ptx for sm_90"):
        assembler.assemble(path, 90)


@pytest.mark.parametrize(
    ("count", "threads", "share"),
    [
        (32, 256, 1.0),
        (33, 256, 0.75),
        (128, 256, 0.25),
        (129, 256, 0.125),
        (168, 128, 12 / 64),
        (169, 128, 8 / 64),
        (255, 256, 0.125),
        (16, 32, 0.5),  # no more than 32 blocks
    ],
)
def test_occupancy(count, threads, share):
    assert registers.occupancy(count, threads) == share


def test_no_other_block_has_more_threads_under_way():
    for count in range(16, 256):
        assert registers.occupancy(count) >= max(registers.occupancy(count, threads) for threads in (64, 256))


def test_ladder_has_a_row_for_each_step():
    rows = [line.split(" | ") for line in registers.ladder().splitlines()[2:]]
    assert rows[0][0] == "| 32" and rows[-1][0] == "| 255"
    assert all(a[1:] != b[1:] for a, b in itertools.pairwise(rows))


def test_pair_loops_are_told_by_their_neighbour_rows():
    smoothing = make_smoothing(SPEC, "cubic_spline")
    searching = make_neighbours(SPEC, False)
    pairs = (
        make_kinematics(SPEC, smoothing, False, False),
        make_correction(SPEC, smoothing, False),
        searching.fill,
    )
    assert all(map(registers.is_pair_loop, pairs))
    assert not any(map(registers.is_pair_loop, (searching.reserve, make_integrate(SPEC, False).kick)))


def test_entries_belong_to_kernels():
    module = make_neighbours(SPEC, False).fill.module
    found = {f"{key}_0a1b2c3d_cuda_kernel_forward": Usage(n) for n, key in enumerate(module.kernels)}
    owned = registers.by_kernel(module, found)
    assert {kernel.func.__name__ for kernel, _ in owned} == {"fill", "reserve"}
    assert [module.kernels[kernel.key] for kernel, _ in owned] == [kernel for kernel, _ in owned]
    with pytest.raises(RunError, match=r"nothing of make_neighbours__locals__fill in .*neighbours\.3d_f64"):
        registers.by_kernel(module, {e: u for e, u in found.items() if "fill" not in e})


def test_only_pair_loops_that_spill_are_offenders():
    spilled, clean = Usage(255, stack=16, stores=16, loads=32), Usage(64, stack=72)
    rows = [row(spilled, variant="planes"), row(spilled, pairs=False), row(clean)]
    assert registers.spilling_pair_loops(rows) == [
        "f.k (planes), 3D f64, sm_90: 255 registers, spills 16 B and fetches 32 B"
    ]
    assert registers.with_local_memory(rows)[-1] == "f.k, 3D f64, sm_90: 72 B of local memory"
    assert len(registers.with_local_memory(rows)) == 3


def test_tables():
    worst = Usage(168, stack=16, stores=16, loads=32, shared=1024)
    rows = [
        row(worst),
        row(Usage(60)),
        row(Usage(255), arch=80),
        row(Usage(40), precision="f32", dim=2),
        row(Usage(32), kernel="g.l", pairs=False),
        row(Usage(33), variant="planes", shown=False),
    ]
    assert registers.pairs_table([rows[0], *rows[2:]]).splitlines()[2:] == [
        "| `f.k` |  | 40 (75%) | 168 (19%), local 16 B, spills 16/32 B |"
    ]
    assert registers.worst_table(rows).splitlines()[2:] == [
        "| `f.k` (pairs) | 5 | 40 (75%) | 255 (12%) | 16 | 16, 32 | 1024 |",
        "| `g.l` | 1 |  | 32 (100%) | 0 | 0, 0 | 0 |",
    ]


SCRIPT = """
import types
from importlib.machinery import SourceFileLoader

import warp as wp

from warpsph.kernels.spec import Spec

script = types.ModuleType("aot_check")
SourceFileLoader("aot_check", {path!r}).exec_module(script)
spec = Spec(1, wp.float32, lanes=1)
assert not script.missed(spec, script.build_all(spec))
script.SPECS = ()
assert script.compile_all(None) == (set(), [])
"""
"""With nothing to compile, which takes minutes; in a process of its own, where no kernel has been made before."""


def test_the_script_that_compiles_everything_makes_all_kernels():
    path = str(Path(__file__).parents[1] / "scripts" / "aot_check")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(path=path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
