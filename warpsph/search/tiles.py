"""Tiles of space over the particles, rebuilt with the neighbour rows: they tell when the rows are worn out."""

import functools
from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import warp as wp

from warpsph.device.launch import Launcher
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

    def prepare(
        self, rows: object, block: Block, role: np.ndarray | None, beside: Sequence[tuple[type, int]]
    ) -> Work:
        """Give the work of sorting the particles into tiles, which grow until there are no more than ``most``.

        Args:
            rows: What knows the symmetry planes (``plane``, ``plane_mask``), the rows' reach (``radius``), and
                takes the particles' ``role``.
            block: Work space.
            role: The particles' roles, shape [n], where they are known; found if None.
            beside: Other work space of the block that is in use meanwhile.
        """
        self._ready(rows, block, beside)
        return functools.partial(self._build, rows, block, role, beside)

    def _build(
        self, rows: object, block: Block, role: np.ndarray | None, beside: Sequence[tuple[type, int]]
    ) -> None:
        n, bits = self._particles.n, KEY_BITS * self._particles.spec.dim
        while True:
            bound = self._ready(rows, block, beside)
            bound.keys()
            wp.utils.radix_sort_pairs(bound.key, bound.member, n, end_bit=bits)
            bound.heads()
            wp.utils.array_scan(bound.head, bound.number, inclusive=True)
            bound.starts()
            if int(self.n_tiles.numpy()[0]) <= self.most:
                break
            self.width *= 1.5
        wp.copy(self.member, bound.member, count=n)
        bound.boxes()
        if self._selective:
            bound.contents()
            if role is None:
                bound.roles()
            else:
                self._recall(role)

    def _ready(self, rows: object, block: Block, beside: Sequence[tuple[type, int]]) -> SimpleNamespace:
        """Work space, and the launches that use it, with tiles as wide as they are now."""
        return block.bound(
            (self, self.width), lambda: self._bind(rows, block.views(*beside, *self.work)[-4:])
        )

    def _bind(self, rows: object, views: Sequence[wp.array]) -> SimpleNamespace:
        p, k, bind, n = self._particles, self._kernels, self._launcher.bind, self._particles.n
        key, member, head, number = views
        bound = SimpleNamespace(key=key, member=member, head=head, number=number)
        bound.keys = bind(k.keys, n, p, width=self.width, key=key, member=member)
        bound.heads = bind(k.heads, n, key=key, head=head)
        bound.starts = bind(k.starts, n, self, head=head, number=number, n=n)
        bound.boxes = bind(k.boxes, self.most, self, p, rows)
        if self._selective:
            bound.contents = bind(k.contents, self.most, self, p)
            bound.roles = bind(k.roles, self.most, self, p, rows)
        return bound

    def _recall(self, role: np.ndarray) -> None:
        """Tell the tiles' roles from those of their particles."""
        starts = self.tile_start.numpy()[: int(self.n_tiles.numpy()[0])]
        first = role[self.member.numpy()[starts]]
        roles = np.zeros(self.most, dtype=np.int32)
        roles[: len(first)] = np.where(first < 0, -1 - first, first)
        self.tile_role.assign(roles)
