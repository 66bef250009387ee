"""Debris on a plate: the paper's particles, the measures on a perforation of known answer, and a small impact."""

import numpy as np
import pytest

from warpsph import library, materials
from warpsph.scenes import debris_3d as debris
from warpsph.solver import Solver
from warpsph.state import State

FILE = library.load("debris_3d")
PLUG, HOLE, RIM = 4.2e-3, 6e-3, 9e-3
"""Radii of the made-up perforation [m]: of the plug, the hole, and the foot of the lip."""


def state(data, x, v, damage, kernel_type):
    """Picture of a finished scene's particles with these positions, velocities, damage and kernel types."""
    fields = {"x": x, "v": v, "D": damage, "kernel_type": kernel_type, "body": data.body, "fixed": data.fixed}
    names = [material.name for material in data.materials]
    return State(153e-6, 1, 3, data.spacing, data.h, data.name, data.bodies, names, fields)


def perforated(**parameters):
    """Scene, and its plate with a hole: plug 40 mm ahead, a cone of 45 degrees as lip, the rest spalled."""
    data = FILE.build(**parameters).finalize()
    x, v, plate = data.x.copy(), data.v.copy(), data.body == 1
    r = np.hypot(x[:, 0], x[:, 1])
    plug, spall = plate & (r < PLUG), plate & (r >= PLUG) & (r < HOLE)
    lip = plate & (r >= HOLE) & (r < RIM)
    x[plug, 2] += 40e-3
    x[lip, 2] += RIM - r[lip]
    x[spall] *= 10.0
    x[~plate, 2] += 30e-3
    v[~plate, 2], v[plug, 2] = 300.0, 350.0
    damage, kernel_type = spall.astype(float), np.where(spall, 0, 1)
    return data, state(data, x, v, damage, kernel_type), spall


def measured(data, state):
    return {name: measure.function(state) for name, measure in data.measures.items()}


@pytest.mark.parametrize(("scheme", "quarter"), [("adaptle", False), ("eul", False), ("tlag", True)])
def test_the_particles_are_those_of_the_paper(scheme, quarter):
    data = FILE.build(scheme=scheme, quarter=quarter).finalize()
    share = 4 if quarter else 1
    assert np.bincount(data.body).tolist() == [912 // share, 30000 // share]
    clamped = data.fixed > 0
    assert clamped.sum() == (100**2 - 98**2) * 3 // share and set(data.fixed[clamped]) == {7}
    np.testing.assert_allclose(np.abs(data.x[clamped, :2]).max(axis=1), 49.5e-3)
    plate = data.body == 1
    np.testing.assert_allclose(np.unique(data.x[plate, 2].round(9)), (0.5e-3, 1.5e-3, 2.5e-3))
    gap = data.x[plate, 2].min() - data.x[~plate, 2].max()
    assert gap == pytest.approx(2.0 * data.h), "the supports are about to overlap"


def test_the_schemes_are_those_of_the_paper():
    made = {
        scheme: FILE.build(scheme=scheme, correction=False, viscosity=1.0)
        for scheme in ("eul", "tlag", "patch", "adaptle")
    }
    numerics = {scheme: scene.numerics for scheme, scene in made.items()}
    names = {scheme: n.scheme for scheme, n in numerics.items()}
    assert names == {"eul": "sav1", "tlag": "tl-plain", "patch": "adaptle-plain", "adaptle": "adaptle-plain"}
    assert [s for s, n in numerics.items() if n.erosion] == ["tlag"]
    assert [s for s, n in numerics.items() if n.conversion is not None] == ["adaptle"]
    assert all((n.viscosity_alpha, n.viscosity_beta) == (1.0, 2.0) for n in numerics.values())
    modulus = 2870.0 * 5328.0**2
    assert numerics["eul"].contact.stiffness * modulus / 1e-9 == pytest.approx(2e19, rel=1e-3)
    assert FILE.build().numerics.scheme == "adaptle"


def test_the_aluminium_differs_by_what_is_asked_for():
    given, library_one = debris.aluminium(1.0, 0.0101, "all"), materials.get("aluminium-jc")
    changed = {k for k, v in given.strength.constants.items() if v != library_one.strength.constants[k]}
    assert changed == {"chi", "C"} and (given.strength.chi, given.strength.C) == (1.0, 0.0101)
    assert given.damage == library_one.damage and given.eos == library_one.eos
    assert debris.aluminium(0.9, 0.101, "compression").damage.carries == "compression"


def test_nothing_is_measured_before_anything_happens():
    data = FILE.build().finalize()
    zero = np.zeros(len(data.x))
    found = measured(data, state(data, data.x, data.v, zero, zero + 1))
    assert found.pop("debris_velocity") == 500.0
    faster = 500.0 / 299.0 - 1.0
    assert found.pop("velocity_error") == pytest.approx((faster + 1.0) / 2.0)
    assert found.pop("mean_error") == pytest.approx((faster + 4.0) / 5.0)
    assert set(found.values()) == {0.0}


@pytest.mark.parametrize("quarter", [False, True])
def test_measures_of_a_known_perforation(quarter):
    """The plug reaches out to 3.5 mm along x and y; on a cone of 45 degrees height and radius add up to the rim's."""
    data, state, spall = perforated(quarter=quarter)
    found = measured(data, state)
    assert found["debris_velocity"] == pytest.approx(300.0)
    assert found["plug_velocity"] == pytest.approx(350.0)
    assert found["plug_width"] == pytest.approx(7e-3)
    assert HOLE < 0.5 * found["hole_diameter"] <= 0.5 * found["impact_diameter"] < HOLE + data.spacing
    assert found["lip_height"] == pytest.approx(RIM - 0.5 * found["impact_diameter"])
    assert found["failed"] == found["spalled"] == spall.sum() * (4 if quarter else 1)
    assert found["converted_share"] == pytest.approx(spall.mean())


def test_a_quarter_measures_what_the_whole_does():
    one, other = (measured(*perforated(quarter=quarter)[:2]) for quarter in (False, True))
    assert one == pytest.approx(other, rel=1e-12)


def test_what_bears_no_tension_links_nothing():
    """A disc that eroded or failed particles alone hold in the plate is ahead of the sphere, and loose."""
    data = FILE.build(scheme="tlag", quarter=True).finalize()
    r = np.hypot(data.x[:, 0], data.x[:, 1])
    plate = data.body == 1
    ring = (plate & (r > 4e-3) & (r < 8e-3)).astype(int)

    def taken_apart(damage, kernel_type, crumbles):
        picture = state(data, data.x, data.v, damage, kernel_type)
        return debris.pieces(picture, quarter=True, crumbles=crumbles)

    for intact in (taken_apart(0 * ring, 0 * ring, True), taken_apart(ring, 0 * ring, False)):
        assert intact.plate.all() and not intact.plug.any()
    failed, gone = taken_apart(ring, 0 * ring, True), taken_apart(ring, debris.ERODED * ring, True)
    for cut in (failed, gone):
        assert cut.plug.sum() == 4 * (plate & (r <= 4e-3)).sum()
    assert failed.plate.sum() == 4 * (plate & (r > 4e-3)).sum(), "what has failed lies on the plate"
    assert gone.plate.sum() == 4 * (plate & (r >= 8e-3)).sum()


def test_an_overhanging_lip_is_narrower_than_its_tip():
    """A plate of two rings, the inner one nearer the axis and lower: they are the hole's edge and the lip's tip."""
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    ring = np.stack((np.cos(turn), np.sin(turn), 0.0 * turn), axis=1)
    x = np.concatenate((7e-3 * ring + (0.0, 0.0, 8e-3), 8e-3 * ring + (0.0, 0.0, 9e-3)))
    every, none = np.ones(len(x), dtype=bool), np.zeros(len(x), dtype=bool)
    found = debris.Pieces(x, x[:, 2], x[:, 2], none, every, none)
    tip, edge = debris.lip(found, 1e-3)
    assert (debris.across(tip), debris.across(edge)) == pytest.approx((16e-3, 14e-3))
    assert tip[:, 2] == pytest.approx(9e-3) and edge[:, 2] == pytest.approx(8e-3)
    assert len(tip) == debris.SECTORS


def test_the_plug_is_the_largest_piece_ahead():
    label, z = np.array([4, 1, 1, 1, 2, 2, 4, 7]), np.array([9.0, 0.0, 3.0, 0.0, 4.0, 6.0, 9.0, 9.0])
    assert debris.foremost(label, z, 0.5) == 1
    assert debris.foremost(label, z, 2.0) == 2
    assert debris.foremost(label, z, 5.5) == 4
    assert debris.foremost(label, z, 9.5) == debris.foremost(label[:0], z[:0], 0.0) == -2


@pytest.mark.parametrize("scheme", ["eul", "tlag", "patch", "adaptle"])
def test_a_small_impact(scheme):
    """The sphere loses speed to the plate, which fails around it; energy is what it was."""
    data = FILE.build(scheme=scheme, spacing=1.5e-3, speed=800.0, quarter=True).finalize()
    solver = Solver(data)
    solver.advance(25e-6)
    found, state = measured(data, solver.state()), solver.state()
    assert 200.0 < found["debris_velocity"] < 700.0
    assert 0.0 < found["failed"] < 0.2 * len(data.x) * 4
    assert np.isfinite(state.x).all() and np.isfinite(state.v).all()
    clamped = data.fixed > 0
    np.testing.assert_array_equal(state.x[clamped], data.x[clamped])
    if scheme != "patch":  # there, particles beside the patch that turn over convert
        assert (found["converted_share"] > 0.0) == (scheme == "adaptle")
    assert (state.kernel_type == debris.ERODED).any() == (scheme == "tlag")
    start = 0.5 * float(np.sum(data.m[:, None] * data.v**2))
    ledger = solver.ledger()
    assert ledger["kinetic_energy"] + ledger["internal_energy"] == pytest.approx(start, rel=1e-12)
