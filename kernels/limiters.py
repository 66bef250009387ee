"""Slope limiters (method section 10; Connolly et al. 2013, Eq. 27).

With φ(r)/r = φ(1/r) the limited slope φ(r_a) ΔQ_a of two slopes a and b, r_a = b/a, is symmetric: it is written here
as one function of both, which divides by nothing. It is 0 where the slopes differ in sign.
"""

import functools
from collections.abc import Callable

import warp as wp

from .spec import Spec


def _sweby(real: type) -> wp.Function:
    @wp.func
    def sweby(low: real, high: real, beta: real):
        """min(β low, high); β = 1 minmod, 2 superbee."""
        return wp.where(beta * low < high, beta * low, high)

    return sweby


def _mc(real: type) -> wp.Function:
    @wp.func
    def mc(low: real, high: real, beta: real):
        """min(2 low, (low + high)/2) (monotonised central)."""
        steep, central = real(2.0) * low, real(0.5) * (low + high)
        return wp.where(steep < central, steep, central)

    return mc


def _vanleer(real: type) -> wp.Function:
    @wp.func
    def vanleer(low: real, high: real, beta: real):
        """2 low high/(low + high) (van Leer); only asked where neither is 0."""
        return real(2.0) * low * (high / (low + high))

    return vanleer


LIMITERS: dict[str, tuple[Callable[[type], wp.Function], float | None]] = {
    "superbee": (_sweby, 2.0),
    "minmod": (_sweby, 1.0),
    "sweby": (_sweby, None),
    "mc": (_mc, None),
    "vanleer": (_vanleer, None),
}
"""Function of the smaller and the larger magnitude, and fixed β if it has one, of every limiter by its name in `warpsph.config`."""


@functools.cache
def make_limiter(s: Spec, name: str, jump: bool) -> wp.Function:
    """Build ``limited(a, b, d, beta)``: the slope that both sides of a pair use.

    Args:
        s: Specialisation.
        name: One of `LIMITERS`.
        jump: Bound the slope by the pair's own difference d = (Q_a - Q_b)/r too: the two reconstructed states then
            never cross.
    """
    real = s.real
    make, fixed = LIMITERS[name]
    magnitude = make(real)
    zero = real(0.0)

    @wp.func
    def limited(a: real, b: real, d: real, beta: real):
        """Limited slope of the slopes a and b, without branches: their signs are as good as random to a processor."""
        x, y, bound = wp.abs(a), wp.abs(b), beta
        if wp.static(fixed is not None):
            bound = real(wp.static(fixed or 0.0))
        slope = magnitude(wp.where(x < y, x, y), wp.where(x < y, y, x), bound)
        agree = a * b > zero
        if wp.static(jump):
            agree = agree and a * d > zero
            slope = wp.where(slope < wp.abs(d), slope, wp.abs(d))
        return wp.where(agree, wp.copysign(slope, a), zero)

    return limited
