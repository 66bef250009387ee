"""The scene builder: what a finished scene holds, and what it refuses."""

import cProfile
import pstats
import time
import tracemalloc

import numpy as np
import pytest

from warpsph import materials, overlap
from warpsph.config import Numerics
from warpsph.errors import InputError
from warpsph.lattices import Cartesian, CoreAndRings
from warpsph.overlap import close_pairs
from warpsph.scene import Scene, spin
from warpsph.shapes import Box, Cone, Cylinder, Disc, HalfSpace, Mesh, Sphere

METAL = materials.Material("metal", 2785.0, materials.LinearElastic(K=79e9), materials.Elastic(G=27.6e9))
HEAVY = materials.Material("heavy", 7900.0, materials.LinearElastic(K=160e9), materials.Elastic(G=80e9))


def scene(dim=2, spacing=0.1, **options):
    return Scene("test", **{"dim": dim, "spacing": spacing, "until": 1.0, **options})


def square(x=0.0, y=0.0, size=1.0):
    return Box((x, y), (x + size, y + size))


def test_finalize_gives_the_particles_body_after_body():
    s = scene(numerics=Numerics(smoothing_ratio=1.4))
    s.add_body("ball", Disc(0.5, (-0.7, 0.5)), HEAVY, velocity=(3100, 0), internal_energy=7.0)
    s.add_body("plate", square(), METAL, density=2000.0)
    s.add_body("back", square(x=1.0), METAL)
    s.add_measure("front", lambda state: state.x[:, 0].max(), "m")
    data = s.finalize()
    n = len(data.x)
    assert n == len(s) == data.body.size and (data.x.shape, data.v.shape) == ((n, 3), (n, 3))
    assert data.h == pytest.approx(0.14)
    assert data.bodies == ["ball", "plate", "back"]
    assert data.materials == [HEAVY, METAL]
    ball, plate, back = (data.body == k for k in range(3))
    assert (plate.sum(), back.sum()) == (100, 100)
    np.testing.assert_array_equal(data.mat, np.where(ball, 0, 1))
    np.testing.assert_array_equal(data.rho, np.select([ball, plate, back], [7900.0, 2000.0, 2785.0]))
    np.testing.assert_allclose(data.m, data.rho * 0.01)
    np.testing.assert_array_equal(data.v, np.where(ball[:, None], (3100.0, 0.0, 0.0), 0.0))
    np.testing.assert_array_equal(data.e, np.where(ball, 7.0, 0.0))
    assert (data.body.dtype, data.mat.dtype, data.fixed.dtype) == (np.int32,) * 3
    assert {a.dtype for a in (data.x, data.v, data.m, data.rho, data.e)} == {np.dtype(np.float64)}
    assert not data.fixed.any()
    assert data.measures["front"].unit == "m"
    assert (
        repr(s)
        == f"Scene('test', 2D, spacing 0.1 m, {n} particles: ball ({n - 200}), plate (100), back (100))"
    )


def test_the_papers_impact_is_a_few_lines():
    s = Scene("hvi_2d", dim=2, spacing=1e-4, until=8e-6, numerics=Numerics(smoothing_ratio=1.4))
    ball = Disc(5e-3, (-5.2e-3, 0))
    s.add_body("projectile", ball, METAL, lattice=CoreAndRings(), velocity=(3100, 0))
    s.add_body("plate", Box((0, -25.05e-3), (2e-3, 25.05e-3)), METAL)
    data = s.finalize()
    assert np.bincount(data.body).tolist() == [7830, 10020]
    assert data.m.sum() == pytest.approx(17850 * 2785.0 * 1e-8)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_every_dimension(dim):
    s = scene(dim)
    body = s.add_body(
        "bar", Box((0.0,) * dim, (1.0,) * dim), METAL, velocity=(5.0,) * dim, lattice="cartesian"
    )
    data = s.finalize()
    assert len(data.x) == len(body) == 10**dim
    assert data.m.sum() == pytest.approx(2785.0) == body.mass
    assert (data.x[:, dim:] == 0).all() and (data.v[:, dim:] == 0).all() and (data.v[:, :dim] == 5.0).all()


def test_lattices_bring_their_cells():
    s = scene(3)
    body = s.add_body("ball", Sphere(1.0), METAL, lattice="face-centred-cubic")
    assert body.mass == pytest.approx(2785.0 * 4 / 3 * np.pi, rel=0.05)


def test_velocity_can_be_a_function_of_position():
    s = scene()
    body = s.add_body("disc", Disc(1.0, (3, 0)), METAL, velocity=lambda x: -2.0 * x[:, :2])
    np.testing.assert_allclose(body.v[:, :2], -2.0 * body.x[:, :2])
    bar = scene(1).add_body("bar", Box(0, 1), METAL, velocity=lambda x: np.where(x[:, 0] < 0.5, 600.0, 0.0))
    assert bar.v[:, 0].tolist() == [600.0] * 5 + [0.0] * 5
    assert scene(1).add_body("bar", Box(0, 1), METAL, velocity=600.0).v[0].tolist() == [600.0, 0.0, 0.0]


def test_spin_is_a_rigid_rotation():
    body = scene().add_body("disc", Disc(1.0, (3, 1)), METAL, velocity=spin(2.0, (3, 1)))
    arm = body.x - [3, 1, 0]
    np.testing.assert_allclose(np.linalg.norm(body.v, axis=1), 2.0 * np.linalg.norm(arm, axis=1))
    assert (np.cross(arm, body.v)[:, 2] > 0).all()


def test_points_and_volumes_can_be_given():
    points = Cartesian().fill(square(), 0.1, 2)
    for given in (points, points[:, :2], points[:, :2].tolist()):
        body = scene().add_body("cloud", given, METAL)
        np.testing.assert_array_equal(body.x, points)
        assert body.mass == pytest.approx(2785.0)
    volume = np.linspace(0.01, 0.02, 100)
    body = scene().add_body("cloud", points, METAL, volume=volume)
    np.testing.assert_array_equal(body.volume, volume)
    assert len(scene(1).add_body("pair", [0.0, 0.1], METAL)) == 2
    assert len(scene(3).add_body("one", [[0.0, 0.1, 0.2]], METAL)) == 1


def test_fix_sets_bits_where_asked():
    s = scene()
    body = s.add_body("plate", square(), METAL, velocity=(0, 1))
    s.fix("plate", lambda x: x[:, 0] < 0.1)
    assert (body.fixed == np.where(body.x[:, 0] < 0.1, 3, 0)).all()
    s.fix("plate", HalfSpace((0.9, 0), (1, 0)), components="y")
    assert (body.fixed[body.x[:, 0] > 0.9] == 2).all()
    s.fix("plate", components="x")
    assert (s.finalize().fixed & 1).all()
    s = scene(3, spacing=0.25)
    body = s.add_body("cube", Box((0, 0, 0), (1, 1, 1)), METAL)
    s.fix("cube", body.x[:, 2] < 0.25)
    assert sorted(set(body.fixed)) == [0, 7]


def test_touching_bodies_and_a_plane_half_a_spacing_away_are_fine():
    s = scene()
    s.add_body("left", square(), METAL)
    s.add_body("right", square(x=1.0), METAL)
    s.add_symmetry_plane("y")
    s.add_symmetry_plane("x", 2.0)
    assert s.finalize().planes == ((1, 0.0), (0, 2.0))


def test_close_pairs_are_compared_some_at_a_time(monkeypatch):
    x = np.random.default_rng(5).uniform(size=(300, 2))
    whole = close_pairs(x, 0.1)
    monkeypatch.setattr(overlap, "_MANY", 7)
    assert len(whole[0]) > 4 * len(x)  # it would stop there
    monkeypatch.setattr(overlap, "_ENOUGH", 1000)
    np.testing.assert_array_equal(close_pairs(x, 0.1), whole)


def test_a_crowd_at_one_place_takes_no_memory_for_each_pair():
    """Fifty thousand points would make a billion pairs."""
    tracemalloc.start()
    i, j = close_pairs(np.zeros((50_000, 3)), 1e-3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (i < j).all() and len(i) > 1 << 20 and peak < 3e8


def test_close_pairs_agree_with_all_pairs():
    rng = np.random.default_rng(3)
    for dim in (1, 2, 3):
        x = rng.uniform(-1, 1, (400, dim))
        i, j = close_pairs(x, 0.2)
        near = np.linalg.norm(x[:, None] - x, axis=2) < 0.2
        assert set(zip(i.tolist(), j.tolist(), strict=True)) == set(
            zip(*map(np.ndarray.tolist, np.nonzero(np.triu(near, 1))), strict=True)
        )
        assert len(set(zip(i, j, strict=True))) == len(i)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_close_pairs_are_found_however_far_apart_the_others_are(dim):
    """More cells along every axis than one number for each cell has room for."""
    far = np.random.default_rng(5).integers(-(2**40), 2**40, (300, dim)).astype(float)
    x = np.concatenate((far, far + 0.5 / np.sqrt(dim)))
    i, j = close_pairs(x, 0.6)
    assert i.tolist() == list(range(300)) and j.tolist() == list(range(300, 600))


def calls(build):
    """How many functions a call calls."""
    profile = cProfile.Profile()
    profile.runcall(build)
    return pstats.Stats(profile).total_calls


@pytest.mark.parametrize(
    "shape, lattice",
    [
        (Sphere(1.0) | Box((-1.0, -1.0, -1.0), (1.0, 1.0, 0.0)), "cartesian"),
        (Cone((0, 0, 0), (1, 1, 1), 1.0) - Cylinder((0, 0, 0), (1, 1, 1), 0.5), "face-centred-cubic"),
        (Disc(1.0), "core-and-rings"),
        (Box((0, 0), (1, 2)).rotate("z", 20.0), "hexagonal"),
    ],
)
def test_more_particles_take_no_more_calls(shape, lattice):
    def build(spacing):
        s = scene(dim=shape.dim, spacing=spacing)
        s.add_body("body", shape, METAL, lattice=lattice, velocity=(1.0,) * shape.dim)
        s.add_symmetry_plane("x", -9.0)
        s.fix("body", lambda x: x[:, 0] < 0.5)
        return len(s.finalize().x)

    coarse, fine = build(0.1), build(0.03)  # also loads what is only loaded once
    assert fine > 8 * coarse
    assert calls(lambda: build(0.03)) == calls(lambda: build(0.1))


def test_a_large_scene_is_checked_quickly():
    s = scene(3, spacing=0.02)
    s.add_body("cube", Box((0, 0, 0), (1, 1, 0.8)), METAL)
    start = time.perf_counter()
    assert len(s.finalize().x) == 100_000
    assert time.perf_counter() - start < 5.0


def two_bodies(second, **options):
    s = scene()
    s.add_body("plate", square(), METAL)
    s.add_body("ball", second, METAL, **options)
    return s


def with_plane(axis, position):
    s = scene()
    s.add_body("plate", square(), METAL)
    s.add_symmetry_plane(axis, position)
    return s


def test_overlap_depends_on_half_a_spacing():
    two_bodies(square(x=0.951)).finalize()
    with pytest.raises(
        InputError, match=r"bodies 'plate' and 'ball' overlap near \(.*\) m: 10 particle pairs"
    ):
        two_bodies(square(x=0.949)).finalize()


def test_refused_bodies_leave_the_scene_as_it_was():
    s = scene()
    with pytest.raises(InputError):
        s.add_body("plate", square(), METAL, density=-1.0)
    assert len(s) == 0 and not s.bodies


GRID = Cartesian().fill(square(), 0.1, 2)
NAMESAKE = materials.Material("metal", 1.0, materials.LinearElastic(K=1.0), materials.Fluid())


def same_name_twice():
    s = two_bodies(square(x=2.0))
    s.add_body("third", square(x=4.0), NAMESAKE)
    return s


BAD = {
    "scene name": (lambda: Scene("a/b", dim=2, spacing=0.1, until=1.0), "name of the scene = 'a/b'"),
    "dim": (lambda: scene(dim=4), "dim = 4 is not allowed; allowed: 1, 2 or 3"),
    "spacing": (lambda: scene(spacing=0.0), "spacing = 0.0 is not allowed; allowed: a positive number"),
    "until": (lambda: scene(until=-1.0), "until = -1.0"),
    "snapshots": (lambda: scene(snapshots=0), "snapshots = 0"),
    "numerics": (lambda: scene(numerics={"cfl": 1}), "numerics = {'cfl': 1}"),
    "no bodies": (lambda: scene().finalize(), "scene 'test' has no bodies"),
    "two of a name": (
        lambda: two_bodies(square()).add_body("ball", square(), METAL),
        "name of a body = 'ball'",
    ),
    "density": (
        lambda: two_bodies(square(), density=-1.0),
        "density of body 'ball' = -1.0 is not allowed; allowed: a positive number",
    ),
    "energy": (lambda: two_bodies(square(), internal_energy=np.nan), "internal_energy of body 'ball' = nan"),
    "lattice": (lambda: two_bodies(square(), lattice="cubic"), "lattice 'cubic' is unknown"),
    "lattice of points": (lambda: two_bodies(GRID, lattice="rings"), "lattice of body 'ball' = 'rings'"),
    "dimension": (
        lambda: two_bodies(Sphere(1.0)),
        "does not go with a problem in 2D; allowed: shapes in 2D, not in 3D",
    ),
    "empty": (lambda: two_bodies(square(size=0.01)), "body 'ball' has no particles"),
    "empty cut": (lambda: two_bodies(square() - Disc(9.0)), "body 'ball' has no particles"),
    "material": (
        lambda: two_bodies(square()).add_body("c", square(), "unobtainium"),
        "material 'unobtainium' is unknown",
    ),
    "material type": (lambda: scene().add_body("c", square(), 3), "material of body 'c' = 3"),
    "material name": (
        lambda: same_name_twice().finalize(),
        "material 'metal' does not go with another of that name",
    ),
    "velocity size": (lambda: two_bodies(square(), velocity=(1, 2, 3, 4)), "velocity of body 'ball'"),
    "velocity nan": (lambda: two_bodies(square(), velocity=(np.nan, 0)), "velocity of body 'ball'"),
    "velocity off plane": (lambda: two_bodies(square(), velocity=(0, 0, 1)), "zeros beyond the 2D problem"),
    "velocity function": (
        lambda: two_bodies(square(), velocity=lambda x: x / 0.0 * np.inf),
        "velocity of body 'ball'",
    ),
    "velocity count": (lambda: two_bodies(square(), velocity=np.zeros((7, 2))), "= 7 is not allowed"),
    "velocity text": (lambda: two_bodies(square(), velocity="fast"), "velocity of body 'ball' = 'fast'"),
    "volume": (lambda: two_bodies(square(), volume=0.0), "volume of body 'ball' = 0.0"),
    "volume count": (lambda: two_bodies(square(), volume=[1.0, 2.0]), "a positive number, or 100 of them"),
    "shape": (lambda: two_bodies("disc"), "points of body 'ball' = 'disc'"),
    "points shape": (
        lambda: two_bodies(np.zeros((5, 4))),
        "= (5, 4) is not allowed; allowed: (n, 2) or (n, 3)",
    ),
    "points off plane": (lambda: two_bodies(GRID + np.array([0, 0, 0.1])), "points of body 'ball', number 0"),
    "points nan": (lambda: two_bodies(GRID * np.nan), "points of body 'ball', number 0"),
    "spacing of points": (
        lambda: two_bodies(GRID * 1.4),
        "are 0.14 m apart on average; allowed: the scene's spacing of 0.1 m",
    ),
    "spacing of points, mm for m": (lambda: two_bodies(GRID * 1e-3), "are 0.0001 m apart"),
    "overlap": (
        lambda: two_bodies(square(x=0.5)).finalize(),
        "bodies 'plate' and 'ball' overlap near (0.55, 0.05) m: 50 particle pairs",
    ),
    "twice": (
        lambda: two_bodies(np.concatenate((GRID, GRID[:9])) + np.array([3, 0, 0])).finalize(),
        "body 'ball' has 9 particle pairs at the same place",
    ),
    "fix whom": (
        lambda: two_bodies(square()).fix("wall"),
        "body to fix = 'wall' is not allowed; allowed: plate, ball",
    ),
    "fix what": (
        lambda: two_bodies(square()).fix("ball", components="w"),
        "components of body 'ball' to fix = 'w'",
    ),
    "fix type": (lambda: two_bodies(square()).fix("ball", components=3), "to fix = 3 is not allowed"),
    "fix out of plane": (lambda: two_bodies(square()).fix("ball", components="z"), "allowed: letters of xy"),
    "fix nobody": (
        lambda: two_bodies(square()).fix("ball", Disc(1.0, (9, 9))),
        "selects none of its 100 particles",
    ),
    "fix where": (
        lambda: two_bodies(square()).fix("ball", lambda x: x[:3]),
        "where gives float64 of shape (3, 3)",
    ),
    "plane axis": (
        lambda: with_plane("z", 0.0),
        "axis of a symmetry plane = 'z' is not allowed; allowed: x, y in 2D",
    ),
    "plane through": (lambda: with_plane("x", 0.3).finalize(), "symmetry plane x = 0.3 m"),
    "plane too near": (lambda: with_plane("y", 0.03).finalize(), "beyond or on the symmetry plane"),
    "planes of an axis": (
        lambda: with_plane("x", 0.0).add_symmetry_plane("x", 1.0),
        "one plane for each axis",
    ),
    "name that moves the cursor": (
        lambda: scene().add_body("a\tb", square(), METAL),
        r"name of a body = 'a\tb' is not allowed; allowed: a printable text",
    ),
    "name of a measure": (
        lambda: scene().add_measure("a\nb", len),
        r"name of a measure = 'a\nb' is not allowed; allowed: a printable text",
    ),
    "unit of a measure": (lambda: scene().add_measure("a", len, "\x1b"), r"unit of measure 'a' = '\x1b'"),
    "measure": (lambda: scene().add_measure("a", 3.0), "function of measure 'a' = 3.0"),
}


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning", "ignore:divide by zero:RuntimeWarning")
@pytest.mark.parametrize("call, message", BAD.values(), ids=BAD)
def test_bad_input_is_one_clear_line(call, message):
    with pytest.raises(InputError) as error:
        call()
    assert message in str(error.value)
    assert "allowed: " in str(error.value) and "\n" not in str(error.value)


def test_a_mesh_body_weighs_what_it_should(tmp_path):
    import pyvista

    pyvista.Cylinder(radius=10, height=40, direction=(1, 0, 0), resolution=90).save(tmp_path / "rod.stl")
    s = scene(3, spacing=1e-3)
    rod = s.add_body("rod", Mesh(tmp_path / "rod.stl").scale(1e-3).translate((0, 0, 0.1)), METAL)
    assert rod.mass == pytest.approx(2785.0 * np.pi * 1e-4 * 0.04, rel=0.02)
