"""How many neighbours the particles of a scene have, from a sample of them: what their rows will take."""

import itertools

import numpy as np

from warpsph.scene import SceneData

SAMPLE = 400
"""Particles that are looked at; their mean is good to one or two per cent."""

GROUPS = 64
"""Groups of particles that are looked at where their rows stand side by side."""

SEED = 20130611
"""Seed of their choice."""

CHUNK = 1 << 20
"""Particles that are sifted, and pairs that are measured, at a time."""

BINS = 1 << 20
"""Cells that are told apart when particles are sifted."""

STRIDE = 1 << 21
"""Step in the number of a cell from one row of cells to the next. Where there are longer ones, numbers repeat."""


def sample(n: int) -> np.ndarray:
    """Indices of some of n particles, of all if they are few; the same in every run."""
    return np.arange(n) if n <= SAMPLE else np.random.default_rng(SEED).choice(n, SAMPLE, replace=False)


def groups(order: np.ndarray, columns: int) -> np.ndarray:
    """Some groups of particles whose rows stand side by side, or all, shape [g, columns]; the same in every run.

    Args:
        order: The particles in their order in memory.
        columns: Rows that stand side by side; the last group's last particle is told again for those that it lacks.
    """
    count = -(-len(order) // columns)
    chosen = np.arange(count)
    if count > GROUPS:
        chosen = np.random.default_rng(SEED).choice(count, GROUPS, replace=False)
    return order[np.minimum(chosen[:, None] * columns + np.arange(columns), len(order) - 1)]


def neighbours(data: SceneData, chosen: np.ndarray, radius: float, same_body: bool = False) -> np.ndarray:
    """Count the neighbours of some particles, mirror images included, the particle itself left out.

    Takes some thirty nanoseconds for each particle of the scene, and next to no memory: it sifts out those in the
    surroundings of the chosen ones.

    Args:
        data: The scene.
        chosen: Indices of the particles whose neighbours are counted, shape [k].
        radius: Distance up to which they count [m].
        same_body: Leave out the particles of other bodies.

    Returns:
        Their numbers, shape [k].
    """
    x = data.x[:, : data.dim]
    low, found = x.min(axis=0), np.full(len(chosen), -1)
    for mirrors in itertools.product((False, True), repeat=len(data.planes)):
        seekers = x[chosen]
        for (axis, position), mirrored in zip(data.planes, mirrors, strict=True):
            if mirrored:
                seekers[:, axis] = 2.0 * position - seekers[:, axis]
        rows = _number(seekers, low, radius)[:, None] + _steps(data.dim)
        near, number = _surroundings(x, low, radius, rows)
        first, last = np.searchsorted(number, rows - 1), np.searchsorted(number, rows + 1, "right")
        candidates = np.sum(last - first, axis=1)
        for some in np.array_split(np.arange(len(chosen)), 1 + int(candidates.sum()) // CHUNK):
            k, place = _pairs(first[some], last[some])
            k, j = some[k], near[place]
            close = np.sum((x[j] - seekers[k]) ** 2, axis=1) < radius**2
            if same_body:
                close &= data.body[j] == data.body[chosen[k]]
            found += np.bincount(k[close], minlength=len(chosen))
    return found


def _pairs(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each index k with every place of its ranges, ``first[k, :]`` up to ``last[k, :]``, both of shape [k, ranges]."""
    length = (last - first).ravel()
    start = np.repeat(first.ravel() - (np.cumsum(length) - length), length)
    return np.repeat(np.arange(length.size) // first.shape[1], length), start + np.arange(len(start))


def _number(x: np.ndarray, low: np.ndarray, width: float) -> np.ndarray:
    """Numbers of the cells of points, shape [n], int64; those of a row of cells along the last axis follow each other."""
    number = np.zeros(len(x), dtype=np.int64)
    for column, start in zip(x.T, low, strict=True):
        number = number * STRIDE + np.floor((column - start) / width).astype(np.int64)
    return number


def _steps(dim: int) -> np.ndarray:
    """From the number of a cell to those of the middle cells of the rows around it."""
    rows = itertools.product((-1, 0, 1), repeat=dim - 1)
    return np.array([sum(k * STRIDE ** (dim - 1 - axis) for axis, k in enumerate(row)) for row in rows])


def _surroundings(
    x: np.ndarray, low: np.ndarray, width: float, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Particles in the cells around given ones, and some others, by their cells: indices, and numbers in rising order."""
    wanted = np.zeros(BINS, dtype=bool)
    for step in (-1, 0, 1):
        wanted[(rows + step) % BINS] = True
    indices, numbers = [], []
    for start in range(0, len(x), CHUNK):
        number = _number(x[start : start + CHUNK], low, width)
        near = np.flatnonzero(wanted[number % BINS])
        indices.append(near + start)
        numbers.append(number[near])
    index, number = np.concatenate(indices), np.concatenate(numbers)
    order = np.argsort(number, kind="stable")
    return index[order], number[order]


def with_rows(data: SceneData, radius: float, width: float, most: int) -> np.ndarray:
    """Tell which particles have rows at the start of a run with Lagrangian ones, shape [n], bool: see `kernels.tiles`.

    Args:
        data: The scene.
        radius: Reach of the rows [m].
        width: Width of the tiles [m]; they grow as `warpsph.search.tiles.Tiles` lets them.
        most: Tiles at most.
    """
    x = data.x[:, : data.dim]
    while True:
        number = _number(x, np.zeros(data.dim), width)
        tile = np.unique(number, return_inverse=True)[1]
        if tile.max() < most:
            break
        width *= 1.5
    order = np.argsort(tile, kind="stable")
    start = np.flatnonzero(np.diff(tile[order], prepend=-1))
    low, high = np.minimum.reduceat(x[order], start), np.maximum.reduceat(x[order], start)
    for axis, position in data.planes:
        low[:, axis] = np.minimum(low[:, axis], position)
        high[:, axis] = np.maximum(high[:, axis], position)
    active = np.logical_or.reduceat(data.eulerian[order], start)
    first, last = np.minimum.reduceat(data.body[order], start), np.maximum.reduceat(data.body[order], start)
    found = active | (first != last)
    for t in np.flatnonzero(~found):
        gap = np.maximum(np.maximum(low - high[t], low[t] - high), 0.0)
        strange = active | (np.minimum(first, first[t]) != np.maximum(last, last[t]))
        found[t] = np.any(strange & (np.sum(gap**2, axis=1) < radius**2))
    return found[tile]
