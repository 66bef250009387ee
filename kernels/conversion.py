"""What ends a Lagrangian particle: conversion to an Eulerian one, or erosion (method sections 4, 5 and 8; paper A 2.3)."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import warp as wp

from .deformation import INVERTED
from .kernel_type import ERODED, EULERIAN, LAGRANGIAN
from .lanes import make_lanes
from .mirror import make_mirror
from .spec import Spec
from .strain import make_strain
from .tensor import make_tensor

RIPE = 0.7
"""From this share of a criterion on a particle is expected to convert: its neighbour rows are kept at hand."""

Criterion = Callable[[Spec], wp.Function]
"""Gives, for a specialisation, a device function (F, tau, p, ep, D, T) -> real: the particle converts from 1 on."""


@dataclass(frozen=True)
class Criteria:
    """When a particle converts, as far as it is compiled in.

    Attributes:
        measure: Measure of the equivalent strain, ``""`` if strain does not matter; ``"plastic"``: εp.
        damage: D >= 1 converts a particle, and reference neighbours with it.
        criterion: A user's own.
    """

    measure: str = ""
    damage: bool = False
    criterion: Criterion | None = None

    @property
    def tag(self) -> str:
        """Short name of the combination; a user's criterion is told from others by its name and place in memory."""
        own = self.criterion
        name = f"{getattr(own, '__name__', 'own')}_{id(own):x}" if own is not None else ""
        return "_".join(filter(None, (self.measure.replace("-", "_"), "damage" * self.damage, name)))


class ConversionKernels(NamedTuple):
    """Kernels of this file."""

    begin: wp.Kernel
    judge: wp.Kernel
    spread: wp.Kernel
    convert: wp.Kernel
    erode: wp.Kernel
    interfaces: wp.Kernel


@functools.cache
def make_conversion(s: Spec, criteria: Criteria, planes: bool, sheet: bool = False) -> ConversionKernels:
    """Build the kernels for one set of criteria; ``sheet``: plane stress, where the thickness changes."""
    real, point, matrix = s.real, s.point, s.mat
    mirror, tensor = make_mirror(s, planes), make_tensor(s)
    dot, unpack = tensor.dot, tensor.unpack
    lanes = make_lanes(s)
    last_end, stride = lanes.last_end, lanes.stride
    zero, one, ripe_share = real(0.0), real(1.0), real(RIPE)
    measured = criteria.measure not in ("", "plastic")
    strain = make_strain(s, criteria.measure if measured else "logarithmic")
    own = criteria.criterion(s) if criteria.criterion is not None else None
    module = s.module(__name__, "_".join(filter(None, (criteria.tag, "planes" * planes, "sheet" * sheet))))

    @wp.func
    def strained(F: matrix, thickness: real, ep: real, limit: real):
        """Equivalent strain over its limit."""
        if wp.static(measured):
            return strain(F, thickness, ripe_share * limit) / limit
        if wp.static(criteria.measure == "plastic"):
            return ep / limit
        return zero

    if own is not None:

        @wp.func
        def asked(F: matrix, tau: matrix, p: real, ep: real, D: real, T: real):
            return own(F, tau, p, ep, D, T)

    else:

        @wp.func
        def asked(F: matrix, tau: matrix, p: real, ep: real, D: real, T: real):
            return zero

    @wp.kernel(module=module)
    def begin(
        offset: wp.int32,
        # out:
        spreading: wp.array[real],
        changed: wp.array[real],
    ):
        """Nothing has happened yet in this step. Both are 1 where it has, and stand for dt of kernels that act then."""
        i = wp.tid() + offset
        spreading[i] = zero
        changed[i] = zero

    @wp.kernel(module=module)
    def judge(
        offset: wp.int32,
        # in:
        F: wp.array[matrix],
        tau: wp.array[s.sym],
        p: wp.array[real],
        ep: wp.array[real],
        D: wp.array[real],
        T: wp.array[real],
        thickness: wp.array[real],
        kernel_type: wp.array[wp.int32],
        strain_limit: real,
        layers: wp.int32,
        turns: wp.int32,
        dt: wp.array[real],
        # out:
        fate: wp.array[wp.int32],
        inverted: wp.array[wp.int32],
        ripe: wp.array[wp.int32],
        spreading: wp.array[real],
        turned: wp.array[wp.int32],
    ):
        """fate = 0: stays; n >= 1: converts, and reference neighbours within n - 1 layers with it (section 5).

        Where F is not physical the particle converts with its neighbours (an Eulerian one takes its neighbours along),
        or, unless ``turns``, the run is told to stop.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        verdict = wp.int32(0)
        lagrangian = kernel_type[i] == LAGRANGIAN
        if fate[i] == wp.static(INVERTED):
            inverted[i] = inverted[i] + 1
            verdict = 2
            if lagrangian and turns == 0:
                turned[0] = 1
                verdict = 0
        share = zero
        if lagrangian:
            across = one
            if wp.static(sheet):
                across = thickness[i]
            share = wp.max(
                strained(F[i], across, ep[i], strain_limit),
                asked(F[i], unpack(tau[i]), p[i], ep[i], D[i], T[i]),
            )
            if share >= one:
                verdict = wp.max(verdict, 1)
            if wp.static(criteria.damage):
                share = wp.max(share, D[i])
                if D[i] >= one:
                    verdict = wp.max(verdict, 1 + layers)
        ripe[i] = wp.where(share >= ripe_share, 1, 0)
        fate[i] = verdict
        if verdict > 1:
            spreading[0] = one

    @wp.kernel(module=module)
    def spread(
        offset: wp.int32,
        # in:
        X: wp.array[point],
        kernel_type: wp.array[wp.int32],
        fate: wp.array[wp.int32],
        spread_radius: real,
        plane: point,
        spreading: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        # out:
        fate_next: wp.array[wp.int32],
    ):
        """fate' = max(fate, fate_b - 1) over reference neighbours b within the radius: one layer further."""
        i = wp.tid() + offset
        own_fate = wp.int32(fate[i])
        if spreading[0] > zero and kernel_type[i] == LAGRANGIAN:
            for k in range(start0[i], last_end(start0[i], n_neigh0[i]), stride):
                j = mirror.index(neigh0[k])
                if fate[j] > own_fate + 1:
                    Xij = mirror.apart(X[i], X[j], mirror.sign(neigh0[k]), plane)
                    if dot(Xij, Xij) <= spread_radius * spread_radius:
                        own_fate = fate[j] - 1
        fate_next[i] = own_fate

    @wp.kernel(module=module)
    def convert(
        offset: wp.int32,
        # in:
        fate: wp.array[wp.int32],
        role: wp.array[wp.int32],
        # out:
        kernel_type: wp.array[wp.int32],
        changed: wp.array[real],
        unlisted: wp.array[wp.int32],
    ):
        """A Lagrangian particle of a fate becomes Eulerian for good and keeps its state (section 5).

        ``unlisted`` is set where its neighbours' rows are not at hand: they are rebuilt before the next step.
        """
        i = wp.tid() + offset
        if kernel_type[i] == LAGRANGIAN and fate[i] > 0:
            kernel_type[i] = wp.static(EULERIAN)
            changed[0] = one
            if role[i] < 2:
                unlisted[0] = 1

    @wp.kernel(module=module)
    def erode(
        offset: wp.int32,
        # in:
        D: wp.array[real],
        dt: wp.array[real],
        # out:
        kernel_type: wp.array[wp.int32],
        tau: wp.array[s.sym],
        sig: wp.array[s.sym],
        p: wp.array[real],
        changed: wp.array[real],
    ):
        """A failed particle, D >= 1, leaves all lists without stress; mass, velocity and energy stay (section 4, TLAG)."""
        i = wp.tid() + offset
        if dt[0] == zero or kernel_type[i] != LAGRANGIAN:
            return
        if D[i] >= one:
            kernel_type[i] = wp.static(ERODED)
            tau[i] = s.sym()
            sig[i] = s.sym()
            p[i] = zero
            changed[0] = one

    @wp.kernel(module=module)
    def interfaces(
        offset: wp.int32,
        # in:
        kernel_type: wp.array[wp.int32],
        changed: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        # out:
        interface: wp.array[wp.int32],
    ):
        """interface = 1: an Eulerian particle with a Lagrangian reference neighbour, which needs its F (section 5)."""
        i = wp.tid() + offset
        if changed[0] == zero:
            return
        found = wp.int32(0)
        if kernel_type[i] == EULERIAN:
            for k in range(start0[i], last_end(start0[i], n_neigh0[i]), stride):
                if kernel_type[mirror.index(neigh0[k])] == LAGRANGIAN:
                    found = 1
        interface[i] = found

    return ConversionKernels(begin, judge, spread, convert, erode, interfaces)
