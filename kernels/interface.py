"""The interface between the two particles of a pair: a Riemann problem that knows what carries no tension."""

import functools

import warp as wp

from .riemann import make_riemann, make_riemann_state
from .spec import Spec

CLOSEST = 1e-6
"""Distance in h below which the direction of a pair fades: particles that meet have none, and no force either."""


@functools.cache
def make_interface(s: Spec, riemann: str) -> tuple[wp.Function, wp.Function]:
    """Build ``side(u, p, rho, c, A)``, one side of the problem, and ``interface(left, right, bears)``, its solution."""
    real = s.real
    State, solve = make_riemann_state(s), make_riemann(s, riemann)

    @wp.func
    def side(u: real, p: real, rho: real, c: real, A: real):
        """One side of the Riemann problem."""
        state = State()
        state.u = u
        state.p = p
        state.rho = rho
        state.c = c
        state.A = A
        return state

    @wp.func
    def interface(left: State, right: State, bears: wp.bool):
        """u* and p*; no p* < 0 where one of both bears no tension (Connolly et al. 2013, Algorithm 1)."""
        u, p = solve(left, right)
        if not bears:
            p = wp.max(p, real(0.0))
        return u, p

    return side, interface
