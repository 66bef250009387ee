"""Lattices: the papers' particle counts, spacings, mass, and robustness to round-off."""

import numpy as np
import pytest

from warpsph import lattices
from warpsph.errors import InputError
from warpsph.lattices import Cartesian, CoreAndRings, FaceCentredCubic, Hexagonal, Rings
from warpsph.memory import available
from warpsph.overlap import mean_spacing
from warpsph.shapes import Box, Disc, HalfSpace, Ring, Sphere

MM = 1e-3


@pytest.mark.parametrize(
    "lattice, shape, spacing, dim, count",
    [
        (CoreAndRings(), Disc(5 * MM), 0.1 * MM, 2, 7830),
        (Rings("edges"), Disc(5 * MM), 0.1 * MM, 2, 8012),
        (Cartesian(), Box((0, -25.05 * MM), (2 * MM, 25.05 * MM)), 0.1 * MM, 2, 10020),
        (Cartesian(), Sphere(6 * MM), 1 * MM, 3, 912),
        (Cartesian("halves"), Sphere(6 * MM), 1 * MM, 3, 912),
        (Cartesian(), Box((0, -50 * MM, -50 * MM), (3 * MM, 50 * MM, 50 * MM)), 1 * MM, 3, 30000),
        (Cartesian("edges"), Box((-20 * MM, -5 * MM), (0, 5 * MM)), 0.25 * MM, 2, 81 * 41),
        (Cartesian("edges"), Box((0, -50 * MM), (30 * MM, 50 * MM)), 0.25 * MM, 2, 121 * 401),
        (Rings(), Ring(80 * MM, 100 * MM), 20 * MM / 17, 2, 8172),
        (Cartesian(), Box(0.0, 5 * MM), 0.1 * MM, 1, 50),
        (Cartesian("integers"), Disc(5 * MM), 0.1 * MM, 2, 7845),  # Gauss's circle problem: N(50)
    ],
)
def test_particle_counts_of_the_papers(lattice, shape, spacing, dim, count):
    assert len(lattice.fill(shape, spacing, dim)) == count


def test_core_and_rings_has_the_parts_of_the_paper():
    dx = 0.1 * MM
    r = np.linalg.norm(CoreAndRings().fill(Disc(5 * MM), dx, 2), axis=1)
    assert np.isclose(r, 50 * dx).sum() == 314
    assert np.isclose(r, 49 * dx).sum() == 307
    assert (r < 47.9999999 * dx).sum() == 7209


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.1, 0.2), (-0.3, 7.7e-3), (1 / 3, -1 / 7)])
@pytest.mark.parametrize(
    "lattice, count", [(CoreAndRings(), 7830), (Rings("edges"), 8012), (Cartesian("edges"), 7845)]
)
def test_a_disc_holds_as_many_particles_wherever_it_is(lattice, count, shift):
    disc = Disc(5 * MM).translate(shift)
    points = lattice.fill(disc, 0.1 * MM, 2)
    assert len(points) == count
    np.testing.assert_allclose(points.mean(axis=0), [*shift, 0.0], atol=1e-9)


@pytest.mark.parametrize("at, count", [("cells", 20 * 501), ("edges", 21 * 502)])
@pytest.mark.parametrize("low", [(0.0, 0.0), (0.1, -0.02505), (1 / 3, 5.0)])
def test_round_off_does_not_decide_at_the_edges_of_a_plate(at, count, low):
    plate = Box(low, (low[0] + 0.002, low[1] + 0.0501))
    assert len(Cartesian(at).fill(plate, 1e-4, 2)) == count


def test_cells_leave_half_a_spacing_to_the_faces_and_edges_none():
    box = Box((0.0, 1.0), (1.0, 3.0))
    for at, margin in (("cells", 0.05), ("edges", 0.0)):
        points = Cartesian(at).fill(box, 0.1, 2)
        np.testing.assert_allclose(points.min(axis=0), [margin, 1.0 + margin, 0.0], atol=1e-12)
        np.testing.assert_allclose(points.max(axis=0), [1.0 - margin, 3.0 - margin, 0.0], atol=1e-12)


def test_a_length_that_is_no_multiple_of_the_spacing_leaves_equal_margins():
    x = Cartesian().fill(Box(0.0, 1.06), 0.1, 1)[:, 0]
    assert len(x) == 11  # round(10.6)
    assert x[0] == pytest.approx(1.06 - x[-1])
    assert len(Cartesian("edges").fill(Box(0.0, 1.06), 0.1, 1)) == 11  # floor(10.6) + 1


def test_integers_and_halves_stay_on_their_lattice_and_meet_without_gap():
    left, right = Box((0.0, 0.0), (0.31, 1.0)), Box((0.31, 0.0), (1.0, 1.0))
    points = np.concatenate([Cartesian("halves").fill(part, 0.1, 2) for part in (left, right)])
    whole = Cartesian("halves").fill(Box((0.0, 0.0), (1.0, 1.0)), 0.1, 2)
    assert len(points) == len(whole) == 100
    moved = Cartesian("integers", origin=(0.03, 0.0)).fill(left, 0.1, 2)
    assert set(np.round(moved[:, 0], 9)) == {0.03, 0.13, 0.23}


@pytest.mark.parametrize(
    "lattice, shape, dim, neighbours",
    [
        (Cartesian(), Box((0, 0), (1, 1)), 2, 4),
        (Hexagonal(), Box((0, 0), (1, 1)), 2, 6),
        (FaceCentredCubic(), Box((0, 0, 0), (1, 1, 1)), 3, 12),
    ],
)
def test_nearest_neighbours_are_a_spacing_away(lattice, shape, dim, neighbours):
    points, spacing = lattice.fill(shape, 0.05, dim), 0.05
    middle = points[np.argmin(np.linalg.norm(points - [0.5, 0.5, 0.5 * (dim == 3)], axis=1))]
    distance = np.sort(np.linalg.norm(points - middle, axis=1))
    np.testing.assert_allclose(distance[1 : neighbours + 1], spacing, rtol=1e-9)
    assert distance[neighbours + 1] > 1.2 * spacing
    assert mean_spacing(points) == pytest.approx(spacing)


@pytest.mark.parametrize(
    "name, shape, dim, volume",
    [
        ("cartesian", Disc(1.0), 2, np.pi),
        ("hexagonal", Disc(1.0), 2, np.pi),
        ("rings", Disc(1.0), 2, np.pi),
        ("rings", Ring(0.5, 1.0), 2, 0.75 * np.pi),
        ("cartesian", Sphere(1.0), 3, 4 / 3 * np.pi),
        ("face-centred-cubic", Sphere(1.0), 3, 4 / 3 * np.pi),
        ("cartesian", Box(0.0, 2.0), 1, 2.0),
    ],
)
def test_cells_add_up_to_the_volume_of_the_shape(name, shape, dim, volume):
    spacing = 0.02 if dim < 3 else 0.05
    lattice = lattices.get(name)
    total = len(lattice.fill(shape, spacing, dim)) * lattice.cell_volume(spacing, dim)
    assert total == pytest.approx(volume, rel=0.01)


def test_rings_are_symmetric_about_the_x_axis():
    points = Rings().fill(Disc(1.0), 0.1, 2)
    mirrored = points * [1.0, -1.0, 1.0]
    assert np.linalg.norm(points[:, None] - mirrored, axis=2).min(axis=1).max() < 1e-12


def test_rings_fill_half_a_disc_about_the_given_centre():
    half = Disc(1.0) & HalfSpace((0, 0), (1, 0))
    whole = Rings().fill(Disc(1.0), 0.1, 2)
    assert len(Rings(center=(0, 0)).fill(half, 0.1, 2)) == (whole[:, 0] >= -1e-9).sum()


def test_a_tiny_disc_is_one_particle_or_few():
    for radius in (0.3, 0.5, 0.7, 1.0, 1.3):
        for lattice in (Rings(), Rings("edges"), CoreAndRings(), Cartesian()):
            points = lattice.fill(Disc(radius), 1.0, 2)
            gaps = np.linalg.norm(points[:, None] - points, axis=2)[~np.eye(len(points), dtype=bool)]
            assert gaps.min(initial=1.0) > 0.3


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: lattices.get("hexagnal"), "did you mean 'hexagonal'"),
        (lambda: lattices.get(3), "lattice 3 is unknown; allowed: cartesian, hexagonal"),
        (lambda: Cartesian("corners"), "allowed: cells, edges, integers, halves"),
        (lambda: Rings("halves"), "allowed: cells, edges"),
        (
            lambda: Hexagonal().fill(Sphere(1.0), 0.1, 3),
            "does not go with a problem in 3D; allowed: cartesian, face-centred-cubic",
        ),
        (
            lambda: Cartesian().fill(Sphere(1.0), 0.1, 2),
            "does not go with a problem in 2D; allowed: shapes in 2D, not in 3D",
        ),
        (lambda: Cartesian().fill(HalfSpace((0, 0), (1, 0)), 0.1, 2), "unbounded"),
        (
            lambda: Cartesian().fill(Disc(1.0), -0.1, 2),
            "spacing = -0.1 is not allowed; allowed: a positive number",
        ),
        (
            lambda: Cartesian().fill(Sphere(1.0), 1e-6, 3),
            "spacing = 1e-06 m of a lattice gives about 8e+18 particles; building them takes",
        ),
    ],
)
def test_bad_input_is_one_clear_line(call, message):
    with pytest.raises(InputError) as error:
        call()
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("spacing", [1e-9, 1e-300, 5e-324])
@pytest.mark.parametrize(
    "lattice, shape",
    [
        (Cartesian(), Box(0.0, 1.0)),
        (Cartesian("integers"), Box((0.0, 0.0), (50 * MM, 2 * MM))),
        (Cartesian(), Box((0.0, 0.0, 0.0), (5e-10, 1.0, 1.0))),
        (Hexagonal(), Disc(5 * MM)),
        (FaceCentredCubic(), Sphere(5 * MM)),
        (Rings(center=(1.0, 1.0)), Disc(5 * MM)),
        (CoreAndRings(), Disc(5 * MM)),
    ],
)
def test_a_spacing_far_too_fine_is_refused_before_anything_is_made(lattice, shape, spacing, monkeypatch):
    """And what is said to be allowed is."""
    monkeypatch.setattr(available, "on_host", lambda: 30_000_000)
    made = []
    monkeypatch.setattr(type(lattice), "points", lambda *_: made.append(True) or np.zeros((1, 3)))
    with pytest.raises(InputError) as error:
        lattice.fill(shape, spacing, shape.dim, "body 'plate'")
    message = str(error.value)
    assert (
        not made
        and "\n" not in message
        and "of body 'plate' gives" in message
        and "30 MB are free" in message
    )
    allowed = float(message.split("a spacing of ")[1].removesuffix(" m or more"))
    lattice.fill(shape, allowed, shape.dim)
    assert made
    with pytest.raises(InputError):
        lattice.fill(shape, allowed / 1.3, shape.dim)


@pytest.mark.parametrize(
    "lattice, dim", [("cartesian", 1), ("rings", 2), ("hexagonal", 2), ("face-centred-cubic", 3)]
)
def test_points_are_counted_before_they_are_made(lattice, dim):
    shape = {1: Box(0.0, 1.0), 2: Disc(0.5), 3: Sphere(0.5)}[dim]
    found, bounds = lattices.get(lattice), shape.bounds()
    exact = found.fill(shape, 0.02, dim)
    share = {1: 1.0, 2: np.pi / 4.0, 3: np.pi / 6.0}[dim]
    assert found.count(bounds, 0.02, dim) * share == pytest.approx(len(exact), rel=0.05)


def test_particles_are_held_against_memory_when_they_are_known(monkeypatch):
    """All points of the box can be made, but all of them are kept."""
    monkeypatch.setattr(available, "on_host", lambda: 200 * 10_000)
    with pytest.raises(
        InputError, match=r"gives about 1e\+04 particles; building them takes 2\.5 MB, 2 MB are free"
    ):
        Cartesian().fill(Box((0.0, 0.0), (1.0, 1.0)), 0.01, 2)
    assert len(Cartesian().fill(Disc(0.5), 0.01, 2)) == 7860
    monkeypatch.setattr(available, "on_host", lambda: None)
    assert len(Cartesian().fill(Box((0.0, 0.0), (1.0, 1.0)), 0.01, 2)) == 10_000
