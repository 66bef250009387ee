"""Tiles of space over the particles, rebuilt with the neighbour rows: they tell when the rows are worn out."""

import functools
from collections.abc import Sequence

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher
from warpsph.device.score import recorded
from warpsph.device.team import Work
from warpsph.kernels.tiles import KEY_BITS, make_tiles
from warpsph.particles import Particles

from .block import Block

PER_TILE = 128
"""Particles a tile is meant to hold."""

MOST_CPU, MOST_CUDA = 512, 4096
"""Tiles at most: every step compares each with each. Where there are more, tiles grow. A GPU needs them as threads."""


HANDS_CPU, HANDS_CUDA = 1, 8
"""Threads that share the particles of a tile, and its comparison with the others, in every step."""


def tiles_of(device: wp.Device) -> tuple[int, int]:
    """Tiles at most, and threads that share one, on a device."""
    return (MOST_CUDA, HANDS_CUDA) if device.is_cuda else (MOST_CPU, HANDS_CPU)


def first_width(n: int, most: int, spacing: float, dim: int) -> float:
    """Width of the tiles of n particles [m], before they grow."""
    return spacing * max(PER_TILE, 4 * n // most) ** (1.0 / dim)


class Tiles:
    """Members and boxes of the tiles, and how far their particles have moved.

    Attributes:
        most: Tiles at most.
        hands: Threads that share a tile in every step.
        width: Edge of the tiles [m]; it grows with the scene.
        member: Particle indices tile by tile, shape [n].
        tile_start: First place of a tile in ``member``, shape [most + 1].
        n_tiles: Number of tiles, shape [1].
        box_low: Lower corners of the tiles at the last build [m], shape [most, 3].
        box_high: Upper corners of the tiles at the last build [m].
        moved_low: Lower bounds of the displacements since then [m].
        moved_high: Upper bounds of the displacements since then [m].
        hand_low: The same of each hand's particles, shape [most * hands, 3]; 1 long with one hand, as the next one.
        hand_high: The same.
        tile_wear: Share of the allowed approach used up, shape [most * hands]; see `kernels.tiles`.
        active: 1: the tile may have Eulerian particles (with Lagrangian ones elsewhere; else 1 long, as the next three).
        body_first: Lowest body in the tile.
        body_last: Highest body in the tile.
        tile_role: Role of the tile's particles.
    """

    def __init__(self, particles: Particles, launcher: Launcher, spacing: float, selective: bool = False):
        """Allocate; ``selective``: there are Lagrangian particles."""
        n, spec = particles.n, particles.spec
        self._particles, self._launcher, self._selective = particles, launcher, selective
        self._kernels = make_tiles(spec, selective)
        self.most, self.hands = tiles_of(launcher.device)
        self.width = first_width(n, self.most, spacing, spec.dim)
        with wp.ScopedDevice(launcher.device):
            self.member = wp.zeros(n, dtype=wp.int32)
            self.tile_start = wp.zeros(self.most + 1, dtype=wp.int32)
            self.n_tiles = wp.zeros(1, dtype=wp.int32)
            self.box_low = wp.zeros(self.most, dtype=spec.point)
            self.box_high = wp.zeros(self.most, dtype=spec.point)
            self.moved_low = wp.zeros(self.most, dtype=spec.vec)
            self.moved_high = wp.zeros(self.most, dtype=spec.vec)
            shared = self.most * self.hands if self.hands > 1 else 1
            self.hand_low = wp.zeros(shared, dtype=spec.vec)
            self.hand_high = wp.zeros(shared, dtype=spec.vec)
            self.tile_wear = wp.zeros(self.most * self.hands, dtype=spec.real)
            told = self.most if selective else 1
            self.active = wp.zeros(told, dtype=wp.int32)
            self.body_first = wp.zeros(told, dtype=wp.int32)
            self.body_last = wp.zeros(told, dtype=wp.int32)
            self.tile_role = wp.zeros(told, dtype=wp.int32)

    @property
    def work(self) -> list[tuple[type, int]]:
        """Work space of building them, as `Block.views` takes it."""
        n, i32 = self._particles.n, wp.int32
        return [(i32, 2 * n), (i32, 2 * n), (i32, n), (i32, n)]

    def prepare(self, rows: object, block: Block, beside: Sequence[tuple[type, int]]) -> Work:
        """Give the work of sorting the particles into tiles of the present width; `finish` has to follow.

        Args:
            rows: What knows the symmetry planes (``plane``, ``plane_mask``) and the rows' reach (``radius``), and
                takes the particles' ``role``.
            block: Work space.
            beside: Other work space of the block that is in use meanwhile.
        """
        views = functools.partial(block.views, *beside, *self.work)
        return block.bound((self, self.width), lambda: self._bind(rows, *views()[-len(self.work) :]))

    def _bind(self, rows: object, key: wp.array, member: wp.array, head: wp.array, number: wp.array) -> Work:
        p, k, bind, n = self._particles, self._kernels, self._launcher.bind, self._particles.n
        keys = bind(k.keys, n, p, width=self.width, key=key, member=member)
        heads = bind(k.heads, n, key=key, head=head)
        starts = bind(k.starts, n, self, head=head, number=number, n=n)
        looks = [bind(k.boxes, self.most, self, p, rows)]
        if self._selective:
            looks.append(bind(k.contents, self.most, self, p))

        def sort() -> None:
            keys()
            wp.utils.radix_sort_pairs(key, member, n, end_bit=KEY_BITS * p.spec.dim)
            heads()
            wp.utils.array_scan(head, number, inclusive=True)
            starts()
            wp.copy(self.member, member, count=n)
            for look in looks:
                look()

        return recorded(self._launcher.device, sort)

    def finish(
        self, rows: object, block: Block, beside: Sequence[tuple[type, int]], role: np.ndarray | None
    ) -> None:
        """Let tiles grow until there are no more than ``most``, and give particles their roles.

        Args:
            rows: As in `prepare`, as are the next two.
            block: Work space.
            beside: Other work space.
            role: The particles' roles, shape [n], where they are known; found if None.
        """
        while int(self.n_tiles.numpy()[0]) > self.most:
            self.width *= 1.5
            self.prepare(rows, block, beside)()
        if role is not None:
            self._recall(role)
        elif self._selective:
            self._launcher.launch(self._kernels.roles, self.most, self, self._particles, rows)

    def _recall(self, role: np.ndarray) -> None:
        """Tell the tiles' roles from those of their particles."""
        starts = self.tile_start.numpy()[: int(self.n_tiles.numpy()[0])]
        first = role[self.member.numpy()[starts]]
        roles = np.zeros(self.most, dtype=np.int32)
        roles[: len(first)] = np.where(first < 0, -1 - first, first)
        self.tile_role.assign(roles)
