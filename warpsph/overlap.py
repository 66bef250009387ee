"""Distances between the particles of a scene: which are too close, and how far apart neighbours are."""

import itertools

import numpy as np

_HASH = np.array((0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9), dtype=np.uint64)
"""Odd factors that turn cell indices into one key: linear, so that a neighbouring cell is a fixed step away."""

_SAMPLE = 1000
"""Particles whose nearest neighbour is looked up; a mean over so many is good to a few per cent."""


def close_pairs(x: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Find all pairs of points closer than a distance.

    Points are sorted by cells of that size, and each is compared with those of its own cell and of half of the
    neighbouring ones.

    Args:
        x: Points [m], shape [n, dim].
        distance: Distance [m].

    Returns:
        The indices of the two points of every pair, each of shape [pairs], the lower one first, in rising order.
    """
    dim = x.shape[1]
    cell = np.floor((x - x.min(axis=0)) / distance).astype(np.int64).astype(np.uint64)
    key = (cell * _HASH[:dim]).sum(axis=1, dtype=np.uint64)
    order = np.argsort(key, kind="stable")
    key, x = key[order], x[order]
    found = []
    for offset in itertools.product((-1, 0, 1), repeat=dim):
        if offset < (0,) * dim:
            continue  # the mirrored offset finds these pairs
        target = key + (np.array(offset).astype(np.uint64) * _HASH[:dim]).sum(dtype=np.uint64)
        first = np.searchsorted(key, target, "left") if any(offset) else np.arange(len(key)) + 1
        i, j = _expand(first, np.searchsorted(key, target, "right"))
        near = np.linalg.norm(x[i] - x[j], axis=1) < distance
        found.append(order[np.stack((i[near], j[near]))])
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


def _expand(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """List every (i, j) with first[i] <= j < last[i]."""
    count = np.maximum(last - first, 0)
    i = np.repeat(np.arange(len(first)), count)
    return i, np.arange(len(i)) - np.repeat(np.cumsum(count) - count, count) + first[i]
