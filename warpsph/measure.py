"""Tools for measures: which particles belong together, how far they reach, and where there is a gap."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from .state import State

Result = TypeVar("Result")


def groups(x: np.ndarray, distance: float) -> np.ndarray:
    """Sort points into groups: any two closer than a distance are in the same one, and so are theirs.

    Args:
        x: Points [m], shape [n, 3].
        distance: Distance [m].

    Returns:
        Number of each point's group, shape [n], int: 0 for the largest, 1 for the next, and so on; of groups of one
        size, that of the lower index comes first. Points that are not finite are in none: -1.
    """
    found = np.full(len(x), -1)
    finite = np.flatnonzero(np.isfinite(x).all(axis=1))
    if len(finite) == 0:
        return found
    label = _clusters(x[finite], distance)
    _, first, inverse, size = np.unique(label, return_index=True, return_inverse=True, return_counts=True)
    rank = np.empty(len(size), dtype=int)
    rank[np.lexsort((first, -size))] = np.arange(len(size))
    found[finite] = rank[inverse]
    return found


def extent(values: np.ndarray) -> float:
    """Give the difference between the largest and the smallest value, shape [n]; nan if there are none."""
    return float(np.ptp(values)) if len(values) else np.nan


def widest_gap(values: np.ndarray, closed: float, apart: np.ndarray | None = None) -> float:
    """Give the widest gap between neighbouring values.

    Args:
        values: Coordinates [m], shape [n].
        closed: A gap up to this one [m] is none.
        apart: Number of the set each value belongs to, shape [n]; only values of one set are neighbours.

    Returns:
        The gap [m]; 0.0 if there is none.
    """
    sets = np.zeros(len(values)) if apart is None else apart
    order = np.lexsort((values, sets))
    gaps = np.diff(values[order])[np.diff(sets[order]) == 0]
    widest = float(gaps.max(initial=0.0))
    return widest if widest > closed else 0.0


def once(function: Callable[[State], Result]) -> Callable[[State], Result]:
    """Remember a result until the next state comes, so that several measures can share it."""
    last: tuple = (None, None)

    def remembered(state: State) -> Result:
        nonlocal last
        if last[0] is not state:
            last = state, function(state)
        return last[1]

    return remembered


def _clusters(x: np.ndarray, distance: float) -> np.ndarray:
    """Any number for each group of finite points, shape [n]."""
    import pyvista
    from vtkmodules.vtkFiltersPoints import vtkEuclideanClusterExtraction

    cloud = pyvista.PolyData(np.ascontiguousarray(x))
    cloud.point_data["index"] = np.arange(len(x))
    clusters = vtkEuclideanClusterExtraction()
    clusters.SetInputData(cloud)
    clusters.SetRadius(distance)
    clusters.SetExtractionModeToAllClusters()
    clusters.ColorClustersOn()
    clusters.Update()
    result = pyvista.wrap(clusters.GetOutput()).point_data  # in the order of the search
    label = np.empty(len(x), dtype=int)
    label[result["index"]] = result["ClusterId"]
    return label
