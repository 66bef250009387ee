"""Reference neighbours of Lagrangian particles and what the step loops need of each: found once (method section 4)."""

from collections.abc import Callable

import warp as wp

from warpsph.device.launch import Command, Launcher
from warpsph.kernels.correction import make_correction
from warpsph.kernels.coupling import EDGE
from warpsph.kernels.neighbours import make_neighbours
from warpsph.kernels.reference import make_reference
from warpsph.kernels.smoothing import Smoothing
from warpsph.memory.policy import Policy
from warpsph.particles import Particles

from .block import Block
from .cells import CellList, count_cells
from .neighbours import Neighbours
from .rows import Rows, lasting


class Reference:
    """Rows of neighbours of the same body in the reference configuration, and what the step loops need of them.

    Attributes:
        start0: Row offsets, shape [n + 1], int32.
        n_neigh0: Entries in use in each row, shape [n], int32.
        neigh0: Entries, see `warpsph.search.rows.Rows`.
        slope0: V0_b W'/r of the entries [1/m²], shape [capacity].
        w0: V0_b W of them with correction [-]; else 1 long.
        q0_sum: Sum of a row's gradients before K, shape [n, 3].
        K0: Correction in the reference configuration, see `kernels.correction`; 1 long without.
        G0: The same.
        mean_count: Mean number of reference neighbours.
        rows: The memory of ``neigh0``.
        slopes: That of ``slope0``.
        weights: That of ``w0``.
    """

    def __init__(
        self,
        particles: Particles,
        launcher: Launcher,
        neighbours: Neighbours,
        smoothing: Smoothing,
        corrected: bool,
        policy: Policy,
    ):
        """Pick the kernels; `build` allocates and fills.

        Args:
            particles: The particles; ``X`` and ``vol0`` are their reference configuration.
            launcher: The device.
            neighbours: The present neighbours, for support and symmetry planes.
            smoothing: Smoothing kernel.
            corrected: Mixed correction in the reference configuration.
            policy: What memory may be spent on.
        """
        spec, planes = particles.spec, neighbours.plane_mask > 0
        self._particles, self._launcher, self._neighbours = particles, launcher, neighbours
        self._corrected, self._policy = corrected, lasting(policy)
        self._search = make_neighbours(spec, planes, same_body=True)
        self._correction = make_correction(spec, smoothing, planes, erosion=True) if corrected else None
        self._pairs = make_reference(spec, smoothing, corrected, planes)
        n = particles.n if corrected else 1
        with wp.ScopedDevice(launcher.device):
            self.K0 = wp.zeros(n, dtype=spec.mat)
            self.G0 = wp.zeros(n, dtype=spec.vec)
            self.q0_sum = wp.zeros(particles.n, dtype=spec.vec)

    def build(self) -> None:
        """Find reference neighbours in the particles' present order in memory; `pairs` has to follow."""
        p, spec = self._particles, self._particles.spec
        reach, block = self._neighbours.support, Block(self._launcher.device)
        counts = count_cells(p.X.numpy(), spec.dim, reach)
        cells = CellList(p.n, spec, counts, wp.empty_like(p.X), self._launcher)
        rows = Rows(p.n, cells, self._search, self._launcher, self._policy, block)
        cells.build(p.X, reach, block)
        self.rows = block
        rows.fill(self._neighbours, p, x=p.X, radius=EDGE * reach)
        self.start0, self.n_neigh0, self.neigh0 = rows.start, rows.n_neigh, rows.neigh
        self.mean_count = rows.mean_count()
        self.slopes, self.weights = Block(self._launcher.device), Block(self._launcher.device)
        words = wp.types.type_size_in_bytes(spec.real) // 4
        self.slopes.grow(rows.capacity * words)
        self.slopes.lines.zero_()  # what fills up a row counts nothing
        self.slope0 = rows.by_entry(self.slopes, spec.real)
        self.w0 = self.weights.view(spec.real, 0, 1)
        if self._corrected:
            self.weights.grow(rows.capacity * words)
            self.weights.lines.zero_()
            self.w0 = rows.by_entry(self.weights, spec.real)

    def pairs(self, bind: Callable[..., Command], when: str) -> list[Command]:
        """The launches that fill the rows, of particles that are not eroded, where the array ``when`` is not zero."""
        pairs = bind(self._pairs, dt=when)
        if self._correction is None:
            return [pairs]
        rows = {"start": "start0", "n_neigh": "n_neigh0", "neigh": "neigh0"}
        return [bind(self._correction, x="X", vol="vol0", K="K0", G="G0", dt=when, **rows), pairs]
