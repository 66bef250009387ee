"""Distances between the particles of a scene: which are too close, and how far apart neighbours are."""

import itertools
from collections.abc import Iterator

import numpy as np

_ONE = np.uint64(1)

_MANY = 1 << 20
"""Pairs that are compared at a time."""

_ENOUGH = 4
"""Close pairs for each point after which no more are looked for: where all are at one place, nothing would hold them."""

_SAMPLE = 1000
"""Particles whose nearest neighbour is looked up; a mean over so many is good to a few per cent."""


def close_pairs(x: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Find all pairs of points closer than a distance.

    Points are sorted by cells of that size, row after row of cells along the last axis. Each is compared with those
    after it in its own row, and with those of three cells in half of the neighbouring rows.

    Args:
        x: Points [m], shape [n, dim].
        distance: Distance [m].

    Returns:
        The indices of the two points of every pair, each of shape [pairs], the lower one first, in rising order. Where
        there are a million, and more than a few for each point, only these.
    """
    key, steps = _cells(x, distance)
    order = np.argsort(key, kind="stable")  # a lattice is sorted as it comes, which is soon seen
    key = key[order]
    found, pairs = [np.empty((2, 0), dtype=np.intp)], 0
    for i, j in _candidates(key, steps):
        found.append(_near(x, distance, order, i, j))
        pairs += found[-1].shape[1]
        if pairs > max(_ENOUGH * len(x), _MANY):
            break
    first, second = np.sort(np.concatenate(found, axis=1), axis=0)
    order = np.lexsort((second, first))
    return first[order], second[order]


def mean_spacing(x: np.ndarray) -> float:
    """Mean distance from a point to its nearest neighbour [m], from an even sample of points, shape [n, 3], n > 1."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkIdList
    from vtkmodules.vtkCommonDataModel import vtkStaticPointLocator

    locator, nearest = vtkStaticPointLocator(), vtkIdList()
    cloud = pyvista.PolyData(x)
    locator.SetDataSet(cloud)
    locator.BuildLocator()
    total, sample = 0.0, np.unique(np.linspace(0, len(x) - 1, _SAMPLE).astype(int))
    for i in sample:
        locator.FindClosestNPoints(2, x[i], nearest)
        total += max(np.linalg.norm(x[nearest.GetId(k)] - x[i]) for k in (0, 1))
    return total / len(sample)


def _cells(x: np.ndarray, distance: float) -> tuple[np.ndarray, list[np.uint64]]:
    """Number the cells of points, and give the steps from a cell to one in half of the neighbouring rows.

    The cells of a row have numbers on end, and an empty one before and behind. Numbers are modulo 2^64: where there are
    more cells than that, far rows share theirs, but no row is torn, as its length is a power of two.

    Returns:
        The number of every point's cell, shape [n], uint64, and the steps.
    """
    key, stride, strides = np.ones(len(x), dtype=np.uint64), 1, []
    for column in x.T[::-1]:
        low = column.min()
        key += np.floor((column - low) / distance).astype(np.uint64) * np.uint64(stride % 2**64)
        strides.insert(0, stride)
        cells = int((column.max() - low) / distance) + 3
        stride *= cells if stride > 1 else 1 << cells.bit_length()
    rows = itertools.product((-1, 0, 1), repeat=x.shape[1] - 1)
    ahead = (row for row in rows if row > (0,) * len(row))  # the mirrored row finds the same pairs
    return key, [np.uint64(sum(a * b for a, b in zip(row, strides, strict=False)) % 2**64) for row in ahead]


def _candidates(key: np.ndarray, steps: list[np.uint64]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Give the places of points in the same cells and in neighbouring ones, of rising keys."""
    yield from _up_to(key, np.arange(1, len(key) + 1), key + _ONE)
    for step in steps:
        target = key + step
        yield from _up_to(key, np.searchsorted(key, target - _ONE), target + _ONE)


def _up_to(key: np.ndarray, first: np.ndarray, last: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Give every (i, j) with j from ``first[i]`` on and ``key[j]`` up to ``last[i]``, of rising keys, some at a time."""
    i = np.flatnonzero((first < len(key)) & (key.take(first, mode="clip") <= last))  # most find none
    count = np.searchsorted(key, last[i], "right") - first[i]
    ends = np.cumsum(count)
    cuts = np.searchsorted(ends, np.arange(_MANY, int(count.sum()), _MANY))
    for some in np.split(np.arange(len(i)), np.unique(cuts)):
        length = count[some]
        start = np.repeat(first[i[some]] - (np.cumsum(length) - length), length)
        yield np.repeat(i[some], length), start + np.arange(len(start))


def _near(x: np.ndarray, distance: float, order: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Keep the pairs of places closer than a distance, as the indices of their points, shape [2, pairs]."""
    i, j = order[i], order[j]
    squared = sum((column[i] - column[j]) ** 2 for column in x.T)
    near = np.sqrt(squared) < distance
    return np.stack((i[near], j[near]))
