"""Neighbour rows of present positions, rebuilt when particles have moved further than the Verlet skin allows."""

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher, Pieces
from warpsph.kernels.neighbours import make_neighbours
from warpsph.memory.policy import Policy
from warpsph.particles import Particles

from .block import Block
from .cells import CellList, count_cells
from .rows import Rows
from .tiles import Tiles

SORT_EVERY = 20
"""Particles are re-sorted in memory at every so many rebuilds."""

MAX_PARTICLES = 1 << 28
"""Entries keep 28 bits for the particle index."""


class Neighbours:
    """Compressed rows of all pairs closer than the kernel's support plus the skin.

    With Lagrangian particles only those near an Eulerian one or near another body have rows. Particles are then
    sorted in memory once and for all: reference neighbours stay the same.

    Attributes:
        start: Where rows begin, shape [n + 1], int32, see `warpsph.search.rows.Rows`.
        n_neigh: Entries in use in each row, shape [n], int32.
        neigh: Entries, see `warpsph.search.rows.Rows`.
        role: 0: no row; 1: a row; 2: its tile may have Eulerian particles; below 0: was eroded, see `kernels.tiles`;
            shape [n], int32 (1 long if all have rows).
        unlisted: 1: a particle converted whose neighbours have no rows, shape [1], int32.
        x_listed: Positions at the last build [m], shape [n, 3].
        tiles: Tells when the rows are worn out.
        support: Reach of the smoothing kernel [m].
        radius: Reach of the rows [m].
        plane: Positions of the symmetry planes normal to x, y, z [m].
        plane_mask: Bits 1, 2, 4: there is a plane normal to x, y, z.
        cells: The particles by cells of space; while they are searched ``x_listed`` is in their order.
        search: The rows.
        block: The memory of the entries, and of the work of rebuilding them.
        builds: Number of builds so far.
    """

    def __init__(
        self,
        particles: Particles,
        launcher: Launcher,
        planes,
        policy: Policy,
        *,
        x: np.ndarray,
        spacing: float,
        support: float,
        skin: float,
        selective: bool = False,
        erosion: bool = False,
        searching: bool = True,
    ):
        """Allocate for particles that interact within ``support`` [m]; ``skin`` [m] is added.

        Args:
            particles: The particles.
            launcher: The device.
            planes: Symmetry planes as (axis, position [m]).
            policy: What memory may be spent on.
            x: Positions at the start [m], shape [n, 3].
            spacing: Particle spacing [m].
            support: Reach of the smoothing kernel [m].
            skin: Verlet skin [m].
            selective: There are Lagrangian particles.
            erosion: They may be eroded.
            searching: Rows are needed at all: a single Lagrangian body needs none.
        """
        spec, n = particles.spec, particles.n
        self._particles, self._launcher = particles, launcher
        self._selective, self._searching = selective, searching
        self.tiles = Tiles(particles, launcher, spacing, selective)
        self.support, self.radius = support, support + skin
        self.plane = spec.point(*(dict(planes).get(axis, 0.0) for axis in range(3)))
        self.plane_mask = sum(1 << axis for axis, _ in planes)
        self._kernels = make_neighbours(spec, bool(planes), selective=selective, erosion=erosion)
        self.block = Block(launcher.device)
        with wp.ScopedDevice(launcher.device):
            self.role = wp.zeros(n if selective else 1, dtype=wp.int32)
            self.unlisted = wp.zeros(1, dtype=wp.int32)
            self.x_listed = wp.zeros(n, dtype=spec.point)
        counts = count_cells(x, spec.dim, self.radius, [axis for axis, _ in planes])
        self.cells = CellList(n, spec, counts, self.x_listed, launcher)
        self.search = Rows(n, self.cells, self._kernels, launcher, policy, self.block, selective)
        self.builds = 0

    @property
    def start(self) -> wp.array | Pieces:
        """Where rows begin, shape [n + 1], int32."""
        return self.search.start

    @property
    def n_neigh(self) -> wp.array:
        """Entries in use in each row, shape [n], int32."""
        return self.search.n_neigh

    @property
    def neigh(self) -> wp.array | Pieces:
        """Entries, shape [capacity], int32."""
        return self.search.neigh

    @property
    def generation(self) -> int:
        """Changes when ``neigh`` has moved in memory: launches must be bound again."""
        return self.search.generation

    def build(self) -> bool:
        """Rebuild the rows, and re-sort the particles in memory first when it is time to: True if they have moved."""
        p = self._particles
        if self.builds > 0 and not self._searching:
            return False
        sorting = self.builds == 0 or (self.builds % SORT_EVERY == 0 and not self._selective)
        if sorting:
            self._reserve()
            self._sort()
            self.block.views((p.largest, p.n))  # all fields move, or none if there is no memory for it
            p.reorder(self.cells.order, lambda dtype: self.block.views((dtype, p.n))[0])
        self.builds += 1
        if not self._searching:
            self._sort()
            self.block.release()
            return sorting
        self._list()
        self.unlisted.zero_()
        return sorting

    def lasting(self) -> dict[str, wp.array]:
        """What the rows were built from, and whether they still serve, by name: `recall` makes them again from it."""
        if not self._searching:
            return {}
        role = {"role": self.role} if self._selective else {}
        return {"x_listed": self.x_listed, "unlisted": self.unlisted} | role

    def recall(self, arrays: dict[str, np.ndarray], width: float) -> None:
        """Make the rows that there were, entry by entry; leaves the particles where they are.

        Args:
            arrays: What `lasting` gave, on the host.
            width: The tiles' width then [m].
        """
        if not self._searching:
            return
        x, role = self._particles.x, arrays.get("role")
        now = x.numpy().copy()
        x.assign(arrays["x_listed"])
        self.tiles.width = width
        if role is not None:
            self.role.assign(role)
        self._list(role)
        x.assign(now)
        self.unlisted.assign(arrays["unlisted"])

    def _list(self, role: np.ndarray | None = None) -> None:
        """Cells, tiles and rows of the particles where they are."""
        block, x = self.block, self._particles.x
        rest = (self, block, self._reserve())
        self._launcher.share([self.tiles.prepare(*rest), self.cells.prepare(x, self.radius, block)])
        self.tiles.finish(*rest, role)
        self._fill(self.radius)
        wp.copy(self.x_listed, self._particles.x)

    def _reserve(self) -> list[tuple[type, int]]:
        """Make room for a rebuild; gives what of it the cells take while the tiles are built, by another thread of a CPU."""
        beside = self.cells.work if self._launcher.device.is_cpu else []

        def room() -> None:
            for layout in ([*beside, *self.tiles.work], self.cells.work):
                self.block.views(*layout)

        self.block.bound(self, room)
        return beside

    def _sort(self) -> None:
        self.cells.build(self._particles.x, self.radius, self.block)

    def _fill(self, radius: float) -> None:
        self.search.fill(self, self._particles, radius=radius)

    def mean_count(self) -> float:
        """Mean number of neighbours within the kernel's support now, the particle itself left out.

        Leaves rows without skin behind: build again before the next step.
        """
        self._sort()
        self._fill(self.support)
        return self.search.mean_count()
