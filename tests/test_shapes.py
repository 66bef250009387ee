"""Shapes: what they contain, their bounds, how they move and combine, and meshes."""

import numpy as np
import pytest
import pyvista

from warpsph.errors import InputError
from warpsph.shapes import Box, Cone, Cylinder, Disc, HalfSpace, Mesh, Ring, Sphere
from warpsph.surfaces import within

RNG = np.random.default_rng(7)
CLOUD = {
    1: np.pad(RNG.uniform(-2, 2, (2000, 1)), ((0, 0), (0, 2))),
    2: np.pad(RNG.uniform(-2, 2, (4000, 2)), ((0, 0), (0, 1))),
    3: RNG.uniform(-2, 2, (20000, 3)),
}

SHAPES = [
    (Box(-0.5, 1.0), 1.5),
    (Box((-0.5, 0.0), (1.0, 1.0)), 1.5),
    (Box((-0.5, 0.0, -1.0), (1.0, 1.0, 0.5)), 2.25),
    (Disc(1.2, (0.3, -0.2)), np.pi * 1.44),
    (Ring(0.5, 1.2, (0.3, -0.2)), np.pi * (1.44 - 0.25)),
    (Sphere(1.2, (0.1, 0.2, 0.3)), 4 / 3 * np.pi * 1.728),
    (Cylinder((-0.5, -0.5, 0.0), (0.5, 0.6, 0.7), 0.6), np.pi * 0.36 * np.sqrt(2.7)),
    (Cone((-0.5, -0.5, 0.0), (0.5, 0.6, 0.7), 0.8), np.pi * 0.64 * np.sqrt(2.7) / 3),
    (Cone((0, 0, -1), (0, 0, 1), 1.0, 0.5), np.pi * 2 / 3 * (1 + 0.5 + 0.25)),
    (Disc(1.2) - Disc(0.5), np.pi * (1.44 - 0.25)),
    (Box((0, 0), (1, 1)) | Box((0.5, 0), (2, 1)), 2.0),
    (Sphere(1.0) & HalfSpace((0, 0, 0), (1, 1, 0)), 2 / 3 * np.pi),
    (Mesh(pyvista.Box((-1, 1, -1, 0.5, 0, 1))), 3.0),
]


@pytest.mark.parametrize("shape, volume", SHAPES, ids=str)
def test_volume_and_bounds_agree_with_a_random_cloud(shape, volume):
    points = CLOUD[shape.dim]
    inside = shape.contains(points)
    assert 4.0**shape.dim * inside.mean() == pytest.approx(volume, rel=0.12)
    low, high = shape.bounds()
    assert low.shape == high.shape == (3,)
    assert (points[inside] >= low).all() and (points[inside] <= high).all()


@pytest.mark.parametrize("shape", [s for s, _ in SHAPES if s.dim > 1], ids=str)
def test_motions_move_the_points_along(shape):
    """A moved shape contains a moved point exactly where the shape contains the point."""
    points = CLOUD[shape.dim]
    shift = (0.3, -0.7, 0.2)[: shape.dim]
    axis = "z" if shape.dim == 2 else (1.0, 2.0, -1.0)
    moved = shape.scale(1.7).rotate(axis, 33.0).translate(shift)
    image = 1.7 * points @ _matrix(axis, 33.0).T + np.pad(shift, (0, 3 - shape.dim))
    decided = shape.contains(points, 1e-6) == shape.contains(points, -1e-6)
    assert decided.mean() > 0.99
    np.testing.assert_array_equal(moved.contains(image)[decided], shape.contains(points)[decided])
    low, high = moved.bounds()
    assert (image[shape.contains(points)] >= low - 1e-6).all() and (
        image[shape.contains(points)] <= high + 1e-6
    ).all()


def _matrix(axis, degrees):
    """An independent rotation matrix: VTK's."""
    import vtkmodules.vtkCommonTransforms as transforms

    transform = transforms.vtkTransform()
    transform.RotateWXYZ(degrees, *((0, 0, 1) if axis == "z" else axis))
    return np.array([[transform.GetMatrix().GetElement(i, j) for j in range(3)] for i in range(3)])


def test_a_turned_box_keeps_tight_bounds():
    box = Box((0, 0), (2, 1)).rotate("z", 90.0)
    np.testing.assert_allclose(box.bounds(), [(-1, 0, 0), (0, 2, 0)], atol=1e-12)
    back = box.rotate("z", -90.0)
    np.testing.assert_allclose(back.bounds(), [(0, 0, 0), (2, 1, 0)], atol=1e-12)


def test_rotation_about_a_point_keeps_that_point():
    disc = Disc(1.0, (2.0, 3.0)).rotate("z", 180.0, center=(2.0, 2.0))
    np.testing.assert_allclose(disc.center, (2.0, 1.0), atol=1e-12)


def test_cylinder_bounds_are_exact():
    np.testing.assert_allclose(Cylinder((0, 0, 0), (2, 0, 0), 1.0).bounds(), [(0, -1, -1), (2, 1, 1)])


def test_the_surface_belongs_to_a_shape_and_to_one_side_of_a_cut():
    disc, cut = Disc(1.0), HalfSpace((0.5, 0), (1, 0))
    on = np.array([[0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert disc.contains(on).all()
    assert (disc & cut).contains(on).tolist() == [True, True]
    assert (disc - cut).contains(on).tolist() == [False, False]
    assert disc.contains(np.array([[1.0 + 1e-9, 0.0, 0.0]]), 1e-8).all()


def test_a_cut_along_an_axis_tightens_the_bounds():
    low, high = (Disc(1.0) & HalfSpace((0.25, 0), (1, 0))).bounds()
    assert (low[0], high[0]) == (0.25, 1.0)
    low, high = (Disc(1.0) - HalfSpace((0.25, 0), (2, 0))).bounds()
    assert (low[0], high[0]) == (-1.0, 0.25)


def test_shapes_are_immutable_and_show_what_they_are():
    disc = Disc(1.0)
    with pytest.raises(AttributeError):
        disc.radius = 2.0
    assert repr(disc) == "Disc(radius=1.0, center=(0.0, 0.0))"
    assert repr(Box([0, 0], np.ones(2))) == "Box(low=(0.0, 0.0), high=(1.0, 1.0))"


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_a_mesh_file_fills_like_the_shape_it_draws(tmp_path, suffix):
    path = tmp_path / f"ball.{suffix}"
    pyvista.Sphere(radius=6.0, theta_resolution=60, phi_resolution=60).save(path)
    mesh, sphere = Mesh(path).scale(1e-3), Sphere(6e-3)
    points = 6e-3 * RNG.uniform(-1.2, 1.2, (5000, 3))
    clear = abs(np.linalg.norm(points, axis=1) - 6e-3) > 5e-5  # facets lie a little inside the sphere
    np.testing.assert_array_equal(mesh.contains(points)[clear], sphere.contains(points)[clear])


def test_a_mesh_does_not_depend_on_the_winding_of_its_triangles():
    cube = pyvista.Cube().triangulate().clean()
    faces = cube.regular_faces
    mixed = faces.copy()
    mixed[::3] = mixed[::3, ::-1]
    points = CLOUD[3] * 0.5
    expected = (np.abs(points) <= 0.5).all(axis=1)
    for winding in (faces, faces[:, ::-1], mixed):
        mesh = Mesh(pyvista.PolyData.from_regular_faces(cube.points, winding))
        np.testing.assert_array_equal(mesh.contains(points), expected)


def test_a_mesh_with_a_cavity_is_hollow():
    outer, inner = pyvista.Sphere(radius=1.0), pyvista.Sphere(radius=0.5)
    inner = pyvista.PolyData.from_regular_faces(inner.points, inner.regular_faces[:, ::-1])
    shell = Mesh(outer.append_polydata(inner))
    assert shell.contains(np.array([[0.0, 0, 0], [0.75, 0, 0], [1.5, 0, 0]])).tolist() == [False, True, False]


@pytest.mark.parametrize("mesh", [pyvista.ParametricTorus(), pyvista.Cone(resolution=12), pyvista.Cube()])
@pytest.mark.parametrize("tolerance", [0.0, 0.1])
def test_cubes_of_points_are_inside_a_mesh_where_each_point_is(mesh, tolerance):
    surface = Mesh(mesh).source
    grid = np.stack(np.meshgrid(*[np.linspace(-1.4, 1.4, 41)] * 3, indexing="ij"), -1).reshape(-1, 3)
    for points in (grid, CLOUD[3], np.append(grid, [[1e5, 0, 0]], axis=0), np.zeros((5, 3)), grid[:0]):
        each = (
            pyvista.PolyData(points).compute_implicit_distance(surface)["implicit_distance"] <= tolerance
            if len(points)
            else []
        )
        assert np.array_equal(within(surface, points, tolerance), each)


def test_points_on_the_faces_of_a_mesh_belong_to_it():
    grid = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 6)] * 3), -1).reshape(-1, 3)
    assert Mesh(pyvista.Cube()).contains(grid, 1e-9).all()


def test_bad_meshes_are_refused_in_one_line(tmp_path, capfd, caplog, recwarn):
    broken, empty, text = tmp_path / "broken.stl", tmp_path / "empty.ply", tmp_path / "notes.txt"
    broken.write_bytes(b"solid nothing at all\n\x00\x01\x02")
    empty.write_text("")
    text.write_text("hello")
    open_box = pyvista.Cube().triangulate().clean().remove_cells([0, 1])
    cases = [
        (tmp_path / "none.stl", "does not exist"),
        (broken, "broken.stl"),
        (empty, "empty.ply"),
        (text, "cannot be read"),
        (open_box, "is not closed"),
        (pyvista.Plane(), "is not closed"),
        (42, "is not a surface"),
        (pyvista.ImageData(dimensions=(3, 3, 3)), "is not a surface"),
    ]
    for source, message in cases:
        with pytest.raises(InputError) as error:
            Mesh(source)
        assert message in str(error.value)
        assert "allowed: " in str(error.value) and "\n" not in str(error.value)
    assert capfd.readouterr().err == "" and not caplog.records and not list(recwarn)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: Disc(-1.0), "radius of Disc = -1.0 is not allowed; allowed: a positive number"),
        (lambda: Disc("1"), "radius of Disc = '1'"),
        (
            lambda: Disc(1.0, (0, 0, 0)),
            "center of Disc = (0, 0, 0) is not allowed; allowed: 2 finite numbers",
        ),
        (lambda: Sphere(np.nan), "radius of Sphere = nan"),
        (lambda: Ring(2.0, 1.0), "outer of Ring = 1.0 is not allowed; allowed: above inner = 2.0"),
        (lambda: Box((0, 0), (1, 0)), "high of Box = (1, 0) is not allowed; allowed: above low"),
        (lambda: Box((0, 0), (1, 1, 1)), "allowed: 2 finite numbers"),
        (lambda: Cylinder((0, 0, 0), (0, 0, 0), 1.0), "end of Cylinder"),
        (lambda: Cone((0, 0, 0), (0, 0, 1), 1.0, -0.1), "end_radius of Cone = -0.1"),
        (lambda: HalfSpace((0, 0), (0, 0)), "towards of HalfSpace"),
        (lambda: Disc(1.0) | Sphere(1.0), "allowed: shapes of the same dimension"),
        (
            lambda: Disc(1.0).rotate("x", 10.0),
            "axis of rotation = 'x' is not allowed; allowed: \"z\" for a 2D shape",
        ),
        (lambda: Sphere(1.0).rotate((0, 0, 0), 10.0), "axis of rotation"),
        (lambda: Disc(1.0).scale(0.0), "scale factor = 0.0"),
        (lambda: Disc(1.0).translate((1, 2, 3)), "translation"),
    ],
)
def test_bad_input_is_one_clear_line(call, message):
    with pytest.raises(InputError) as error:
        call()
    assert message in str(error.value)
    assert "allowed: " in str(error.value) and "\n" not in str(error.value)
