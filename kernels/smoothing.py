"""Smoothing kernels W(r, h) of method section 1, normalised in one, two and three dimensions."""

import functools
import math
from typing import NamedTuple

import warp as wp

from .spec import Spec

GAUSSIAN_CUT = 3.0 * (1.0 - 1.0e-6)
"""Where the Gaussian ends, in h. It jumps there: a little less than 3, so that no distance of a lattice is on the edge."""


class Smoothing(NamedTuple):
    """The two device functions an SPH sum needs, and the support.

    Attributes:
        name: Name of the kernel.
        w: W(r, h) [1/m^dim].
        dw_r: (dW/dr)/r [1/m^(dim+2)]: finite at r = 0, and ∇W = dw_r x_ij.
        support: Support radius in units of h.
    """

    name: str
    w: wp.Function
    dw_r: wp.Function
    support: float


def _gaussian_norm(dim: int, cut: float) -> float:
    """1 / ∫ exp(-q²) over |q| < cut: the cut-off Gaussian still integrates to one."""
    inside = {
        1: math.sqrt(math.pi) * math.erf(cut),
        2: math.pi * (1.0 - math.exp(-(cut**2))),
        3: math.pi**1.5 * math.erf(cut) - 2.0 * math.pi * cut * math.exp(-(cut**2)),
    }
    return 1.0 / inside[dim]


def _cubic_spline(s: Spec):
    real = s.real

    @wp.func
    def shape(q: real):
        t = wp.max(real(2.0) - q, real(0.0))
        u = wp.max(real(1.0) - q, real(0.0))
        return real(0.25) * t * t * t - u * u * u

    @wp.func
    def slope_q(q: real):
        # without a branch at q = 1: pairs take either side at random
        t = wp.max(real(2.0) - q, real(0.0))
        u = wp.max(real(1.0) - q, real(0.0))
        return (real(3.0) * u * u - real(0.75) * t * t) / wp.max(q, real(1.0e-6))

    sigma = {1: 2.0 / 3.0, 2: 10.0 / (7.0 * math.pi), 3: 1.0 / math.pi}
    return shape, slope_q, sigma[s.dim], 2.0


def _quintic_spline(s: Spec):
    real = s.real

    @wp.func
    def pow4(t: real):
        return t * t * t * t

    @wp.func
    def shape(q: real):
        a = wp.max(real(3.0) - q, real(0.0))
        b = wp.max(real(2.0) - q, real(0.0))
        c = wp.max(real(1.0) - q, real(0.0))
        return pow4(a) * a - real(6.0) * pow4(b) * b + real(15.0) * pow4(c) * c

    @wp.func
    def slope_q(q: real):
        if q < real(1.0):
            return -real(120.0) + real(120.0) * q * q - real(50.0) * q * q * q
        a = wp.max(real(3.0) - q, real(0.0))
        b = wp.max(real(2.0) - q, real(0.0))
        return (real(30.0) * pow4(b) - real(5.0) * pow4(a)) / q

    sigma = {1: 1.0 / 120.0, 2: 7.0 / (478.0 * math.pi), 3: 1.0 / (120.0 * math.pi)}
    return shape, slope_q, sigma[s.dim], 3.0


def _wendland_c2(s: Spec):
    real = s.real

    # in one dimension the Wendland functions of the same smoothness have another polynomial
    @wp.func
    def shape_1d(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return t * t * t * (real(1.5) * q + real(1.0))

    @wp.func
    def slope_1d(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return -real(3.0) * t * t

    @wp.func
    def shape(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return t * t * t * t * (real(2.0) * q + real(1.0))

    @wp.func
    def slope_q(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return -real(5.0) * t * t * t

    if s.dim == 1:
        return shape_1d, slope_1d, 5.0 / 8.0, 2.0
    return shape, slope_q, {2: 7.0 / (4.0 * math.pi), 3: 21.0 / (16.0 * math.pi)}[s.dim], 2.0


def _wendland_c4(s: Spec):
    real = s.real
    c2, c1 = real(35.0 / 12.0), real(14.0 / 3.0)  # out here: Warp divides literals in single precision

    @wp.func
    def shape_1d(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return t * t * t * t * t * (real(2.0) * q * q + real(2.5) * q + real(1.0))

    @wp.func
    def slope_1d(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return -real(3.5) * t * t * t * t * (real(2.0) * q + real(1.0))

    @wp.func
    def shape(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        t3 = t * t * t
        return t3 * t3 * (c2 * q * q + real(3.0) * q + real(1.0))

    @wp.func
    def slope_q(q: real):
        t = wp.max(real(1.0) - real(0.5) * q, real(0.0))
        return -c1 * t * t * t * t * t * (real(2.5) * q + real(1.0))

    if s.dim == 1:
        return shape_1d, slope_1d, 3.0 / 4.0, 2.0
    return shape, slope_q, {2: 9.0 / (4.0 * math.pi), 3: 495.0 / (256.0 * math.pi)}[s.dim], 2.0


def _gaussian(s: Spec):
    real = s.real
    cut = real(GAUSSIAN_CUT)

    @wp.func
    def shape(q: real):
        if q < cut:
            return wp.exp(-q * q)
        return real(0.0)

    @wp.func
    def slope_q(q: real):
        if q < cut:
            return -real(2.0) * wp.exp(-q * q)
        return real(0.0)

    return shape, slope_q, _gaussian_norm(s.dim, GAUSSIAN_CUT), GAUSSIAN_CUT


_SHAPES = {
    "cubic_spline": _cubic_spline,
    "quintic_spline": _quintic_spline,
    "wendland_c2": _wendland_c2,
    "wendland_c4": _wendland_c4,
    "gaussian": _gaussian,
}
"""Factories of (w(q), w'(q)/q, normalisation, support) by name; q = r/h."""


@functools.cache
def make_smoothing(s: Spec, name: str) -> Smoothing:
    """Build one smoothing kernel: W = σ/h^d w(r/h) and (dW/dr)/r = σ/h^(d+2) w'(q)/q (section 1)."""
    shape, slope_q, sigma, support = _SHAPES[name](s)
    real, dim = s.real, s.dim
    norm = real(sigma)

    @wp.func
    def power(h: real):
        out = real(1.0)
        for _k in range(wp.static(dim)):
            out *= h
        return out

    @wp.func
    def w(r: real, h: real):
        """W(r, h) [1/m^d]."""
        return norm / power(h) * shape(r * (real(1.0) / h))

    @wp.func
    def dw_r(r: real, h: real):
        """(dW/dr)/r [1/m^(d+2)]."""
        return norm / (power(h) * h * h) * slope_q(r * (real(1.0) / h))

    return Smoothing(name, w, dw_r, support)
