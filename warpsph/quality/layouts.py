"""Trials of data layouts on a device, beside a prediction for an H100 that was made before (see docs/gpu.md)."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher
from warpsph.kernels.layouts import GROUP, Layout, make_layouts
from warpsph.kernels.spec import Spec

SPACING, RATIO, SUPPORT, SKIN, JITTER = 1.0e-3, 1.2, 2.0, 0.4, 0.1
"""The block: spacing [m], h over it, support and skin over h, jitter over the spacing. A particle
inside has about 60 neighbours, 57 with those at the surface of a small block."""

ALUMINIUM = SimpleNamespace(rho=2700.0, cs=5350.0, stress=1.0e9, speed=100.0)
"""Its state: density [kg/m³], sound speed [m/s], size of stresses [Pa] and velocities [m/s]."""

LEAST_TIME = 0.2
"""A measurement repeats the launch for at least so long [s]."""

HEADER = (
    "precision", "layout", "block", "ns/particle", "G pairs/s", "GB/s (model)", "H100 predicted, G pairs/s",
    "limited by",
)  # fmt: skip
"""Columns of the table."""


@dataclass(frozen=True)
class Trial:
    """A layout in one precision, launched in blocks of ``block`` threads (None: as all kernels; no matter on a CPU)."""

    precision: str
    layout: Layout
    block: int | None = None


@dataclass(frozen=True)
class Counts:
    """What a particle has to do with: ``pairs`` within the support, ``candidates`` that it looks at; mean values."""

    pairs: float
    candidates: float


# ---------------------------------------------------------------------------------------------------------------------
# the trials


def trials(quick: bool = False) -> Iterator[Trial]:
    """What is tried, the most telling first; ``quick``: each kind once."""
    plain, six = Layout("rows", 9), Layout("rows", 6)
    columns = Layout("columns", 6)
    for precision in ("float32", "float64"):
        for layout in (plain, six, columns, Layout("cells", 6), Layout("grid", 6)):
            yield Trial(precision, layout)
    for base in (six, columns):
        yield Trial("float32", replace(base, wide=True))
        yield Trial("float32", replace(base, short=True))
    if quick:
        return
    for precision in ("float32", "float64"):
        for block in (64, 256):
            yield Trial(precision, six, block)
            yield Trial(precision, columns, block)
        for registers in (64, 96, 128):
            yield Trial(precision, replace(columns, registers=registers))
    yield Trial("float64", Layout("columns", 9))


def run_trials(
    device: str,
    n: int,
    chosen: list[Trial],
    *,
    threads: int | None = None,
    deadline: float = float("inf"),
    on_row: Callable[[dict], None] = lambda row: None,
) -> list[dict]:
    """Measure one after the other.

    Args:
        device: Where.
        n: Particles, about; the block has the nearest cube.
        chosen: The trials.
        threads: CPU threads.
        deadline: No trial starts after this value of `time.monotonic` [s].
        on_row: Sees every result as soon as it is there.

    Returns:
        One dictionary a trial, with the names of `cells`.
    """
    launcher = Launcher(device, threads)
    block = Block.of(n)
    rows = []
    for trial in chosen:
        if time.monotonic() > deadline:
            break
        rows.append(_measure(launcher, block, trial))
        on_row(rows[-1])
    return rows


def cells(row: dict) -> list[str]:
    """Row of the table."""
    told = [row["precision"], row["layout"], str(row["block"] or "-")]
    if "why_not" in row:
        return [*told, row["why_not"], *["-"] * (len(HEADER) - 4)]
    return [
        *told, f"{row['ns_per_particle']:.3g}", f"{row['pairs_per_s'] / 1e9:.3g}", f"{row['model_gb_per_s']:.3g}",
        f"{row['predicted_pairs_per_s'] / 1e9:.3g}", row["predicted_limit"],
    ]  # fmt: skip


def _measure(launcher: Launcher, block: "Block", trial: Trial) -> dict:
    told = {"precision": trial.precision, "layout": trial.layout.tag, "block": trial.block, "n": block.n}
    bench = Bench(launcher, block, trial)
    if bench.why_not:
        return told | {"why_not": bench.why_not}
    seconds, counts = bench.seconds(), bench.counts
    model = predict(trial, counts)
    return told | {
        "pairs": counts.pairs,
        "candidates": counts.candidates,
        "ns_per_particle": 1e9 * seconds / block.n,
        "pairs_per_s": block.n * counts.pairs / seconds,
        "model_gb_per_s": 1e-9 * model["bytes"] * block.n / seconds,
        "predicted_pairs_per_s": model["pairs_per_s"],
        "predicted_limit": model["limit"],
    }


class Block:
    """A cubic lattice with jitter, in the order of its cells, which are as wide as the rows reach.

    Attributes:
        n: Number of particles.
        x: Positions [m], shape [n, 3].
        v: Velocities [m/s].
        sig: Stresses [Pa], shape [n, 3, 3].
        side: Width of a cell [m].
        low: Lower corner of the cells [m], an empty layer of them included.
        n_x: Cells along an axis.
        cell_start: First particle of every cell, shape [n_x³ + 1].
    """

    def __init__(self, along: int, seed: int = 0):
        random = np.random.default_rng(seed)
        self.n = along**3
        grid = np.stack(np.meshgrid(*[np.arange(along)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        x = SPACING * (grid + random.uniform(-JITTER, JITTER, size=grid.shape))
        self.side = RATIO * SPACING * (SUPPORT + SKIN)
        self.low = np.full(3, x.min() - 1.5 * self.side)
        self.n_x = int(np.ceil((x.max() - self.low[0]) / self.side)) + 2
        cell = ((x - self.low) / self.side).astype(np.int64) @ np.array([1, self.n_x, self.n_x**2])
        order = np.argsort(cell, kind="stable")
        self.x = x[order]
        counts = np.bincount(cell, minlength=self.n_x**3)
        self.cell_start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        self.v = ALUMINIUM.speed * random.standard_normal((self.n, 3))
        half = ALUMINIUM.stress * random.standard_normal((self.n, 3, 3))
        self.sig = 0.5 * (half + half.transpose(0, 2, 1))

    @classmethod
    def of(cls, n: int) -> "Block":
        """Make the block whose number of particles is nearest to n."""
        return cls(max(round(n ** (1.0 / 3.0)), 2))


class Bench:
    """A block in one layout on a device, ready to compute its forces.

    Attributes:
        counts: Pairs and candidates of a particle.
        why_not: Why this layout cannot hold this block; empty if it can.
    """

    def __init__(self, launcher: Launcher, block: Block, trial: Trial):
        self.why_not, self._launcher, self._block = "", launcher, block
        layout = trial.layout
        spec = Spec(3, {"float32": wp.float32, "float64": wp.float64}[trial.precision])
        self._kernels = k = make_layouts(spec, layout)
        with wp.ScopedDevice(launcher.device):
            self.arrays = self._upload(spec, layout)
            a = self.arrays
            a.neigh, a.start = wp.zeros(1, dtype=k.entry), wp.zeros(block.n, dtype=wp.int32)
            a.n_neigh, a.furthest = (wp.zeros(block.n, dtype=wp.int32) for _ in range(2))
            a.grid = wp.HashGrid(*[block.n_x if layout.lists == "grid" else 1] * 3, dtype=k.place)
            if layout.lists == "grid":
                a.grid.build(a.x, a.radius)
        self.counts = Counts(float(self._search(SUPPORT).mean()), 0.0)
        candidates = self._search(SUPPORT + SKIN)
        if layout.lists in ("rows", "columns"):
            self._list(layout, candidates)
            self.counts = replace(self.counts, candidates=float(candidates.mean()))
        else:  # 27 cells as wide as the rows' reach
            per_cell = (block.side / SPACING) ** 3
            self.counts = replace(self.counts, candidates=27.0 * float(per_cell))
        if not self.why_not:
            self._force = launcher.bind(k.force, block.n, a, block=trial.block)

    def _upload(self, spec: Spec, layout: Layout) -> SimpleNamespace:
        """Put the block on the device, in the layout's types."""
        block, k, real = self._block, self._kernels, wp.dtype_to_numpy(spec.real)
        sig = block.sig
        if layout.stress == 6:
            sig = np.stack(
                [sig[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))], axis=-1
            )
        ones = np.ones(block.n)
        sizes = {"m": ALUMINIUM.rho * SPACING**3, "rho": ALUMINIUM.rho, "vol": SPACING**3, "cs": ALUMINIUM.cs}
        arrays = {name: wp.array((size * ones).astype(real), dtype=spec.real) for name, size in sizes.items()}
        return SimpleNamespace(
            x=wp.array(block.x.astype(wp.dtype_to_numpy(k.place)), dtype=k.point),
            v=wp.array(block.v.astype(real), dtype=spec.vec),
            sig=wp.array(sig.astype(real), dtype=k.stress),
            cell_start=wp.array(block.cell_start, dtype=wp.int32),
            h=RATIO * SPACING, viscosity_alpha=1.0, viscosity_beta=2.0,
            low=k.point(*block.low), side=block.side, n_x=block.n_x, n_xy=block.n_x**2,
            radius=block.side, room=0,
            dvdt=wp.zeros(block.n, dtype=spec.vec), dedt=wp.zeros(block.n, dtype=spec.real),
            **arrays,
        )  # fmt: skip

    def _search(self, reach: float) -> np.ndarray:
        """Count neighbours within ``reach`` [h], and write them where there is room."""
        radius = reach * RATIO * SPACING
        self._launcher.launch(self._kernels.search, self._block.n, self.arrays, radius=radius)
        return self.arrays.n_neigh.numpy()

    def _list(self, layout: Layout, counts: np.ndarray) -> None:
        """Give every row its place and fill it."""
        a, furthest = self.arrays, int(self.arrays.furthest.numpy().max())
        if layout.short and furthest > np.iinfo(np.int16).max:
            self.why_not = f"indices differ by {furthest}: more than 16 bits hold"
            return
        start, total = place_rows(counts, GROUP if layout.lists == "columns" else 1)
        with wp.ScopedDevice(self._launcher.device):
            a.start = wp.array(start, dtype=wp.int32)
            a.neigh = wp.zeros(total, dtype=self._kernels.entry)
        a.room = int(counts.max())
        self._search(SUPPORT + SKIN)

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Compute and give accelerations [m/s²] and powers [W/kg], in the block's order."""
        self._force()
        return self.arrays.dvdt.numpy(), self.arrays.dedt.numpy()

    def seconds(self) -> float:
        """Time of one launch [s]: the shortest of three series."""
        device = self._launcher.device
        self._force()
        wp.synchronize_device(device)
        start = time.perf_counter()
        self._force()
        wp.synchronize_device(device)
        count = max(int(LEAST_TIME / 3.0 / (time.perf_counter() - start)), 1)
        series = []
        for _ in range(3):
            start = time.perf_counter()
            for _ in range(count):
                self._force()
            wp.synchronize_device(device)
            series.append((time.perf_counter() - start) / count)
        return min(series)


def place_rows(counts: np.ndarray, group: int) -> tuple[np.ndarray, int]:
    """Give the first place of every row, and all places: rows in turn, or ``group`` of them side by side."""
    if group == 1:
        ends = np.cumsum(counts)
        return (ends - counts).astype(np.int32), int(ends[-1])
    padded = np.zeros(-(-len(counts) // group) * group, dtype=np.int64)
    padded[: len(counts)] = counts
    sizes = group * padded.reshape(-1, group).max(axis=1)
    ends = np.cumsum(sizes)
    start = np.repeat(ends - sizes, group) + np.tile(np.arange(group), len(sizes))
    return start[: len(counts)].astype(np.int32), int(ends[-1])


# ---------------------------------------------------------------------------------------------------------------------
# the prediction


@dataclass(frozen=True)
class Machine:
    """Ceilings of a GPU.

    Attributes:
        hbm: Memory bandwidth [B/s].
        l2: Bandwidth between the second-level cache and the multiprocessors [B/s].
        lines: Cache lines that all first-level caches together deal out [1/s]: one a clock each.
        issue: Instructions of a thread [1/s], by precision: half of the flops, which count a multiply-add twice.
    """

    hbm: float = 3.35e12
    l2: float = 5.5e12
    lines: float = 132 * 1.7e9
    issue: tuple[tuple[str, float], ...] = (("float32", 33.5e12), ("float64", 17.0e12))


H100 = Machine()
"""An H100 with HBM3: data sheet; the second-level cache as others have measured it."""

DISTINCT = 0.3
"""Share of what a warp gathers that is distinct: 32 particles in a row of cells have about 540 different neighbours, and
look 1800 times. The first-level cache is assumed to catch the rest."""

LINE = 128.0
"""Bytes of a cache line."""

CLUSTERS, SPREAD = 2.3, {"rows": 20.0, "columns": 20.0, "cells": 1.0, "grid": 1.0}
"""A warp's 32 particles lie in so many cells; those of one cell look at neighbours that lie within so many places in
memory of each other, or all at the same candidate."""

LIST_LINES = {"rows": 32.0, "columns": 1.0, "cells": 0.0, "grid": 2.3}
"""Cache lines that a warp touches for the entries themselves: a row each, or all in one line."""

LOOK, COMPUTE = {"rows": 25.0, "columns": 25.0, "cells": 22.0, "grid": 45.0}, 160.0
"""Instructions for a candidate, and for the force of a pair. A warp computes where any of its threads has a pair: for
every candidate of a row; of cells for every third."""

COMPUTED = {"rows": 1.0, "columns": 1.0, "cells": 0.35, "grid": 0.35}
"""Share of the candidates for which a warp computes."""


def lines(numbers: int, size: int, lists: str) -> float:
    """Cache lines that a warp touches to gather a quantity of so many numbers, which are stored side by side.

    It takes a load for each of them, and each goes to as many lines as all of it lies in: costs grow with the square.
    """
    return numbers * min(CLUSTERS * (1.0 + SPREAD[lists] * numbers * size / LINE), GROUP)


def predict(trial: Trial, counts: Counts, machine: Machine = H100) -> dict:
    """Foretell the speed of a layout from the ceilings of a machine: the tightest one counts.

    Returns:
        ``pairs_per_s``, ``limit``: name of the ceiling, ``bytes``: of a particle, lists and gathered values.
    """
    layout, size = trial.layout, {"float32": 4, "float64": 8}[trial.precision]
    listed = layout.lists in ("rows", "columns")
    place, entry = (8 if layout.wide else size), (2 if layout.short else 4)
    values = 3 + 4 + layout.stress  # v, m, rho, vol, cs, sig
    gathered = 3 * place * counts.candidates + values * size * counts.pairs
    lists = entry * counts.candidates * listed
    own = 3 * place + values * size + 4 * size + 8 * listed
    gathers = counts.candidates * lines(3, place, layout.lists)
    gathers += counts.pairs * sum(lines(k, size, layout.lists) for k in (3, 1, 1, 1, 1, layout.stress))
    entries = counts.candidates * LIST_LINES[layout.lists] * max(entry / 4, 1.0 / LIST_LINES["rows"])
    work = counts.candidates * (LOOK[layout.lists] + COMPUTE * COMPUTED[layout.lists])
    seconds = {
        "memory": (own + lists) / machine.hbm,
        "second-level cache": (own + lists + DISTINCT * gathered) / machine.l2,
        "first-level cache": (gathers + entries) / GROUP / machine.lines,
        "instructions": work / dict(machine.issue)[trial.precision],
    }
    limit = max(seconds, key=seconds.get)
    return {"pairs_per_s": counts.pairs / seconds[limit], "limit": limit, "bytes": own + lists + gathered}
