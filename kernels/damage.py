"""Damage laws: D grows with plastic strain over the strain to failure, D' = min(D + Δεp/ε_f, 1).

Each law is a device function ``(m: Material, rate, T, p, q) -> ε_f`` of the plastic strain rate [1/s], the temperature
T [K], the pressure p [Pa] and the von Mises stress q [Pa].
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import warp as wp

from .material import DamageId, make_material
from .spec import Spec
from .strength import make_homologous, make_rate_factor
from .tensor import make_tensor

EPS_F_MIN = 1e-6
"""Lowest strain to failure of the Johnson-Cook law."""

MAX_EXPONENT = 80.0
"""Largest exponent of the Johnson-Cook law: its exponential is as good as infinite, and still a float32."""


class Damage(NamedTuple):
    """Device functions of this file.

    Attributes:
        tension: ``(m: Material, D, p) -> D'``, which is 1 where the pressure alone fails the material.
        growth: ``(m: Material, D, d_ep, rate, T, p, tau) -> D'``.
        pressure: ``(m: Material, D, p) -> p [Pa]`` that the material carries.
    """

    tension: wp.Function
    growth: wp.Function
    pressure: wp.Function


@functools.cache
def make_damage(s: Spec) -> Damage:
    """Build the functions for one specialisation."""
    real, Material = s.real, make_material(s)
    zero, one = real(0.0), real(1.0)
    von_mises, mat = make_tensor(s).von_mises, s.mat
    none, ceramic = int(DamageId.NONE), int(DamageId.JOHNSON_HOLMQUIST_1)
    ids = tuple(int(i) for i in LAWS)
    laws = tuple(make(s) for make in LAWS.values())

    @wp.func
    def tension(m: Material, D: real, p: real):
        """A ceramic fails at once where P <= T."""
        if m.damage == ceramic and p <= m.P_T:
            return one
        return D

    @wp.func
    def growth(m: Material, D: real, d_ep: real, rate: real, T: real, p: real, tau: mat):
        """D' = min(D + Δεp/ε_f, 1), never less than D; p and τ as they are after the flow."""
        if m.damage == none or d_ep <= zero or D >= one:
            return D
        q = von_mises(tau)
        for k in range(wp.static(len(ids))):
            if m.damage == wp.static(ids[k]):
                eps_f = wp.static(laws[k])(m, rate, T, p, q)
                if d_ep >= (one - D) * eps_f:  # no division: ε_f may be 0
                    return one
                return D + d_ep / eps_f
        return D

    @wp.func
    def pressure(m: Material, D: real, p: real):
        """p, but no tension where the material has lost it (Connolly et al. 2013, Algorithm 1)."""
        if D >= m.D_tension:
            return wp.max(p, zero)
        return p

    return Damage(tension, growth, pressure)


def _johnson_cook(s: Spec) -> wp.Function:
    real, Material = s.real, make_material(s)
    rate_factor, homologous = make_rate_factor(s), make_homologous(s)
    one = real(1.0)
    floor, steepest, small = real(EPS_F_MIN), real(MAX_EXPONENT), real(1e-6)

    @wp.func
    def johnson_cook(m: Material, rate: real, T: real, p: real, q: real):
        """ε_f = (D1 + D2 exp(D3 σ*))(1 + D4 ln max(ε̇/ε̇0, 1))(1 + D5 T*), σ* = -p/q (Johnson & Cook 1985).

        Tension, σ* > 0, makes it small (D3 is negative in the literature). Where q vanishes it is held at 1e-6 G.
        """
        triaxiality = -p / wp.max(q, small * m.G)
        brittle = m.D1 + m.D2 * wp.exp(wp.min(m.D3 * triaxiality, steepest))
        R, _ = rate_factor(m, m.D4, rate)
        return wp.max(brittle * R * (one + m.D5 * homologous(m, T)), floor)

    return johnson_cook


def _johnson_holmquist_1(s: Spec) -> wp.Function:
    real, Material = s.real, make_material(s)

    @wp.func
    def johnson_holmquist_1(m: Material, rate: real, T: real, p: real, q: real):
        """ε_f: a line from 0 at P = T to ε_f,max at P_max, constant beyond (Johnson & Holmquist 1991)."""
        return m.eps_f_max * wp.clamp((p - m.P_T) / (m.P_max - m.P_T), real(0.0), real(1.0))

    return johnson_holmquist_1


LAWS: dict[DamageId, Callable[[Spec], wp.Function]] = {
    DamageId.JOHNSON_COOK: _johnson_cook,
    DamageId.JOHNSON_HOLMQUIST_1: _johnson_holmquist_1,
}
"""Every damage law; a new one is one function above, one row here and one dataclass on the host."""
