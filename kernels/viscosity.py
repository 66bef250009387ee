"""Artificial viscosity of a pair, and the switches that scale it (method section 3)."""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec
from .tensor import make_tensor

MORRIS_MIN = 0.1
"""alpha_min of Morris & Monaghan (1997)."""

MORRIS_DECAY = 0.2
"""Decay of their coefficient: tau = h / (0.2 c)."""


class Viscosity(NamedTuple):
    """Device functions of this file."""

    approach: wp.Function
    pressure: wp.Function


@functools.cache
def make_viscosity(s: Spec) -> Viscosity:
    """Build the pair functions for one precision."""
    real = s.real

    @wp.func
    def approach(vx: real, r2: real, h: real):
        """mu_ab = h v_ab·x_ab / (r² + 0.01 h²) [m/s] where the pair approaches, else 0."""
        return wp.min(h * vx / (r2 + real(0.01) * h * h), real(0.0))

    @wp.func
    def pressure(mu: real, cs_bar: real, rho_bar: real, alpha: real, beta: real):
        """Π_ab = (-α c̄ mu + β mu²) / ρ̄ [Pa m⁶/kg²]; zero where mu = 0, never negative."""
        return (beta * mu - alpha * cs_bar) * mu / rho_bar

    return Viscosity(approach, pressure)


class Switches(NamedTuple):
    """Kernels that set the viscosity's switch from the velocity gradient."""

    balsara: wp.Kernel
    morris: wp.Kernel


@functools.cache
def make_switches(s: Spec) -> Switches:
    """Build the switch kernels for one specialisation."""
    real, mat = s.real, s.mat
    tensor = make_tensor(s)
    module = s.module(__name__)
    lowest, decay = real(MORRIS_MIN), real(MORRIS_DECAY)

    @wp.kernel(module=module)
    def balsara(
        offset: wp.int32,
        # in:
        dvdx: wp.array[mat],
        cs: wp.array[real],
        h: real,
        dt: wp.array[real],
        # out:
        av_switch: wp.array[real],
    ):
        """f = |div v| / (|div v| + |curl v| + 1e-4 c/h) [-] (Balsara 1995; section 3, BAL)."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        div = wp.abs(wp.trace(dvdx[i]))
        av_switch[i] = div / (div + tensor.curl(dvdx[i]) + real(1.0e-4) * cs[i] / h)

    @wp.kernel(module=module)
    def morris(
        offset: wp.int32,
        # in:
        dvdx: wp.array[mat],
        cs: wp.array[real],
        h: real,
        dt: wp.array[real],
        # out:
        av_switch: wp.array[real],
    ):
        """dα/dt = -(α - α_min) 0.2 c/h + max(-div v, 0), decay implicit in time (Morris & Monaghan 1997; MON)."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        rate = decay * cs[i] / h
        source = wp.max(-wp.trace(dvdx[i]), real(0.0))
        av_switch[i] = (av_switch[i] + dt[0] * (rate * lowest + source)) / (real(1.0) + dt[0] * rate)

    return Switches(balsara, morris)
