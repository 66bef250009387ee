"""Compressed rows of neighbours: the one structure for present and for reference neighbours."""

import numpy as np
import warp as wp

from .errors import RunError
from .kernels.neighbours import NeighbourKernels
from .launch import Launcher

GROWTH = 1.2
"""Rows that no longer fit get this much more than they need."""

CELLS = {1: (4096, 1, 1), 2: (256, 256, 1), 3: (64, 64, 64)}
"""Cells of the hash grid; the grid wraps around, so a larger domain only costs a few more distance checks."""


class Rows:
    """Neighbours of every particle, found with a hash grid.

    Attributes:
        grid: The hash grid, as it was last built.
        start: Row offsets, shape [n + 1], int32.
        n_neigh: Entries in use in each row, shape [n], int32.
        neigh: Entries (particle index and mirror bits), shape [capacity], int32; grows, never truncates.
    """

    def __init__(
        self,
        n: int,
        dim: int,
        place: type,
        kernels: NeighbourKernels,
        launcher: Launcher,
        lasting: bool = False,
    ):
        """Allocate rows for n particles; the first filling makes room for the entries.

        Args:
            n: Number of particles.
            dim: Space dimension.
            place: Scalar type of positions.
            kernels: The search.
            launcher: The device.
            lasting: The rows are filled once: they get no room to grow.
        """
        self._n, self._kernels, self._launcher, self._lasting = n, kernels, launcher, lasting
        with wp.ScopedDevice(launcher.device):
            self.grid = wp.HashGrid(*CELLS[dim], dtype=place)
            self._room = wp.zeros(n + 1, dtype=wp.int32)  # the last stays 0: the scan ends in the total
            self._overflow = wp.zeros(1, dtype=wp.int32)
            self.start = wp.zeros(n + 1, dtype=wp.int32)
            self.n_neigh = wp.zeros(n, dtype=wp.int32)
            self.neigh = wp.empty(1, dtype=wp.int32)

    def fill(self, *sources: object, **named: object) -> bool:
        """Find every neighbour; the arguments are those of the kernel. Tells whether ``neigh`` moved in memory.

        Reading one flag back is the only synchronisation: rows keep their place as long as all of them have room.
        """
        self._run(sources, named)
        if not self._overflow.numpy()[0]:
            return False
        moved = self._enlarge()
        self._run(sources, named)
        return moved

    def _run(self, sources: tuple, named: dict) -> None:
        self._overflow.zero_()
        self._launcher.launch(
            self._kernels.fill, self._n, self, *sources, grid=self.grid, overflow=self._overflow, **named
        )

    def _enlarge(self) -> bool:
        """Make room for what the last filling counted.

        Raises:
            RunError: Offsets no longer fit into 32 bits.
        """
        self._launcher.launch(
            self._kernels.reserve, self._n, self, lasting=int(self._lasting), room=self._room
        )
        wp.utils.array_scan(self._room, self.start, inclusive=False)
        total = int(self.start[self._n :].numpy()[0])
        if total < 0:
            raise RunError(f"the neighbour rows of {self._n} particles need more than {2**31 - 1} entries")
        if total <= self.neigh.size:
            return False
        with wp.ScopedDevice(self._launcher.device):
            self.neigh = wp.empty(total if self._lasting else int(GROWTH * total), dtype=wp.int32)
        return True

    def mean_count(self) -> float:
        """Mean length of the rows."""
        return float(np.mean(self.n_neigh.numpy()))
