"""Which terms a pair of current neighbours has: two kernel types and two bodies (method sections 5 and 6)."""

import functools
from dataclasses import dataclass

import warp as wp

from .kernel_type import ERODED, EULERIAN
from .spec import Spec
from .tensor import make_tensor

EDGE = 1.0 - 1.0e-6
"""Reference neighbours are nearer than this share of the support. A lattice has pairs exactly at the support when that is
a multiple of its spacing: were they on the edge, rounding would decide, and for the images at a symmetry plane not the
same on both sides."""

FORCE, ARTIFICIAL_STRESS = 1, 2
"""Bits of a pair: stress and viscosity in the Eulerian form; artificial stress."""

ALL = FORCE | ARTIFICIAL_STRESS
"""Every term, as between any two particles of a purely Eulerian scene without contact."""


@dataclass(frozen=True)
class Coupling:
    """How particles of two kernel types, and of two bodies, act on each other.

    Attributes:
        form: ``""``: there are Eulerian particles only. ``"printed"``: every particle sums in its own form, over
            neighbours of both types (Young et al.). ``"conservative"``: one antisymmetric force for each pair, in the
            Lagrangian form where a member is Lagrangian and the two are reference neighbours, else in the Eulerian one.
        stress: Artificial stress of a pair of both types acts on ``"both"``, on ``"none"``, or on the ``"eulerian"``.
        separate: Bodies act on each other through contact alone.
    """

    form: str = ""
    stress: str = "both"
    separate: bool = False

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        return "_".join(
            p for p in (self.form, self.stress if self.form else "", "separate" * self.separate) if p
        )


PURE = Coupling()
"""Eulerian particles only, and no contact: every pair has every term."""


@functools.cache
def make_counts(separate: bool, erosion: bool = False) -> wp.Function:
    """Build counts(body_i, body_j, type_j): whether a neighbour counts in sums over i's surroundings.

    Args:
        separate: Those of another body do not.
        erosion: Eroded ones do not.
    """

    @wp.func
    def counts(body_i: wp.int32, body_j: wp.int32, type_j: wp.int32):
        if wp.static(separate) and body_i != body_j:
            return False
        if wp.static(erosion) and type_j == ERODED:
            return False
        return True

    return counts


@functools.cache
def make_coupling(s: Spec, coupling: Coupling) -> wp.Function:
    """Build terms(type_i, type_j, same_body, Xij, reach) -> bits of the pair as particle i sees it."""
    real, vec = s.real, s.vec
    dot, separate, form = make_tensor(s).dot, coupling.separate, coupling.form
    other = 0 if separate else ALL

    if not form:

        @wp.func
        def terms(type_i: wp.int32, type_j: wp.int32, same: bool, Xij: vec, reach: real):
            if wp.static(separate) and not same:
                return 0
            return wp.static(ALL)

        return terms

    stress_on = {"both": (True, True), "none": (False, False), "eulerian": (True, False)}[coupling.stress]
    eulerian = ARTIFICIAL_STRESS if stress_on[0] else 0
    lagrangian = ARTIFICIAL_STRESS if stress_on[1] else 0
    conservative, edge2 = form == "conservative", real(EDGE**2)

    @wp.func
    def terms(type_i: wp.int32, type_j: wp.int32, same: bool, Xij: vec, reach: real):
        if type_i == ERODED or type_j == ERODED:
            return 0
        if not same:
            return wp.static(other)
        if type_i == type_j:
            return wp.where(type_i == EULERIAN, wp.static(ALL), 0)
        if type_i == EULERIAN:
            if wp.static(conservative) and dot(Xij, Xij) < edge2 * reach * reach:
                return wp.static(eulerian)
            return wp.static(eulerian | FORCE)
        if wp.static(conservative) and dot(Xij, Xij) >= edge2 * reach * reach:
            return wp.static(lagrangian | FORCE)
        return wp.static(lagrangian)

    return terms
