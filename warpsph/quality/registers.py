"""The tables of docs/registers.md: what kernels take of a multiprocessor, and how many threads of them fit on one."""

import inspect
import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import warp as wp

from warpsph.device.launch import BLOCK
from warpsph.messages import measuring

from . import report
from .ptxas import Usage

NEIGHBOUR_ROWS = {"neigh", "neigh0"}
"""Arguments that tell a pair loop: the neighbour rows."""

REGISTERS, WARPS, BLOCKS, PARTITIONS = 65536, 64, 32, 4
"""Of one multiprocessor, on an A100 (sm_80) as on an H100 (sm_90); each partition has its share of the registers."""

_ENTRY_NAME = re.compile(r"(?P<key>\w+)_[0-9a-f]+_cuda_kernel_forward")


@dataclass(frozen=True)
class Row:
    """One kernel, as compiled for one architecture.

    Attributes:
        kernel: File and name, as in ``kinematics.velocity_gradient``.
        variant: Compile-time options beyond dimension and precision; empty if there are none.
        dim: Space dimension.
        precision: ``"f32"`` or ``"f64"``.
        arch: Architecture: 80 for ``sm_80``.
        shown: Whether its variant has a row of its own in the documentation.
        pairs: Whether it is a pair loop.
        usage: What it takes.
    """

    kernel: str
    variant: str
    dim: int
    precision: str
    arch: int
    shown: bool
    pairs: bool
    usage: Usage

    def __str__(self) -> str:
        """One line that names it."""
        variant = f" ({self.variant})" if self.variant else ""
        return f"{self.kernel}{variant}, {self.dim}D {self.precision}, sm_{self.arch}"


def by_kernel(module: wp.Module, found: dict[str, Usage]) -> list[tuple[wp.Kernel, Usage]]:
    """Give each entry that ptxas told of to the kernel it comes from.

    Raises:
        RunError: If it told nothing of one of the module's kernels.
    """
    keys = {entry: match["key"] for entry in found if (match := _ENTRY_NAME.fullmatch(entry))}
    for key in module.kernels.keys() - keys.values():
        raise measuring.ptxas_silent(key, module.name)
    return [(module.kernels[key], found[entry]) for entry, key in keys.items()]


def is_pair_loop(kernel: wp.Kernel) -> bool:
    """Whether a kernel goes through neighbour rows."""
    return not NEIGHBOUR_ROWS.isdisjoint(inspect.signature(kernel.func).parameters)


def occupancy(registers: int, threads: int = BLOCK) -> float:
    """Share of a multiprocessor's warps that can be resident, as far as registers and the size of blocks decide.

    Registers are given out to warps in units of 256, by partition (CUDA C++ Programming Guide, compute capability 8.0
    and 9.0).
    """
    per_warp = -(-registers * 32 // 256) * 256
    warps = REGISTERS // PARTITIONS // per_warp * PARTITIONS
    per_block = threads // 32
    blocks = min(min(warps, WARPS) // per_block, BLOCKS)
    return blocks * per_block / WARPS


def ladder() -> str:
    """Table of the occupancy that a number of registers allows; a row for each step."""
    sizes = (256, 128, 64)
    shares = {n: [occupancy(n, threads) for threads in sizes] for n in range(8, 256)}
    steps = [n for n in shares if n == 255 or shares[n] != shares[n + 1]]
    rows = [(str(n), *(f"{share:.0%}" for share in shares[n])) for n in steps]
    return report.markdown(("registers, at most", *(f"blocks of {threads}" for threads in sizes)), rows)


def pairs_table(rows: Iterable[Row], arch: int = 90) -> str:
    """Table of the pair loops that are shown by variant: a column for a dimension and precision."""
    chosen = [row for row in rows if row.shown and row.pairs and row.arch == arch and row.dim > 1]
    columns = sorted({(row.dim, row.precision) for row in chosen})
    lines = defaultdict(dict)
    for row in chosen:
        lines[row.kernel, row.variant][row.dim, row.precision] = row.usage
    header = ("pair loop", "variant", *(f"{dim}D {precision}" for dim, precision in columns))
    return report.markdown(
        header,
        (
            (f"`{kernel}`", variant.replace("_", " "), *(_cell(cells.get(column)) for column in columns))
            for (kernel, variant), cells in sorted(lines.items())
        ),
    )


def worst_table(rows: Iterable[Row]) -> str:
    """Table of all kernels: the most that any variant takes in any dimension and on any architecture."""
    groups = defaultdict(list)
    for row in rows:
        groups[row.kernel].append(row)
    precisions = sorted({row.precision for group in groups.values() for row in group})
    header = (
        "kernel",
        "compiled",
        *(f"registers {precision}" for precision in precisions),
        "local memory [B]",
        "spill stores, loads [B]",
        "shared [B]",
    )
    return report.markdown(header, (_worst(groups[kernel], precisions) for kernel in sorted(groups)))


def spilling_pair_loops(rows: Iterable[Row]) -> list[str]:
    """One line for each pair loop that spills registers."""
    return [
        f"{row}: {row.usage.registers} registers, spills {row.usage.stores} B and fetches {row.usage.loads} B"
        for row in rows
        if row.pairs and row.usage.spilled
    ]


def with_local_memory(rows: Iterable[Row]) -> list[str]:
    """One line for each kernel that keeps something in local memory."""
    return [f"{row}: {row.usage.stack} B of local memory" for row in rows if row.usage.stack > 0]


def _cell(usage: Usage | None) -> str:
    """Registers and occupancy, and what is wrong."""
    if usage is None:
        return ""
    text = f"{usage.registers} ({occupancy(usage.registers):.0%})"
    if usage.stack:
        text += f", local {usage.stack} B"
    return text + (f", spills {usage.stores}/{usage.loads} B" if usage.spilled else "")


def _worst(group: list[Row], precisions: list[str]) -> tuple[str, ...]:
    """Row of the table of all kernels."""
    most = {p: max((r.usage.registers for r in group if r.precision == p), default=None) for p in precisions}
    usages = [row.usage for row in group]
    return (
        f"`{group[0].kernel}`" + (" (pairs)" if group[0].pairs else ""),
        str(len(group)),
        *("" if n is None else f"{n} ({occupancy(n):.0%})" for n in most.values()),
        str(max(usage.stack for usage in usages)),
        f"{max(usage.stores for usage in usages)}, {max(usage.loads for usage in usages)}",
        str(max(usage.shared for usage in usages)),
    )
