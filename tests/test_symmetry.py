"""Symmetry planes: part of a problem with planes is the whole problem."""

import numpy as np
import pytest
from tools import SPACING, by_id, run, scene

from warpsph.config import Conversion
from warpsph.shapes import Box

MATERIAL = "aluminium"
LAGRANGIAN = ("tl", "tl-plain", "adaptle-as", "adaptle-mixed")


def numerics(scheme):
    """Lagrangian particles convert if they can."""
    return {"conversion": Conversion(strain=0.02)} if "adaptle" in scheme else {}


def half(cut, scheme):
    """A block that hits another; ``cut`` at y = 0, by a plane or not at all."""
    made = scene(2, scheme=scheme, **numerics(scheme))
    low = 0.0 if cut else -6 * SPACING
    made.add_body(
        "left", Box((-8 * SPACING, low / 2), (-SPACING, 3 * SPACING)), MATERIAL, velocity=(500.0, 0.0)
    )
    made.add_body("right", Box((0.0, low), (5 * SPACING, 6 * SPACING)), MATERIAL)
    if cut:
        made.add_symmetry_plane("y", 0.0)
    return made


def quarter(cut, scheme):
    """A block that collapses onto its centre; ``cut`` at x = 0 and y = 0."""
    made = scene(2, scheme=scheme, **numerics(scheme))
    low = 0.0 if cut else -6 * SPACING
    made.add_body("block", Box((low, low), (6 * SPACING, 6 * SPACING)), MATERIAL, velocity=lambda x: -4e4 * x)
    for axis in "xy" if cut else "":
        made.add_symmetry_plane(axis, 0.0)
    return made


@pytest.mark.parametrize(("build", "corner"), [(half, (-1.0, 0.0)), (quarter, (0.0, 0.0))])
@pytest.mark.parametrize("scheme", ["sav1", "bal-mixed-as", "pm-mixed", "ts2", "ts2-mixed", *LAGRANGIAN])
def test_part_of_a_problem_is_the_whole(build, corner, scheme):
    whole, part = (run(build(cut, scheme), 2e-6) for cut in (False, True))
    assert whole.reading.steps == part.reading.steps > 10
    kept = (whole.data.x[:, :2] > corner).all(axis=1)
    order = {
        name: np.lexsort(np.round(x / SPACING * 2).astype(int).T)
        for name, x in (("whole", whole.data.x[kept]), ("part", part.data.x))
    }
    for name, scale in (
        ("x", SPACING),
        ("v", 500.0),
        ("rho", 2785.0),
        ("e", 1e5),
        ("tau", 1e9),
        ("dvdx", 1e5),
    ):
        reference, found = by_id(whole, name)[kept][order["whole"]], by_id(part, name)[order["part"]]
        np.testing.assert_allclose(found, reference, atol=1e-11 * scale)
    kinds = [by_id(whole, "kernel_type")[kept][order["whole"]], by_id(part, "kernel_type")[order["part"]]]
    np.testing.assert_array_equal(*kinds)
    if scheme in LAGRANGIAN:
        F = [by_id(whole, "F")[kept][order["whole"]], by_id(part, "F")[order["part"]]]
        np.testing.assert_allclose(*F, atol=1e-11)
        assert (len(set(kinds[0].tolist())) == 2) == ("adaptle" in scheme)
