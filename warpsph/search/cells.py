"""The particles in the order of cells of space: what neighbours are looked up in."""

import math
from collections.abc import Sequence

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher
from warpsph.device.score import recorded
from warpsph.device.team import Work
from warpsph.kernels.cells import ALONG, FEWEST, MARGIN, make_cells
from warpsph.kernels.sort import make_sort
from warpsph.kernels.spec import Spec

from .block import Block

PER_PARTICLE = 2
"""Cells that there may be for each particle."""

FEWEST_CELLS = 32768
"""Cells that there may be however few particles there are."""


class CellList:
    """Particles sorted by cells, see `kernels.cells`.

    Attributes:
        spec: Specialisation.
        period: Cells along x, y and z before their numbers repeat.
        cell_scale: Cells per length along the axes [1/m].
        order: Particle indices cell by cell, shape [n].
        cell_start: First place of a cell in ``order``, shape [number of cells + 1].
        x_sorted: Positions in that order [m], shape [n, 3].
    """

    def __init__(
        self, n: int, spec: Spec, counts: tuple[int, int, int], x_sorted: wp.array, launcher: Launcher
    ):
        """Allocate for n particles; ``counts``: cells along x, y and z, see `count_cells`; ``x_sorted``: room for that."""
        self._n, self.spec, self._launcher = n, spec, launcher
        self._kernels, self._gather = make_cells(spec), make_sort(spec)[spec.point]
        self.period, self.cell_scale, self.x_sorted = wp.vec3i(*counts), spec.point(), x_sorted
        self._bits = max(int(np.prod(counts)) - 1, 1).bit_length()
        with wp.ScopedDevice(launcher.device):
            self.order = wp.zeros(n, dtype=wp.int32)
            self.cell_start = wp.zeros(int(np.prod(counts)) + 1, dtype=wp.int32)

    @property
    def work(self) -> list[tuple[type, int]]:
        """Work space of a sort, as `Block.views` takes it."""
        return [(wp.int32, 2 * self._n), (wp.int32, 2 * self._n), (wp.int32, self.cell_start.size)]

    def build(self, x: wp.array, reach: float, block: Block) -> None:
        """Sort particles for searches up to a distance.

        Args:
            x: Their positions [m], shape [n, 3].
            reach: The distance [m].
            block: Work space.
        """
        self.prepare(x, reach, block)()

    def prepare(self, x: wp.array, reach: float, block: Block) -> Work:
        """Give what `build` would do."""
        width = (1.0 + MARGIN) * reach
        self.cell_scale = self.spec.point(ALONG / width, 1.0 / width, 1.0 / width)
        return block.bound((self, reach, x.ptr), lambda: self._bind(x, block))

    def _bind(self, x: wp.array, block: Block) -> Work:
        n, bind = self._n, self._launcher.bind
        key, order, count = block.views(*self.work)
        keys = bind(self._kernels.keys, n, self, x=x, key=key, order=order)
        counts = bind(self._kernels.counts, n, key=key, n=n, cell_count=count)
        gather = bind(self._gather, n, self, source=x, target=self.x_sorted)

        def sort() -> None:
            keys()
            wp.utils.radix_sort_pairs(key, order, n, end_bit=self._bits)
            count.zero_()
            counts()
            wp.utils.array_scan(count, self.cell_start, inclusive=False)
            wp.copy(self.order, order, count=n)
            gather()

        return recorded(self._launcher.device, sort)


def count_cells(x: np.ndarray, dim: int, reach: float, mirrored: Sequence[int] = ()) -> tuple[int, int, int]:
    """Cells along x, y and z, powers of two, in the proportions of the scene.

    Their numbers repeat, so a scene that outgrows them only costs a few more distance checks. They are counted at every
    rebuild and take memory, so there are no more than two for each particle (but always `FEWEST_CELLS`); what is left
    of these makes room for the scene to grow.

    Args:
        x: Positions at the start [m], shape [n, 3].
        dim: Space dimension.
        reach: Reach of the rows [m].
        mirrored: Axes normal to symmetry planes: images take as much room again.
    """
    extent, most = np.ptp(x, axis=0)[:dim], max(PER_PARTICLE * len(x), FEWEST_CELLS)
    extent[list(mirrored)] *= 2.0
    extent *= np.array([ALONG, 1, 1][:dim]) / ((1.0 + MARGIN) * reach)
    counts = [
        max(1 << int(np.ceil(np.log2(max(size, 1.0)))), few)
        for size, few in zip(extent, FEWEST, strict=False)
    ]
    while math.prod(counts) > most:  # of any size: np.prod would wrap around
        counts[int(np.argmax(counts))] //= 2
    while 2 * math.prod(counts) <= most:
        counts[int(np.argmin(counts))] *= 2
    return tuple(counts + [1] * (3 - len(counts)))


def order_of(x: np.ndarray, counts: Sequence[int], reach: float) -> np.ndarray:
    """The order that `CellList.build` brings particles into, found on the host; rounding may tell the odd one's cell.

    Args:
        x: Positions [m], shape [n, 3].
        counts: Cells along x, y and z, see `count_cells`.
        reach: Reach of the rows [m].
    """
    width, number = (1.0 + MARGIN) * reach, np.zeros(len(x), dtype=np.int32)
    for axis, along in ((2, 1), (1, 1), (0, ALONG)):
        cell = np.floor(x[:, axis] * (along / width)).astype(np.int64)
        number = number * counts[axis] + (cell & (counts[axis] - 1)).astype(np.int32)
    return np.argsort(number, kind="stable")
