"""Compressed rows of neighbours: the one structure for present and for reference neighbours."""

import itertools
from dataclasses import replace

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher, Pieces
from warpsph.device.score import written_out
from warpsph.device.team import Work
from warpsph.kernels.neighbours import NeighbourKernels
from warpsph.memory.policy import Policy
from warpsph.messages import stops

from .block import Block, borrowed
from .cells import CellList

LENGTH = 1 << 22
"""Particles whose rows share an array: it has less than 2^31 entries, hence 450 for each of them. Rows that stand side
by side share one, so it is a multiple of their number."""

MOST_ENTRIES = 2**31 - 2**28
"""Entries of an array at most: a search that counts on beyond the last row's end, by 32 at a time, stays below 2^31."""


class Rows:
    """Neighbours of every particle, found among the cells of a `CellList`.

    Attributes:
        cells: The particles by cells, as they were last sorted.
        start: Where rows begin, shape [n + 1], int32; `Pieces` of these if there are more than `LENGTH` particles. On a
            GPU those of 32 particles stand side by side, see `kernels.neighbours`.
        neigh: Entries (particle index and mirror bits), shape [capacity], int32, in pieces as ``start`` is.
        n_neigh: Entries in use in each row, shape [n], int32.
        generation: Changes when entries have moved in memory: launches must be bound again.
    """

    def __init__(
        self,
        n: int,
        cells: CellList,
        kernels: NeighbourKernels,
        launcher: Launcher,
        policy: Policy,
        block: Block,
        selective: bool = False,
    ):
        """Allocate; the first filling makes room for the entries.

        Args:
            n: Number of particles.
            cells: What neighbours are looked up in.
            kernels: The search.
            launcher: The device.
            policy: Room of the rows.
            block: Where the entries go.
            selective: Particles may come to have a row that had none, by their ``role``. They get room ahead of a search
                on a CPU, where rows have room to spare.
        """
        self._n, self.cells = n, cells
        self._kernels, self._launcher, self._policy, self._block = kernels, launcher, policy, block
        with wp.ScopedDevice(launcher.device):
            self._overflow = wp.zeros(1, dtype=wp.int32)
            self._starts = wp.zeros(n + len(self._cuts()), dtype=wp.int32)
            self.n_neigh = wp.zeros(n, dtype=wp.int32)
        self.start = self._by_particle(self._starts)
        self._rooms, self._layouts = [1] * len(self._cuts()), 0
        self._expecting, self._typical = selective and policy.lanes > 1, 0

    @property
    def generation(self) -> int:
        """Changes when entries have moved in memory."""
        return self._block.generation + self._layouts

    @property
    def capacity(self) -> int:
        """Entries that there is room for."""
        return sum(self._rooms)

    @property
    def neigh(self) -> wp.array | Pieces:
        """Entries; grows, never truncates."""
        return self.by_entry(self._block, wp.int32)

    def by_entry(self, block: Block, dtype: type) -> wp.array | Pieces:
        """Memory of ``capacity`` entries as the rows are laid out."""
        firsts = itertools.accumulate(self._rooms, initial=0)
        arrays = tuple(
            block.view(dtype, first, room) for first, room in zip(firsts, self._rooms, strict=False)
        )
        return Pieces(arrays, LENGTH) if len(arrays) > 1 else arrays[0]

    def _cuts(self) -> list[tuple[int, int]]:
        """First and last but one particle of each piece."""
        return [(first, min(first + LENGTH, self._n)) for first in range(0, self._n, LENGTH)]

    def _by_particle(self, words: wp.array) -> wp.array | Pieces:
        """An array of one word for each particle, and one more for each piece, by the particle's index."""
        if words.size == self._n + 1:
            return words
        pieces = range(words.size - self._n)
        views = (borrowed(words, 4 * k, wp.int32, self._n + 1) for k in pieces)
        return Pieces(tuple(views), LENGTH)

    def fill(self, *sources: object, **named: object) -> None:
        """Find every neighbour; the arguments are those of the kernel.

        Reading one flag back is the only synchronisation: rows keep their place as long as all of them have room. Of rows
        that are new another flag tells, so that they get room before they are found to have none.
        """
        if self._expecting and self._typical and self._newcomers(sources):
            self._enlarge()
        self._run(sources, named)
        if self._overflow.numpy()[0]:
            self._enlarge()
            self._run(sources, named)

    def _run(self, sources: tuple, named: dict) -> None:
        self._overflow.zero_()
        given = (getattr(value, "ptr", value) for value in named.values())
        key = (self, self._layouts, *self.cells.cell_scale, *sources, *given)
        self._block.bound(key, lambda: self._bind(sources, named))()

    def _bind(self, sources: tuple, named: dict) -> Work:
        fill = self._launcher.bind(
            self._kernels.fill, self._n, self, self.cells, *sources, overflow=self._overflow, **named
        )
        return written_out(self._launcher, self.cells.spec, fill)

    def _newcomers(self, sources: tuple) -> bool:
        """Whether there are particles that had no row, need one now and have no room for it."""
        self._overflow.zero_()
        self._launcher.launch(
            self._kernels.expect, self._n, self, *sources, typical=self._typical, overflow=self._overflow
        )
        return bool(self._overflow.numpy()[0])

    def _enlarge(self) -> None:
        """Make room for what the last filling counted, and for what is expected.

        Raises:
            RunError: Offsets no longer fit into 32 bits.
        """
        if self._expecting and not self._typical:
            counts = self.n_neigh.numpy()
            self._typical = int(counts.sum() / max(np.count_nonzero(counts), 1))
        totals = self._lay_out()
        if min(totals) < 0 or max(totals) > MOST_ENTRIES:
            raise stops.crowded(min(LENGTH, self._n), MOST_ENTRIES)
        if any(total > room for total, room in zip(totals, self._rooms, strict=True)):
            self._rooms = [min(max(int(self._policy.growth * total), 1), MOST_ENTRIES) for total in totals]
            self._block.grow(self.capacity)
            self._layouts += 1

    def _lay_out(self) -> list[int]:
        """Find where each row starts; gives the entries of each piece. It keeps no view of the block, which may move next."""
        (room,) = self._block.views((wp.int32, self._starts.size))
        room.zero_()  # the last of a piece stays 0: its scan ends in the total
        self._launcher.launch(
            self._kernels.reserve, self._n, self, self._policy, room=self._by_particle(room)
        )
        totals = []
        for k, (first, last) in enumerate(self._cuts()):
            starts = self._starts[first + k : last + k + 1]
            wp.utils.array_scan(room[first + k : last + k + 1], starts, inclusive=False)
            totals.append(int(starts[last - first :].numpy()[0]))
        return totals

    def mean_count(self) -> float:
        """Mean length of the rows."""
        return float(np.mean(self.n_neigh.numpy()))


def lasting(policy: Policy) -> Policy:
    """The same policy for rows that are filled once: no room to grow but the place that the search needs."""
    return replace(policy, divisor=1 << 30, spare=1, growth=1.0)
