"""Riemann solvers of a pair: the state at the interface between a left and a right one (method section 10).

Each is a device function ``(left: RiemannState, right: RiemannState) -> (u* [m/s], p* [Pa])`` with u along the
direction from left to right. Swapping the sides and the signs of u gives -u* and the same p*.
"""

import functools
from collections.abc import Callable

import warp as wp

from .spec import Spec


@functools.cache
def _riemann_state(real: type) -> type:
    """Build the struct of one precision."""

    @wp.struct
    class RiemannState:
        """One side of a Riemann problem."""

        u: real  # velocity along the direction from left to right [m/s]
        p: real  # pressure, or minus the normal stress [Pa]
        rho: real  # density [kg/m^3]
        c: real  # wave speed [m/s]
        A: real  # slope of the shock velocity, Us = c + A |u* - u|

    return RiemannState


def make_riemann_state(s: Spec) -> type:
    """Give the struct of one specialisation; specialisations of one precision share it."""
    return _riemann_state(s.real)


def _acoustic(real: type, State: type) -> wp.Function:
    @wp.func
    def acoustic(left: State, right: State):
        """Linear waves of impedance Z = ρ c: p* = (Z_R p_L + Z_L p_R + Z_L Z_R (u_L - u_R))/(Z_L + Z_R)."""
        Z_l, Z_r = left.rho * left.c, right.rho * right.c
        Z = real(1.0) / (Z_l + Z_r)
        u = (Z_l * left.u + Z_r * right.u + (left.p - right.p)) * Z
        p = (Z_r * left.p + Z_l * right.p + Z_l * Z_r * (left.u - right.u)) * Z
        return u, p

    return acoustic


def _two_shock(real: type, State: type) -> wp.Function:
    zero, half, two, four = real(0.0), real(0.5), real(2.0), real(4.0)

    @wp.func
    def reach(S: State):
        """Velocity jump c/(2 A) at which an expansion comes to the vertex of its parabola."""
        return half * S.c / S.A

    @wp.func
    def curve(S: State, w: real):
        """Pressure behind a wave of velocity jump w, positive in compression: p + ρ (c + A w) w down to the vertex."""
        below = wp.min(w + reach(S), zero)
        return S.p + S.rho * ((S.c + S.A * w) * w - two * S.A * below * below)

    @wp.func
    def beyond(left: State, right: State, a: real, b: real):
        """u* - u_R where a side expands beyond its vertex: there a or b, ± ρ A, is negative."""
        W_r = reach(right)
        gap = left.u - right.u + reach(left) + W_r
        # b y² + P_r = a (gap - y)² + P_l for y = u - U_r, with P the pressures and U the velocities at the vertices
        k0 = (
            left.p
            - half * left.rho * left.c * reach(left)
            - right.p
            + half * right.rho * right.c * W_r
            + a * gap * gap
        )
        k1, k2 = two * a * gap, b - a
        d = wp.sqrt(wp.max(k1 * k1 + four * k2 * k0, zero))
        q = k1 + d
        if k1 < zero:
            q = k1 - d
        first, second = zero, zero
        if q != zero:
            first = two * k0 / q
        if k2 != zero:
            second = -half * q / k2
        x_1, x_2 = first - W_r, second - W_r
        jump = left.u - right.u
        miss_1 = wp.abs(curve(right, x_1) - curve(left, jump - x_1))
        miss_2 = wp.abs(curve(right, x_2) - curve(left, jump - x_2))
        if miss_2 < miss_1:
            return x_2
        return x_1

    @wp.func
    def two_shock(left: State, right: State):
        """Both waves as shocks, p* = p + ρ (c + A w) w with w the velocity jump (Dukowicz 1985).

        Exact for shocks into the reference state where Us = c0 + S up and A = S. An expansion follows the same
        parabola to its vertex w = -c/(2 A), and beyond it the parabola turned over. Solved for the right side's jump,
        so that weak waves lose no digits: for them it is the acoustic solver.
        """
        a, b = left.rho * left.A, right.rho * right.A
        Z_l, Z_r = left.rho * left.c, right.rho * right.c
        jump = left.u - right.u
        W_l, W_r = reach(left), reach(right)
        x = zero
        # u* lies before the left vertex and behind the right one: both waves are on the parabolas proper
        if curve(right, jump + W_l) >= curve(left, -W_l) and curve(right, -W_r) <= curve(left, jump + W_r):
            k0 = left.p - right.p + (Z_l + a * jump) * jump  # (b - a) x² + k1 x = k0
            k1 = Z_r + Z_l + two * a * jump
            x = two * k0 / (k1 + wp.sqrt(wp.max(k1 * k1 + four * (b - a) * k0, zero)))
        else:
            if curve(right, jump + W_l) < curve(left, -W_l):
                a = -a
            if curve(right, -W_r) > curve(left, jump + W_r):
                b = -b
            x = beyond(left, right, a, b)
        return right.u + x, half * (curve(right, x) + curve(left, jump - x))

    return two_shock


SOLVERS: dict[str, Callable[[type, type], wp.Function]] = {"acoustic": _acoustic, "two-shock": _two_shock}
"""Every solver by its name in `warpsph.config`."""


@functools.cache
def make_riemann(s: Spec, name: str) -> wp.Function:
    """Build a solver by its name."""
    return SOLVERS[name](s.real, make_riemann_state(s))
