"""The current neighbour rows: built from a hash grid, kept as long as a Verlet skin allows."""

import numpy as np
import warp as wp

from .errors import InputError, RunError
from .kernels.neighbours import make_neighbours
from .launch import Launcher
from .particles import Particles
from .tiles import Tiles

GROWTH = 1.2
"""Rows that no longer fit get this much more than they need."""

CELLS = {1: (4096, 1, 1), 2: (256, 256, 1), 3: (64, 64, 64)}
"""Cells of the hash grid; the grid wraps around, so a larger domain only costs a few more distance checks."""

SORT_EVERY = 20
"""Particles are re-sorted in memory at every so many rebuilds."""

MAX_PARTICLES = 1 << 28
"""Entries keep 28 bits for the particle index."""


class Neighbours:
    """Compressed rows of all pairs closer than the kernel's support plus the skin.

    Attributes:
        start: Row offsets, shape [n + 1], int32.
        n_neigh: Entries in use in each row, shape [n], int32.
        neigh: Entries (particle index and mirror bits), shape [capacity], int32; grows, never truncates.
        near: The entries within the support, as the force loop of a step leaves them, row by row like ``neigh``.
        slope: (dW/dr)/r of those [1/m^(dim+2)].
        n_near: Their number in each row, shape [n], int32.
        x_listed: Positions at the last build [m], shape [n, 3].
        tiles: Tells when the rows are worn out.
        support: Reach of the smoothing kernel [m].
        radius: Reach of the rows [m].
        plane: Positions of the symmetry planes normal to x, y, z [m].
        plane_mask: Bits 1, 2, 4: there is a plane normal to x, y, z.
        builds: Number of builds so far.
        generation: Changes when ``neigh`` was reallocated: launches must be bound again.
    """

    def __init__(
        self, particles: Particles, launcher: Launcher, planes, *, spacing: float, support: float, skin: float
    ):
        """Allocate for particles that interact within ``support`` [m]; ``skin`` [m] is added.

        Raises:
            InputError: There are more particles than an entry can name.
        """
        spec, n = particles.spec, particles.n
        if n > MAX_PARTICLES:
            raise InputError(f"particles = {n} is out of range; allowed: up to {MAX_PARTICLES} on one device")
        self._particles, self._launcher = particles, launcher
        self.tiles = Tiles(particles, launcher, spacing)
        self.support, self.radius = support, support + skin
        self.plane = spec.vec(*(dict(planes).get(axis, 0.0) for axis in range(3)))
        self.plane_mask = sum(1 << axis for axis, _ in planes)
        self._kernels = make_neighbours(spec, bool(planes))
        with wp.ScopedDevice(launcher.device):
            self._grid = wp.HashGrid(*CELLS[spec.dim], dtype=spec.real)
            self._room = wp.zeros(n + 1, dtype=wp.int32)  # the last stays 0: the scan ends in the total
            self._overflow = wp.zeros(1, dtype=wp.int32)
            self.n_neigh = wp.zeros(n, dtype=wp.int32)
            self._order = wp.zeros(n, dtype=wp.int32)
            self.start = wp.zeros(n + 1, dtype=wp.int32)
            self.n_near = wp.zeros(n, dtype=wp.int32)
            self.x_listed = wp.zeros(n, dtype=spec.vec)
        self._allocate(1)
        self.builds, self.generation = 0, 0

    def build(self) -> None:
        """Rebuild the rows, and re-sort the particles in memory first when it is time to.

        Reading one flag back is the only synchronisation: rows keep their place as long as all of them have room.
        """
        p = self._particles
        self._grid.build(p.x, self.radius)
        if self.builds % SORT_EVERY == 0:
            self._launcher.launch(self._kernels.cell_order, p.n, grid=self._grid, order=self._order)
            p.reorder(self._order)
            self._grid.build(p.x, self.radius)
        self._fill(self.radius)
        if self._overflow.numpy()[0]:
            self._enlarge()
            self._fill(self.radius)
        wp.copy(self.x_listed, p.x)
        self.tiles.build(self.plane, self.plane_mask)
        self.builds += 1

    def _fill(self, radius: float) -> None:
        self._overflow.zero_()
        self._launcher.launch(
            self._kernels.fill, self._particles.n, self, self._particles,
            grid=self._grid, radius=radius, overflow=self._overflow,
        )  # fmt: skip

    def _enlarge(self) -> None:
        """Make room for what the last filling counted.

        Raises:
            RunError: Offsets no longer fit into 32 bits.
        """
        n = self._particles.n
        self._launcher.launch(self._kernels.reserve, n, self, room=self._room)
        wp.utils.array_scan(self._room, self.start, inclusive=False)
        total = int(self.start[n:].numpy()[0])
        if total < 0:
            raise RunError(f"the neighbour rows of {n} particles need more than {2**31 - 1} entries")
        if total > self.neigh.size:
            self._allocate(int(GROWTH * total))
            self.generation += 1

    def _allocate(self, capacity: int) -> None:
        with wp.ScopedDevice(self._launcher.device):
            self.neigh = wp.empty(capacity, dtype=wp.int32)
            self.near = wp.empty(capacity, dtype=wp.int32)
            self.slope = wp.empty(capacity, dtype=self._particles.spec.real)

    def mean_count(self) -> float:
        """Mean number of neighbours within the kernel's support now, the particle itself left out.

        Leaves rows without skin behind: build again before the next step.
        """
        self._grid.build(self._particles.x, self.radius)
        self._fill(self.support)
        return float(np.mean(self.n_neigh.numpy()))
