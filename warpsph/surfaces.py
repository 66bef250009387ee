"""Closed surface meshes: check them, and ask which points lie inside."""

import contextlib
import logging
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import mesh_files
from .messages import files

if TYPE_CHECKING:
    import pyvista

CUBES = tuple(2**k for k in range(4, 18))
"""Cubes along the longest side of a cloud of points, from the first division in cubes to the last."""

FEW = 4
"""Points to a cube, on average, below which they are asked one by one."""

HALF_DIAGONAL = 0.87
"""Farthest point of a cube from its centre, in sides, and a little more: sqrt(3)/2."""

FLAT = 1e-12
"""Share of its bounding box that a surface encloses at least."""


def closed_surface(source: "str | Path | pyvista.PolyData") -> "pyvista.PolyData":
    """Give the closed, outward-oriented triangle surface of a mesh file or a PyVista mesh.

    Raises:
        InputError: If the file cannot be read, holds no surface, or the surface is open.
    """
    is_file = isinstance(source, str | Path)
    name = str(source) if is_file else f"of type {type(source).__name__}"
    surface = _triangles(_read(Path(source)) if is_file else source, name)
    edges = np.sort(_edges(surface), axis=1)
    open_edges = np.count_nonzero(_times(edges) != 2)
    if open_edges:
        raise files.no_surface(name, f"is not closed: {open_edges} open or multiple edges")
    return _outward(surface, name)


def within(surface: "pyvista.PolyData", points: np.ndarray, tolerance: float) -> np.ndarray:
    """Tell which points [m], shape [n, 3], are inside of a closed surface or no further than ``tolerance`` [m] from it.

    A distance takes long to find, so points are gathered in cubes first: those of a cube that the surface does not reach,
    as its centre knows, are all inside or all outside. What is left goes into cubes of half the size, and so on.

    Returns:
        A mask, shape [n].
    """
    inside, left = np.zeros(len(points), dtype=bool), np.arange(len(points))
    if len(points) == 0:
        return inside
    low = points.min(axis=0)
    extent = float(np.ptp(points, axis=0).max()) or 1.0
    for cubes in CUBES:
        number, size = np.zeros(len(left), dtype=np.int64), extent / cubes
        for k in range(3):
            number = number * (cubes + 1) + ((points[left, k] - low[k]) / size).astype(np.int64)
        number, cube = np.unique(number, return_inverse=True)
        if len(number) * FEW > len(left):
            break
        index = np.stack(np.unravel_index(number, (cubes + 1,) * 3), axis=1)
        distance = _signed_distance(surface, low + (index + 0.5) * size)
        near = (np.abs(distance) <= HALF_DIAGONAL * size + tolerance)[cube]
        inside[left[~near]] = (distance < 0.0)[cube[~near]]
        left = left[near]
    inside[left] = _signed_distance(surface, points[left]) <= tolerance
    return inside


def _signed_distance(surface: "pyvista.PolyData", points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape [n, 3], from a closed surface, negative inside, shape [n]."""
    import pyvista

    if len(points) == 0:
        return np.empty(0)
    return np.asarray(pyvista.PolyData(points).compute_implicit_distance(surface)["implicit_distance"])


def _read(path: Path) -> "pyvista.PolyData":
    """Make a PyVista mesh of a file."""
    import pyvista

    polygons = mesh_files.read(path)
    starts = np.cumsum(polygons.sizes) - polygons.sizes
    return pyvista.PolyData(polygons.points, faces=np.insert(polygons.corners, starts, polygons.sizes))


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep back what VTK and PyVista say about a broken file: the one line of the error is enough."""
    import pyvista

    logging.disable()
    try:
        with pyvista.vtk_verbosity("off"), warnings.catch_warnings(action="ignore"):
            yield
    finally:
        logging.disable(logging.NOTSET)


def _triangles(mesh: object, name: str) -> "pyvista.PolyData":
    """Cut a mesh up into triangles that share their corners, as those of STL do not; degenerate ones are dropped."""
    import pyvista

    if not isinstance(mesh, pyvista.PolyData):
        raise files.no_surface(name, "is not a surface")
    if not np.isfinite(mesh.points).all():
        raise files.no_surface(name, "holds points that are not finite")
    with _silence():
        surface = mesh.triangulate()
    points, place = np.unique(surface.points, axis=0, return_inverse=True)
    corners = (
        place.reshape(-1)[surface.regular_faces] if surface.n_cells else np.empty((0, 3), dtype=np.int64)
    )
    a, b, c = corners.T
    corners = corners[(a != b) & (b != c) & (c != a)]
    if not len(corners):
        raise files.no_surface(name, "holds no triangles")
    return pyvista.PolyData.from_regular_faces(points, corners)


def _outward(surface: "pyvista.PolyData", name: str) -> "pyvista.PolyData":
    """Turn the triangles so that normals point outwards; a consistent winding (cavities too) is kept."""
    import pyvista

    if (_times(_edges(surface)) > 1).any():  # two neighbours run along their edge the same way
        with _silence():
            surface = surface.compute_normals(
                auto_orient_normals=True, consistent_normals=True, split_vertices=False
            )
        surface.clear_data()
    faces, points = surface.regular_faces, surface.points.astype(np.float64)
    volume = np.linalg.det((points - points.mean(axis=0))[faces]).sum() / 6.0
    if abs(volume) <= FLAT * np.prod(np.ptp(points, axis=0)):
        raise files.no_surface(name, "encloses no volume")
    return surface if volume > 0 else pyvista.PolyData.from_regular_faces(surface.points, faces[:, ::-1])


def _edges(surface: "pyvista.PolyData") -> np.ndarray:
    """From which point to which the edges of each triangle run, shape [3 * triangles, 2]."""
    faces = surface.regular_faces.astype(np.int64)
    return np.concatenate((faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]))


def _times(edges: np.ndarray) -> np.ndarray:
    """How often each different edge is there."""
    return np.unique(edges[:, 0] * (edges.max() + 1) + edges[:, 1], return_counts=True)[1]
