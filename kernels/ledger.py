"""Conserved quantities and extremes of all particles, as one partial sum per block, in double precision."""

import functools
from typing import Any

import warp as wp

from .parts import PARTS, Parts, part_types, tag
from .spec import Spec

SUMS = (
    "kinetic_energy", "internal_energy",
    "momentum_x", "momentum_y", "momentum_z",
    "angular_momentum_x", "angular_momentum_y", "angular_momentum_z",
    "impulse_x", "impulse_y", "impulse_z",
    "twist_x", "twist_y", "twist_z",
    "work", "eos_clipped", *PARTS,
)  # fmt: skip
"""Columns that are added up over blocks; energies in J, momenta in N s and N m s (per metre in 2D, ...).

The internal energy holds what the parts of the forces have turned into it."""

MAXIMA = ("pressure_max", "tension_max", "speed_max", "density_max", "rarefaction_max", "internal_energy_max")
"""Columns of which the largest counts: p, -p [Pa], |v| [m/s], rho, -rho [kg/m³], e [J/kg]."""


@functools.cache
def make_ledger(s: Spec, parts: Parts = (), constrained: bool = True) -> wp.Kernel:
    """Build the kernel for one precision.

    Args:
        s: Specialisation.
        parts: Parts of the forces that the run keeps apart; the columns of others are left as they are.
        constrained: Some particle is fixed or driven; else the columns of constraints are zero.
    """
    real, vec, point = s.real, s.vec, s.point
    d = wp.float64
    vec3 = wp.types.vector(3, d)
    _, Powers = part_types(s, len(parts))
    n_parts, first_part = len(parts), len(SUMS) - len(PARTS)
    Booked = wp.types.vector(max(n_parts, 1), d)
    module = s.module(__name__, "_".join(filter(None, (tag(parts), "constrained" * constrained))))
    vec6 = wp.types.vector(len(MAXIMA), d)
    half, lowest = d(0.5), d(-1.0e300)
    n_sums, n_maxima = len(SUMS), len(MAXIMA)

    @wp.func
    def wide(a: Any):
        return vec3(d(a[0]), d(a[1]), d(a[2]))

    @wp.kernel(module=module)
    def ledger(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        e: wp.array[real],
        p: wp.array[real],
        rho: wp.array[real],
        impulse: wp.array[vec],
        twist: wp.array[vec],
        work: wp.array[real],
        clipped: wp.array[wp.int32],
        e_parts: wp.array[Powers],
        n: wp.int32,
        chunk: wp.int32,
        along: wp.int32,
        across: wp.int32,
        # out:
        partial: wp.array2d[d],
    ):
        """Partial sums of m v²/2, m e, m v, x × m v and the constraints' account; partial maxima."""
        b = wp.tid() + offset
        kinetic, internal, worked, clips = d(0.0), d(0.0), d(0.0), d(0.0)
        momentum, spin, push, turn = vec3(), vec3(), vec3(), vec3()
        booked = Booked()
        top = vec6(lowest, lowest, lowest, lowest, lowest, lowest)
        for k in range(chunk):
            i = b * across + k * along
            if i < n:
                mi, vi = d(m[i]), wide(v[i])
                kinetic += half * mi * wp.dot(vi, vi)
                internal += mi * d(e[i])
                momentum += mi * vi
                spin += wp.cross(wide(x[i]), mi * vi)
                if wp.static(constrained):
                    push += wide(impulse[i])
                    turn += wide(twist[i])
                    worked += d(work[i])
                clips += d(clipped[i])
                for c in range(wp.static(n_parts)):
                    booked[c] += mi * d(e_parts[i][c])
                top[0] = wp.max(top[0], d(p[i]))
                top[1] = wp.max(top[1], -d(p[i]))
                top[2] = wp.max(top[2], wp.length(vi))
                top[3] = wp.max(top[3], d(rho[i]))
                top[4] = wp.max(top[4], -d(rho[i]))
                top[5] = wp.max(top[5], d(e[i]))
        partial[b, 0] = kinetic
        partial[b, 1] = internal
        for c in range(3):
            partial[b, 2 + c] = momentum[c]
            partial[b, 5 + c] = spin[c]
            partial[b, 8 + c] = push[c]
            partial[b, 11 + c] = turn[c]
        partial[b, 14] = worked
        partial[b, 15] = clips
        for c in range(wp.static(n_parts)):
            partial[b, wp.static(first_part) + wp.static(parts[c])] = booked[c]
        for c in range(wp.static(n_maxima)):
            partial[b, wp.static(n_sums) + c] = top[c]

    return ledger
