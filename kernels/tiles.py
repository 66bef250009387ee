"""Tiles of space: how far may particles move before the neighbour rows miss a pair.

Two particles that are not in each other's rows were further apart than the rows' reach when the rows were
built, and further than the gap between the boxes of their tiles. They have come nearer by at most the extent of
both tiles' displacements. As long as that is less than what separates them from the kernel's support, for every two
tiles, the rows hold every pair. The test is rigorous and local: fast debris far from everything wears nothing.
"""

import functools
from typing import NamedTuple

import warp as wp

from .index import natural
from .kernel_type import ERODED, EULERIAN
from .lanes import make_lanes, make_reads
from .spec import Spec

KEY_BITS = 10
"""Bits of a coordinate in a tile's key."""


class TileKernels(NamedTuple):
    """Kernels of this file."""

    keys: wp.Kernel
    heads: wp.Kernel
    starts: wp.Kernel
    boxes: wp.Kernel
    contents: wp.Kernel
    roles: wp.Kernel
    motion: wp.Kernel
    extents: wp.Kernel
    wear: wp.Kernel


@functools.cache
def make_tiles(s: Spec, selective: bool = False) -> TileKernels:
    """Build the kernels for one specialisation; ``selective``: there are Lagrangian particles."""
    real, vec, place, point = s.real, s.vec, s.place, s.point
    module = s.module(__name__, "selective" * selective)
    over_lanes = s.module(__name__, "_".join(filter(None, ("motion", "selective" * selective))), lanes=True)
    read, lanes = make_reads(s), make_lanes(s)
    worth, raised, value, Bits = lanes.worth, lanes.raised, lanes.value, lanes.Bits
    rank, ranked = lanes.rank, lanes.ranked

    @wp.func
    def strangers(first: wp.int32, last: wp.int32, others_first: wp.int32, others_last: wp.int32):
        """Whether two tiles hold particles of different bodies, given the lowest and highest body of each."""
        return wp.min(first, others_first) != wp.max(last, others_last)

    @wp.func
    def between(low: point, high: point, others_low: point, others_high: point):
        """Gap between two boxes along each axis [m], 0 where they overlap."""
        return vec(wp.max(wp.max(others_low - high, low - others_high), point()))

    @wp.func
    def cell(c: place, width: place):
        return wp.int32(wp.floor(wp.clamp(c / width, place(-1.0e9), place(1.0e9))))

    @wp.kernel(module=module)
    def keys(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        width: place,
        # out:
        key: wp.array[wp.int32],
        member: wp.array[wp.int32],
    ):
        """Key of a particle's tile: `KEY_BITS` of each coordinate; tiles 2^`KEY_BITS` apart share one and count as one."""
        i = wp.tid() + offset
        low = wp.int32(wp.static(2**KEY_BITS - 1))
        key[i] = (
            (cell(x[i][0], width) & low)
            | ((cell(x[i][1], width) & low) << KEY_BITS)
            | ((cell(x[i][2], width) & low) << wp.static(2 * KEY_BITS))
        )
        member[i] = i

    @wp.kernel(module=module)
    def heads(
        offset: wp.int32,
        # in:
        key: wp.array[wp.int32],
        # out:
        head: wp.array[wp.int32],
    ):
        """1 where a new tile begins in the sorted keys."""
        k = wp.tid() + offset
        head[k] = 1
        if k > 0:
            if key[k] == key[k - 1]:
                head[k] = 0

    @wp.kernel(module=module)
    def starts(
        offset: wp.int32,
        # in:
        head: wp.array[wp.int32],
        number: wp.array[wp.int32],
        n: wp.int32,
        most: wp.int32,
        # out:
        tile_start: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
    ):
        """First place of every tile in the list of members; ``number`` is the inclusive sum of ``head``.

        ``tile_start`` has room for ``most`` tiles: of more only their number is told.
        """
        k = wp.tid() + offset
        if head[k] == 1 and number[k] <= most:
            tile_start[number[k] - 1] = k
        if k == n - 1:
            tile_start[wp.min(number[k], most)] = n
            n_tiles[0] = number[k]

    @wp.kernel(module=module)
    def boxes(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        tile_start: wp.array[wp.int32],
        member: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
        plane: point,
        plane_mask: wp.int32,
        # out:
        box_low: wp.array[point],
        box_high: wp.array[point],
    ):
        """Bounding box of a tile's particles [m], stretched to a symmetry plane where there is one: it holds the images' too."""
        t = wp.tid() + offset
        if t >= n_tiles[0]:
            return
        first = member[tile_start[t]]
        low, high = point(x[first]), point(x[first])
        for k in range(tile_start[t], tile_start[t + 1]):
            low, high = wp.min(low, x[member[k]]), wp.max(high, x[member[k]])
        for c in range(3):
            if (plane_mask >> c) & 1 == 1:
                low[c] = wp.min(low[c], plane[c])
                high[c] = wp.max(high[c], plane[c])
        box_low[t] = low
        box_high[t] = high

    @wp.kernel(module=module)
    def contents(
        offset: wp.int32,
        # in:
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        ripe: wp.array[wp.int32],
        tile_start: wp.array[wp.int32],
        member: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
        # out:
        active: wp.array[wp.int32],
        body_first: wp.array[wp.int32],
        body_last: wp.array[wp.int32],
    ):
        """active = 1: the tile has an Eulerian particle, or one about to convert; its lowest and highest body."""
        t = wp.tid() + offset
        if t >= n_tiles[0]:
            return
        found, first, last = wp.int32(0), wp.int32(1 << 30), wp.int32(-1)
        for k in range(tile_start[t], tile_start[t + 1]):
            i = member[k]
            if kernel_type[i] == EULERIAN or ripe[i] == 1:
                found = 1
            first, last = wp.min(first, body[i]), wp.max(last, body[i])
        active[t] = found
        body_first[t] = first
        body_last[t] = last

    @wp.kernel(module=module)
    def roles(
        offset: wp.int32,
        # in:
        kernel_type: wp.array[wp.int32],
        box_low: wp.array[point],
        box_high: wp.array[point],
        active: wp.array[wp.int32],
        body_first: wp.array[wp.int32],
        body_last: wp.array[wp.int32],
        tile_start: wp.array[wp.int32],
        member: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
        radius: real,
        # out:
        tile_role: wp.array[wp.int32],
        role: wp.array[wp.int32],
    ):
        """Role of a tile's particles: 2 in an active tile, 1 within the rows' reach of one or of another body, else 0.

        An eroded particle has -1 minus that: it is in no row, and what its tile's role was can still be told.
        """
        t = wp.tid() + offset
        if t >= n_tiles[0]:
            return
        found = 2 * active[t]
        if found == 0 and body_first[t] != body_last[t]:
            found = 1
        for u in range(n_tiles[0]):
            if found == 0:
                if active[u] == 1 or strangers(body_first[t], body_last[t], body_first[u], body_last[u]):
                    gap = between(box_low[t], box_high[t], box_low[u], box_high[u])
                    if wp.dot(gap, gap) < radius * radius:
                        found = 1
        tile_role[t] = found
        for k in range(tile_start[t], tile_start[t + 1]):
            i = member[k]
            role[i] = wp.where(kernel_type[i] == ERODED, -1 - found, found)

    @wp.kernel(module=over_lanes)
    def motion(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        x_listed: wp.array[point],
        tile_start: wp.array[wp.int32],
        member: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
        plane_mask: wp.int32,
        hands: wp.int32,
        # out:
        moved_low: wp.array[vec],
        moved_high: wp.array[vec],
    ):
        """Bounding box of the displacements of a tile's particles since the rows were built [m], ``hands`` to a tile."""
        hand = wp.tid() + offset
        t = hand // hands
        if t >= n_tiles[0]:
            return
        # scalars, not vectors: the compiler keeps them in registers
        low_x, low_y, low_z = rank(real(1.0e30)), rank(real(1.0e30)), rank(real(1.0e30))
        high_x, high_y, high_z = rank(real(-1.0e30)), rank(real(-1.0e30)), rank(real(-1.0e30))
        first = tile_start[t] + hand % hands
        # counted one by one, which the compiler unrolls: a GPU then waits for several particles at once
        count = (tile_start[t + 1] - first + hands - 1) / hands
        k = wp.int32(0)
        while k < count:
            i = natural(read.integer(member, first + k * hands))
            moved = vec(read.point(x, i) - read.point(x_listed, i))
            low_x, high_x = wp.min(low_x, rank(moved[0])), wp.max(high_x, rank(moved[0]))
            low_y, high_y = wp.min(low_y, rank(moved[1])), wp.max(high_y, rank(moved[1]))
            low_z, high_z = wp.min(low_z, rank(moved[2])), wp.max(high_z, rank(moved[2]))
            k += 1
        low = vec(ranked(low_x), ranked(low_y), ranked(low_z))
        high = vec(ranked(high_x), ranked(high_y), ranked(high_z))
        for c in range(3):
            if (plane_mask >> c) & 1 == 1:  # an image moves the other way
                widest = wp.max(-low[c], high[c])
                low[c] = -widest
                high[c] = widest
        moved_low[hand] = low
        moved_high[hand] = high

    @wp.kernel(module=module)
    def extents(
        offset: wp.int32,
        # in:
        hand_low: wp.array[vec],
        hand_high: wp.array[vec],
        n_tiles: wp.array[wp.int32],
        hands: wp.int32,
        # out:
        moved_low: wp.array[vec],
        moved_high: wp.array[vec],
    ):
        """Bounding box of a tile's displacements from those of its hands [m]."""
        t = wp.tid() + offset
        if t >= n_tiles[0]:
            return
        low, high = vec(hand_low[t * hands]), vec(hand_high[t * hands])
        for k in range(t * hands + 1, (t + 1) * hands):
            low, high = wp.min(low, hand_low[k]), wp.max(high, hand_high[k])
        moved_low[t] = low
        moved_high[t] = high

    @wp.kernel(module=over_lanes)
    def wear(
        offset: wp.int32,
        # in:
        box_low: wp.array[point],
        box_high: wp.array[point],
        moved_low: wp.array[vec],
        moved_high: wp.array[vec],
        tile_role: wp.array[wp.int32],
        body_first: wp.array[wp.int32],
        body_last: wp.array[wp.int32],
        n_tiles: wp.array[wp.int32],
        support: real,
        radius: real,
        wearing_role: wp.int32,
        hands: wp.int32,
        # out:
        tile_wear: wp.array[real],
    ):
        """Largest share of the allowed approach that a tile has used up against any tile [-]; 1 wears the rows out.

        Each of the tile's ``hands`` has a value of its own, against every so many tiles. With Lagrangian particles two
        tiles of one body count from ``wearing_role`` of one of them on.
        """
        hand = wp.tid() + offset
        t = hand // hands
        if t >= n_tiles[0]:
            tile_wear[hand] = real(0.0)
            return
        low, high = read.vec(moved_low, t), read.vec(moved_high, t)
        at, to = read.point(box_low, t), read.point(box_high, t)
        skin2 = (radius - support) * (radius - support)
        worst = Bits(0)
        u = wp.int32(hand % hands)
        last = wp.int32(n_tiles[0])
        while u < last:
            counts = bool(True)
            if wp.static(selective):
                counts = wp.max(tile_role[t], read.integer(tile_role, u)) >= wearing_role or strangers(
                    body_first[t], body_last[t], read.integer(body_first, u), read.integer(body_last, u)
                )
            nearer = wp.max(high - read.vec(moved_low, u), read.vec(moved_high, u) - low)
            n2 = wp.where(counts, wp.dot(nearer, nearer), real(0.0))
            if worth(n2 > value(worst) * skin2):  # otherwise no gap can make it the worst
                gap = between(at, to, read.point(box_low, u), read.point(box_high, u))
                apart = wp.max(radius, wp.length(gap)) - support
                worst = raised(worst, n2 / (apart * apart))
            u += hands
        tile_wear[hand] = wp.sqrt(value(worst))

    return TileKernels(keys, heads, starts, boxes, contents, roles, motion, extents, wear)
