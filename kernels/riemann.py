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
    def proper(S: State, lowest: real, k: real, gap: real):
        """Velocity jump w of a side whose wave is proper: p + (Z + ρ A w) w = lowest - k (gap - w)².

        On the right-hand side is the other one, beyond its vertex: ``lowest`` the pressure there, k its ρ A.
        """
        k0 = lowest - S.p - k * gap * gap
        k1 = S.rho * S.c - two * k * gap
        k2 = S.rho * S.A + k
        d = wp.sqrt(wp.max(k1 * k1 + four * k2 * k0, zero))
        if k1 > zero:
            return two * k0 / (k1 + d)
        return half * (d - k1) / k2

    @wp.func
    def beyond(a: real, b: real, gap: real, drop: real):
        """How far a side is beyond its vertex where both are: y >= 0 of a (gap - y)² - b y² = drop, b its own ρ A."""
        k0, k1 = a * gap * gap - drop, a * gap
        return k0 / (k1 + wp.sqrt(wp.max(k1 * k1 + (b - a) * k0, zero)))

    @wp.func
    def expanding(left: State, right: State):
        """u* - u_R where at least one side is beyond its vertex."""
        a, b = left.rho * left.A, right.rho * right.A
        W_l, W_r = reach(left), reach(right)
        lowest_l, lowest_r = curve(left, -W_l), curve(right, -W_r)
        jump = left.u - right.u
        left_beyond = curve(right, jump + W_l) < lowest_l
        right_beyond = curve(left, jump + W_r) < lowest_r
        x = -W_r  # at the vertex, unless it is beyond
        if left_beyond and right_beyond:
            x = -(beyond(a, b, -(jump + W_l + W_r), lowest_l - lowest_r) + W_r)
        elif left_beyond:
            x = proper(right, lowest_l, a, jump + W_l)
        elif right_beyond:
            x = jump - proper(left, lowest_r, b, jump + W_r)
        return x

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
        k0 = left.p - right.p + (Z_l + a * jump) * jump
        k1 = (
            Z_r + Z_l + two * a * jump
        )  # (b - a) x² + k1 x = k0, for the root where the curves cross as they should
        x = two * k0 / (k1 + wp.sqrt(k1 * k1 + four * (b - a) * k0))  # not a number where they do not
        y = jump - x
        p = half * ((right.p + (Z_r + b * x) * x) + (left.p + (Z_l + a * y) * y))
        if not (two * right.A * x + right.c >= zero and two * left.A * y + left.c >= zero):
            x = expanding(left, right)
            p = half * (curve(right, x) + curve(left, jump - x))
        return right.u + x, p

    return two_shock


SOLVERS: dict[str, Callable[[type, type], wp.Function]] = {"acoustic": _acoustic, "two-shock": _two_shock}
"""Every solver by its name in `warpsph.config`."""


@functools.cache
def make_riemann(s: Spec, name: str) -> wp.Function:
    """Build a solver by its name."""
    return SOLVERS[name](s.real, make_riemann_state(s))
