"""Strength laws: flow stress, the radial return onto the von Mises surface, plastic heat (method section 7).

A law whose flow stress is linear in the plastic strain εp is a device function ``(m: Material, ep) -> (Y [Pa], H [Pa])``,
H = dY/dεp. Any other is ``(m: Material, ep, rate, soft, p, D) -> (Y [Pa], H [Pa], S [Pa])`` of the plastic strain, its rate
[1/s], the factor of thermal softening, the pressure p [Pa] and the damage D; S = dY/d ln(rate).
"""

import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import warp as wp

from .material import FIRST_NONLINEAR, StrengthId, make_material
from .spec import Spec
from .tensor import make_tensor

MAX_ITERATIONS = 40
"""Most steps of the iteration for Δεp; it needs that many only for a stress that exceeds Y by nothing at εp = 0."""

ROUNDING = 16.0
"""The iteration ends where the stress is off the yield surface by this many rounding units of the trial stress."""


class Strength(NamedTuple):
    """Device functions of this file.

    Attributes:
        flow_stress: ``(m: Material, ep, rate, T, p, D) -> Y [Pa]``.
        linear_return: ``(m: Material, tau_trial, ep) -> (tau [Pa], d_ep)`` of a law before `FIRST_NONLINEAR`.
        nonlinear_return: ``(m: Material, tau_trial, ep, T, p, D, dt) -> (tau [Pa], d_ep)`` of any other.
        warming: ``(m: Material, tau, d_ep, rho) -> dT [K]`` of plastic work.
    """

    flow_stress: wp.Function
    linear_return: wp.Function
    nonlinear_return: wp.Function
    warming: wp.Function


@functools.cache
def make_rate_factor(s: Spec) -> wp.Function:
    """Build the factor that Johnson-Cook and Johnson-Holmquist share."""
    return _rate_factor(s.real, make_material(s))


@functools.cache
def _rate_factor(real: type, Material: type) -> wp.Function:
    @wp.func
    def rate_factor(m: Material, C: real, rate: real):
        """1 + C ln max(ε̇/ε̇0, 1), and its slope in ln ε̇."""
        if rate <= m.rate0:
            return real(1.0), real(0.0)
        return real(1.0) + C * wp.log(rate / m.rate0), C

    return rate_factor


@functools.cache
def make_homologous(s: Spec) -> wp.Function:
    """Build the homologous temperature T*."""
    return _homologous(s.real, make_material(s))


@functools.cache
def _homologous(real: type, Material: type) -> wp.Function:
    @wp.func
    def homologous(m: Material, T: real):
        """T* = (T - T0)/(Tm - T0), from 0 to 1 at the melting point."""
        return wp.clamp((T - m.T0) / (m.Tm - m.T0), real(0.0), real(1.0))

    return homologous


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


def _johnson_cook(real: type, Material: type) -> wp.Function:
    rate_factor = _rate_factor(real, Material)
    tiny, zero = real(1e-30), real(0.0)

    @wp.func
    def johnson_cook(m: Material, ep: real, rate: real, soft: real, p: real, D: real):
        """(A + B εpⁿ)(1 + C ln max(ε̇/ε̇0, 1))(1 - T*ᵐ) (Johnson & Cook 1983); 0 where failure takes the shear strength."""
        hardening = m.B * wp.pow(ep, m.n)
        R, slope = rate_factor(m, m.C, rate)
        if D >= m.D_shear:
            soft = zero
        slow = (m.A + hardening) * soft
        H = m.n * hardening / wp.max(ep, tiny) * R * soft  # of εp = 0, where it may be infinite: 0
        return slow * R, H, slow * slope

    return johnson_cook


def _johnson_holmquist_1(real: type, Material: type) -> wp.Function:
    rate_factor = _rate_factor(real, Material)
    zero, one = real(0.0), real(1.0)

    @wp.func
    def johnson_holmquist_1(m: Material, ep: real, rate: real, soft: real, p: real, D: real):
        """Lines through (T, 0), (P1, s1), (P2, s2), constant beyond; failed (D = 1): min(cf P, sf_max) for P > 0, else 0.

        Both times 1 + C ln max(ε̇/ε̇0, 1) (Johnson & Holmquist 1991).
        """
        Y = real(m.s2)
        if p < m.P1:
            Y = m.s1 * wp.max((p - m.P_T) / (m.P1 - m.P_T), zero)
        elif p < m.P2:
            Y = m.s1 + (m.s2 - m.s1) * ((p - m.P1) / (m.P2 - m.P1))
        if D >= one:
            Y = wp.min(m.cf * wp.max(p, zero), m.sf_max)
        R, slope = rate_factor(m, m.C, rate)
        return Y * R, zero, Y * slope

    return johnson_holmquist_1


LINEAR: dict[StrengthId, Callable[[type, type], wp.Function]] = {
    StrengthId.FLUID: _fluid,
    StrengthId.ELASTIC: _elastic,
    StrengthId.PERFECTLY_PLASTIC: _perfectly_plastic,
    StrengthId.LINEAR_HARDENING: _linear_hardening,
}
"""Every law that is linear in εp; a new one is one function above, one row here and one dataclass on the host."""

NONLINEAR: dict[StrengthId, Callable[[type, type], wp.Function]] = {
    StrengthId.JOHNSON_COOK: _johnson_cook,
    StrengthId.JOHNSON_HOLMQUIST_1: _johnson_holmquist_1,
}
"""Every other law, likewise; their ids are higher."""


@functools.cache
def _softening(real: type, Material: type) -> wp.Function:
    homologous = _homologous(real, Material)
    one, law = real(1.0), int(StrengthId.JOHNSON_COOK)

    @wp.func
    def softening(m: Material, T: real):
        """1 - T*ᵐ of Johnson-Cook, 1 of the other laws. Apart, as T is the same for every trial of a step."""
        if m.strength == law and T > m.T0:
            return one - wp.pow(homologous(m, T), m.m)
        return one

    return softening


@functools.cache
def _linear_flow(real: type, Material: type) -> wp.Function:
    ids = tuple(int(i) for i in LINEAR)
    laws = tuple(make(real, Material) for make in LINEAR.values())

    @wp.func
    def linear_flow(m: Material, ep: real):
        """Flow stress Y [Pa] of the material's own linear law at plastic strain εp, and its slope H = dY/dεp [Pa]."""
        Y, H = real(0.0), real(0.0)
        for k in range(wp.static(len(ids))):
            if m.strength == wp.static(ids[k]):
                Y, H = wp.static(laws[k])(m, ep)
        return Y, H

    return linear_flow


@functools.cache
def _nonlinear_flow(real: type, Material: type) -> wp.Function:
    ids = tuple(int(i) for i in NONLINEAR)
    laws = tuple(make(real, Material) for make in NONLINEAR.values())

    @wp.func
    def nonlinear_flow(m: Material, ep: real, rate: real, soft: real, p: real, D: real):
        """Flow stress Y [Pa] of the material's own other law, its slopes dY/dεp and dY/d ln(rate) [Pa]."""
        Y, H, S = real(0.0), real(0.0), real(0.0)
        for k in range(wp.static(len(ids))):
            if m.strength == wp.static(ids[k]):
                Y, H, S = wp.static(laws[k])(m, ep, rate, soft, p, D)
        return Y, H, S

    return nonlinear_flow


@functools.cache
def _plastic_increment(real: type, Material: type) -> wp.Function:
    flow_stress = _nonlinear_flow(real, Material)
    zero, half, three = real(0.0), real(0.5), real(3.0)
    tolerance = real(ROUNDING * (2.0**-52 if real is wp.float64 else 2.0**-23))

    @wp.func
    def plastic_increment(m: Material, q: real, Y_0: real, ep: real, soft: real, p: real, D: real, dt: real):
        """Root x = Δεp of q - 3 G x = Y(εp + x, x/dt), and Y there; Y_0 < q is the flow stress at x = 0.

        Y grows with x, so the root lies between 0 and (q - Y_0)/3G. Newton's method in ln x from there: as a function
        of ln x both 3 G x and Y are convex, the kink at the reference rate and εpⁿ at εp = 0 included, so it comes
        down on the root without overshoot, in 3 to 8 steps. A bisection where rounding throws it out of the bracket.
        """
        low, high = real(0.0), (q - Y_0) / (three * m.G)
        x, trial, Y = real(high), real(high), real(Y_0)
        for _k in range(wp.static(MAX_ITERATIONS)):
            x = trial
            Y, H, S = flow_stress(m, ep + x, x / dt, soft, p, D)
            miss = q - Y - three * m.G * x
            if wp.abs(miss) <= tolerance * q:
                break
            if miss > zero:
                low = x
            else:
                high = x
            trial = x * wp.exp(miss / ((three * m.G + H) * x + S))
            if not (trial > low and trial < high):
                trial = half * (low + high)
            if trial == x:
                break
        return x, Y

    return plastic_increment


@functools.cache
def make_strength(s: Spec) -> Strength:
    """Build the functions for one specialisation."""
    real, mat, Material = s.real, s.mat, make_material(s)
    von_mises = make_tensor(s).von_mises
    linear_flow, nonlinear_flow = _linear_flow(real, Material), _nonlinear_flow(real, Material)
    softening, plastic_increment = _softening(real, Material), _plastic_increment(real, Material)
    fluid, metal, nonlinear = int(StrengthId.FLUID), int(StrengthId.JOHNSON_COOK), int(FIRST_NONLINEAR)

    @wp.func
    def flow_stress(m: Material, ep: real, rate: real, T: real, p: real, D: real):
        """Flow stress Y [Pa] of the material's own law."""
        if m.strength < nonlinear:
            Y, _H = linear_flow(m, ep)
            return Y
        Y, _H, _S = nonlinear_flow(m, ep, rate, softening(m, T), p, D)
        return Y

    @wp.func
    def linear_return(m: Material, tau_trial: mat, ep: real):
        """Scale τ back to the yield surface: Δεp = (q - Y)/(3G + H), q = √(3/2 τ:τ), τ = τ_trial (Y + H Δεp)/q.

        Exact (Simo & Hughes 1998, section 3.3). A fluid keeps no τ.
        """
        if m.strength == fluid:
            return mat(real(0.0)), real(0.0)
        Y, H = linear_flow(m, ep)
        q = von_mises(tau_trial)
        if q <= Y:
            return tau_trial, real(0.0)
        d_ep = (q - Y) / (real(3.0) * m.G + H)
        return ((Y + H * d_ep) / q) * tau_trial, d_ep

    @wp.func
    def nonlinear_return(m: Material, tau_trial: mat, ep: real, T: real, p: real, D: real, dt: real):
        """The same for Y(εp + Δεp, Δεp/dt) = q - 3G Δεp, at the T, p and D given."""
        soft, q = softening(m, T), von_mises(tau_trial)
        # elastic even if it never hardened: no power
        if m.strength == metal and D < m.D_shear and q <= m.A * soft:
            return tau_trial, real(0.0)
        Y_0, _H, _S = nonlinear_flow(m, ep, real(0.0), soft, p, D)
        if q <= Y_0:
            return tau_trial, real(0.0)
        d_ep, Y = plastic_increment(m, q, Y_0, ep, soft, p, D, dt)
        return (Y / q) * tau_trial, d_ep

    @wp.func
    def warming(m: Material, tau: mat, d_ep: real, rho: real):
        """Temperature rise of adiabatic plastic flow, χ q Δεp/(ρ Cv), q of the τ after it; 0 without a heat capacity."""
        if m.Cv > real(0.0) and d_ep > real(0.0):
            return m.chi * von_mises(tau) * d_ep / (rho * m.Cv)
        return real(0.0)

    return Strength(flow_stress, linear_return, nonlinear_return, warming)
