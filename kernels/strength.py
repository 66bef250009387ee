"""Strength laws: flow stress, and the radial return onto the von Mises surface (method section 7)."""

import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import warp as wp

from .material import StrengthId, make_material
from .spec import Spec
from .tensor import make_tensor


class Strength(NamedTuple):
    """Device functions of this file.

    Attributes:
        flow_stress: ``(m: Material, ep) -> (Y [Pa], H [Pa])``, H = dY/dεp.
        return_map: ``(m: Material, tau_trial, ep) -> (tau [Pa], d_ep)``.
    """

    flow_stress: wp.Function
    return_map: wp.Function


def _fluid(real: type, Material: type) -> wp.Function:
    @wp.func
    def fluid(m: Material, ep: real):
        """Y = 0."""
        return real(0.0), real(0.0)

    return fluid


def _elastic(real: type, Material: type) -> wp.Function:
    infinity = real(math.inf)

    @wp.func
    def elastic(m: Material, ep: real):
        """Y = ∞."""
        return infinity, real(0.0)

    return elastic


def _perfectly_plastic(real: type, Material: type) -> wp.Function:
    @wp.func
    def perfectly_plastic(m: Material, ep: real):
        """Y constant."""
        return m.Y, real(0.0)

    return perfectly_plastic


def _linear_hardening(real: type, Material: type) -> wp.Function:
    @wp.func
    def linear_hardening(m: Material, ep: real):
        """Y + H εp."""
        return m.Y + m.H * ep, m.H

    return linear_hardening


LAWS: dict[StrengthId, Callable[[type, type], wp.Function]] = {
    StrengthId.FLUID: _fluid,
    StrengthId.ELASTIC: _elastic,
    StrengthId.PERFECTLY_PLASTIC: _perfectly_plastic,
    StrengthId.LINEAR_HARDENING: _linear_hardening,
}
"""Every strength law; a new one is one function above, one row here and one dataclass on the host."""


def _flow_stress(real: type, Material: type) -> wp.Function:
    ids = tuple(int(i) for i in LAWS)
    laws = tuple(make(real, Material) for make in LAWS.values())

    @wp.func
    def flow_stress(m: Material, ep: real):
        """Flow stress Y [Pa] of the material's own law at plastic strain εp, and its slope H = dY/dεp [Pa]."""
        Y, H = real(0.0), real(0.0)
        for k in range(wp.static(len(ids))):
            if m.strength == wp.static(ids[k]):
                Y, H = wp.static(laws[k])(m, ep)
        return Y, H

    return flow_stress


@functools.cache
def make_strength(s: Spec) -> Strength:
    """Build the functions for one specialisation."""
    real, mat, Material = s.real, s.mat, make_material(s)
    von_mises = make_tensor(s).von_mises
    flow_stress = _flow_stress(real, Material)
    fluid = int(StrengthId.FLUID)

    @wp.func
    def return_map(m: Material, tau_trial: mat, ep: real):
        """Scale τ back to the yield surface: Δεp = (q - Y)/(3G + H), q = √(3/2 τ:τ), τ = τ_trial (Y + H Δεp)/q.

        Exact for a flow stress that is linear in εp (Simo & Hughes 1998, section 3.3). A fluid keeps no τ.
        """
        if m.strength == fluid:
            return mat(real(0.0)), real(0.0)
        Y, H = flow_stress(m, ep)
        q = von_mises(tau_trial)
        if q <= Y:
            return tau_trial, real(0.0)
        d_ep = (q - Y) / (real(3.0) * m.G + H)
        return ((Y + H * d_ep) / q) * tau_trial, d_ep

    return Strength(flow_stress, return_map)
