"""Kick and drift of one step: total energy is conserved to round-off for any dt (method section 11)."""

import functools
from typing import NamedTuple

import warp as wp

from .parts import Parts, part_types, tag
from .spec import Spec

TINY_SPEED = {wp.float32: 1.0e-15, wp.float64: 1.0e-100}
"""Speeds [m/s] below this, and energies below its square [J/kg], are set to zero. Ahead of a wave they shrink from
step to step until their products are denormal numbers, with which a CPU is ten times slower."""


class IntegrateKernels(NamedTuple):
    """Kernels of this file."""

    kick: wp.Kernel
    drift: wp.Kernel
    drift_mean: wp.Kernel


@functools.cache
def make_integrate(
    s: Spec, exact_energy: bool = True, parts: Parts = (), constrained: bool = True
) -> IntegrateKernels:
    """Build the kernels for one specialisation.

    Args:
        s: Specialisation.
        exact_energy: Section 11's centring of the velocity in the energy.
        parts: Parts of the forces, booked one by one.
        constrained: Some particle is fixed or driven.
    """
    real, vec, place, point = s.real, s.vec, s.place, s.point
    half, zero, tiny = real(0.5), real(0.0), real(TINY_SPEED[s.real])
    Accelerations, Powers = part_types(s, len(parts))
    options = ("explicit" * (not exact_energy), tag(parts), "constrained" * constrained)
    module = s.module(__name__, "_".join(filter(None, options)))

    @wp.func
    def flushed(v: vec, e: real):
        """Zero where there is nothing but the precursor of round-off ahead of a wave."""
        for c in range(3):
            if wp.abs(v[c]) < tiny:
                v[c] = zero
        if wp.abs(e) < tiny * tiny:
            e = zero
        return v, e

    @wp.kernel(module=module)
    def kick(
        offset: wp.int32,
        # in:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        part_a: wp.array[Accelerations],
        part_power: wp.array[Powers],
        m: wp.array[real],
        fixed: wp.array[wp.int32],
        dt: wp.array[real],
        x: wp.array[point],
        # out:
        v: wp.array[vec],
        e: wp.array[real],
        impulse: wp.array[vec],
        twist: wp.array[vec],
        work: wp.array[real],
        e_parts: wp.array[Powers],
    ):
        """v' = v + dt A, e' = e + dt (B - A·(v + v')/2) with B - A·v = dedt (section 11), or e' = e + dt dedt.

        Where a component is prescribed it keeps its velocity; the momentum, angular momentum and energy
        that the constraint gives are booked in impulse [N s], twist [N m s] and work [J]. What each part of the forces
        has turned into internal energy is booked in e_parts [J/kg], by the same rule.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        free = dt[0] * dvdt[i]
        dv = free
        if wp.static(constrained):
            bits = fixed[i]
            if bits > 0:
                for c in range(3):
                    if (bits >> c) & 1 == 1:
                        dv[c] = zero
                push = m[i] * (dv - free)
                impulse[i] = impulse[i] + push
                twist[i] = twist[i] + wp.cross(vec(x[i]), push)
                work[i] = work[i] + wp.dot(push, v[i] + half * dv)
        v_new = v[i] + dv
        e_new = e[i] + dt[0] * dedt[i]
        if wp.static(exact_energy):
            e_new -= half * wp.dot(free, dv)
        if wp.static(len(parts) > 0):
            gained = dt[0] * part_power[i]
            if wp.static(exact_energy):
                gained -= (half * dt[0]) * (part_a[i] * dv)
            e_parts[i] = e_parts[i] + gained
        v_new, e_new = flushed(v_new, e_new)
        v[i] = v_new
        e[i] = e_new

    @wp.kernel(module=module)
    def drift(
        offset: wp.int32,
        # in:
        v: wp.array[vec],
        dt: wp.array[real],
        # out:
        x: wp.array[point],
    ):
        """x' = x + dt v': positions follow the new velocity, so that elastic waves neither grow nor decay."""
        i = wp.tid() + offset
        x[i] = x[i] + place(dt[0]) * point(v[i])

    @wp.kernel(module=module)
    def drift_mean(
        offset: wp.int32,
        # in:
        v: wp.array[vec],
        v_start: wp.array[vec],
        dt: wp.array[real],
        # out:
        x: wp.array[point],
        dvdt: wp.array[vec],
    ):
        """x' = x + dt (v + v')/2, and dvdt = (v' - v)/dt [m/s²] of the whole step, which limits the next one.

        Of a scheme whose stress follows a velocity that has felt it, and which damps waves by itself (section 11).
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        x[i] = x[i] + place(half * dt[0]) * point(v_start[i] + v[i])
        dvdt[i] = (v[i] - v_start[i]) / dt[0]

    return IntegrateKernels(kick, drift, drift_mean)
