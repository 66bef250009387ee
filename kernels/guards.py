"""What a run watches for: how many particles are in trouble of each kind, and which one is worst."""

import functools

import warp as wp

from .lanes import make_lanes
from .spec import Spec

GUARDS = ("state", "density", "domain", "interpenetration", "neighbours", "inverted", "energy_error")
"""Kinds of trouble, in the order of the columns: a state that is not finite [1 if so], -ρ [kg/m³], distance from the
domain [m], share of the kernel in other bodies [1], neighbours, times that F was not physical. The last only names the
particle with the most energy [J]: the sums tell whether energy is conserved."""

SUMS = ("kinetic", "internal", "work")
"""Columns in front of them, added up over blocks: m v²/2, m e, work of constraints [J]."""

FINDINGS = ("particles", "worst", "index")
"""Columns of each kind: particles beyond the limit, the largest value, the first particle in memory that has it."""

COLUMNS = len(SUMS) + len(FINDINGS) * len(GUARDS)
"""Numbers of a block."""

CONTACT, LAGRANGIAN, CONSTRAINED = 1, 2, 4
"""Bits of what a run has; it has no arrays of the rest."""

NO_DENSITY = -1.0e-300
"""Limit of -ρ [kg/m³]: a density of zero is beyond it."""


@functools.cache
def make_guards(s: Spec) -> wp.Kernel:
    """Build the kernel for one precision; it is the same for every scheme."""
    real, vec, point, matrix = s.real, s.vec, s.point, s.mat
    d = wp.float64
    finite = make_lanes(s).finite
    Found, speeds = wp.types.vector(len(FINDINGS), d), wp.types.vector(3, d)
    zero, one, half, lowest, no_density = d(0.0), d(1.0), d(0.5), d(-1.0e300), d(NO_DENSITY)
    n_sums, n_findings = len(SUMS), len(FINDINGS)
    state, density, domain, interpenetration, neighbours, turned, energetic = range(len(GUARDS))

    @wp.func
    def nothing():
        """What has been found among no particles."""
        return Found(zero, lowest, -one)

    @wp.func
    def noted(found: Found, value: d, limit: d, i: wp.int32):
        """The findings so far with those of one more particle."""
        if value > limit:
            found[0] = found[0] + one
        if value > found[1]:
            found[1] = value
            found[2] = d(i)
        return found

    @wp.func
    def outside(x: point, low: point, high: point):
        """Distance from the domain along the axis where it is largest [m]; negative inside."""
        far = lowest
        for c in range(3):
            far = wp.max(far, wp.max(d(low[c] - x[c]), d(x[c] - high[c])))
        return far

    @wp.func
    def sound(x: point, v: vec, rho: real, e: real, p: real, tau: s.sym, ep: real, T: real, D: real):
        """Whether a state is finite, by the sum of its numbers: none is near the largest that there is."""
        whole = rho + e + p + ep + T + D
        for c in range(3):
            whole += real(x[c]) + v[c] + tau[c] + tau[3 + c]
        return finite(whole)

    @wp.kernel(module=s.module(__name__))
    def guards(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        e: wp.array[real],
        p: wp.array[real],
        tau: wp.array[s.sym],
        ep: wp.array[real],
        T: wp.array[real],
        D: wp.array[real],
        n_neigh: wp.array[wp.int32],
        cover: wp.array[real],
        F: wp.array[matrix],
        inverted: wp.array[wp.int32],
        work: wp.array[real],
        low: point,
        high: point,
        most_cover: d,
        most_neighbours: d,
        has: wp.int32,
        n: wp.int32,
        chunk: wp.int32,
        along: wp.int32,
        across: wp.int32,
        # out:
        found: wp.array2d[d],
    ):
        """Of each block Σ m v²/2, Σ m e and Σ work [J], and of each of `GUARDS` its `FINDINGS`."""
        b = wp.tid() + offset
        kinetic, internal, worked = d(0.0), d(0.0), d(0.0)
        broken, thin, gone, deep = nothing(), nothing(), nothing(), nothing()
        crowd, over, hot = nothing(), nothing(), nothing()
        for k in range(chunk):
            i = b * across + k * along
            if i < n:
                whole = sound(x[i], v[i], rho[i], e[i], p[i], tau[i], ep[i], T[i], D[i])
                if has & wp.static(LAGRANGIAN) != 0:
                    F_i = F[i]
                    trace = real(0.0)
                    for c in range(3):
                        trace += F_i[c, 0] + F_i[c, 1] + F_i[c, 2]
                    whole = whole and finite(trace)
                    over = noted(over, d(inverted[i]), zero, i)
                if has & wp.static(CONTACT) != 0:
                    deep = noted(deep, d(cover[i]), most_cover, i)
                if has & wp.static(CONSTRAINED) != 0:
                    worked += d(work[i])
                broken = noted(broken, wp.where(whole, zero, one), half, i)
                thin = noted(thin, -d(rho[i]), no_density, i)
                gone = noted(gone, outside(x[i], low, high), zero, i)
                crowd = noted(crowd, d(n_neigh[i]), most_neighbours, i)
                vi = speeds(d(v[i][0]), d(v[i][1]), d(v[i][2]))
                moving, held = half * d(m[i]) * wp.dot(vi, vi), d(m[i]) * d(e[i])
                hot = noted(hot, moving + held, -lowest, i)
                kinetic += moving
                internal += held
        found[b, 0] = kinetic
        found[b, 1] = internal
        found[b, 2] = worked
        for c in range(wp.static(n_findings)):
            found[b, wp.static(n_sums + n_findings * state) + c] = broken[c]
            found[b, wp.static(n_sums + n_findings * density) + c] = thin[c]
            found[b, wp.static(n_sums + n_findings * domain) + c] = gone[c]
            found[b, wp.static(n_sums + n_findings * interpenetration) + c] = deep[c]
            found[b, wp.static(n_sums + n_findings * neighbours) + c] = crowd[c]
            found[b, wp.static(n_sums + n_findings * turned) + c] = over[c]
            found[b, wp.static(n_sums + n_findings * energetic) + c] = hot[c]

    return guards
