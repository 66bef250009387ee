"""The time step, found and kept on the device (method section 9)."""

import functools
from typing import NamedTuple

import warp as wp

from .lanes import make_lanes, make_reads
from .spec import Spec

RUNNING, DONE, STALE, COLLAPSED, NON_FINITE, INSIDE_OUT = range(6)
"""The device's verdict on the next step, given at the end of each: take it; t_stop reached; the neighbour rows no
longer cover every pair; the step fell below its floor; a particle's state is not finite; a Lagrangian particle has
turned over, J <= 0. A step is taken only when RUNNING: otherwise dt = 0 and every kernel returns at once."""

FLOOR = 1.0e-6
"""A step below this share of the first one stops the run."""

ACCELERATION_CFL = 0.25
"""Coefficient of the acceleration limit sqrt(h/|dv/dt|)."""

VISCOUS_SHARE = 0.6
"""Weight of the viscous signal speed: c_l + 0.6 (alpha c + beta mu) (Monaghan 1992)."""

CONTACT_CFL = 0.5
"""Coefficient of the contact limit 1/sqrt(stiffness/mass): two particles at it turn by 0.7 of a radian a step."""

LEAP = 1.0
"""Largest distance in h by which two particles, or one and an image, come nearer to each other in a step."""

CONTACT_LEAP = 0.5
"""The same where bodies are in contact: the force between them has the reach of the kernel to stop them in."""


class TimestepKernels(NamedTuple):
    """Kernels of this file."""

    local: wp.Kernel
    fold: wp.Kernel
    decide: wp.Kernel


@functools.cache
def make_timestep(
    s: Spec, lagrangian: bool = False, contact: bool = False, switched: bool = False
) -> TimestepKernels:
    """Build the kernels for one precision.

    Args:
        s: Specialisation.
        lagrangian: There are Lagrangian particles.
        contact: Bodies are in contact.
        switched: A switch scales the artificial viscosity.
    """
    real, vec, point = s.real, s.vec, s.point
    read = make_reads(s)
    lanes = make_lanes(s)
    lowered, finite, value, Bits = lanes.lowered, lanes.finite, lanes.value, lanes.Bits
    rank, ranked = lanes.rank, lanes.ranked
    zero = real(0.0)
    share, acceleration = real(VISCOUS_SHARE), real(ACCELERATION_CFL)
    floor, contact_cfl = wp.float64(FLOOR), real(CONTACT_CFL)
    options = ("lagrangian" * lagrangian, "contact" * contact, "switched" * switched)
    module = s.module(__name__, "_".join(filter(None, options)))
    over_lanes = s.module(__name__, "_".join(filter(None, ("local", *options))), lanes=True)

    @wp.func
    def limit(h: real, cfl: real, speed: real, rate2: real, a2: real, check: real):
        """Largest stable step of one particle [s]; -1 where its state is not finite."""
        dt_i = cfl * h / speed
        if wp.static(contact):
            dt_contact = contact_cfl / wp.sqrt(rate2)
            dt_i = wp.where(rate2 > zero and dt_contact < dt_i, dt_contact, dt_i)
        dt_force = acceleration * wp.sqrt(h / wp.sqrt(a2))
        dt_i = wp.where(a2 > zero and dt_force < dt_i, dt_force, dt_i)
        return wp.where(finite(check) and finite(dt_i), dt_i, real(-1.0))

    @wp.kernel(module=over_lanes)
    def local(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        dvdt: wp.array[vec],
        rho: wp.array[real],
        e: wp.array[real],
        cs: wp.array[real],
        cl: wp.array[real],
        mu: wp.array[real],
        av_switch: wp.array[real],
        shrink: wp.array[real],
        contact_rate: wp.array[real],
        h: real,
        cfl: real,
        viscosity_alpha: real,
        viscosity_beta: real,
        n: wp.int32,
        chunk: wp.int32,
        along: wp.int32,
        across: wp.int32,
        # out:
        block_dt: wp.array[real],
        block_low: wp.array[vec],
        block_high: wp.array[vec],
    ):
        """Block minima of dt_a = cfl h/(c_l + 0.6 q(α c + β mu)) [s], h as it shrinks in the reference configuration.

        Besides the lowest and the highest components of velocity in the block [m/s].
        """
        b = wp.tid() + offset
        dt_b = wp.cast(real(1.0e30), Bits)
        # scalars, not vectors: the compiler keeps them in registers
        low_x, low_y, low_z = rank(real(1.0e30)), rank(real(1.0e30)), rank(real(1.0e30))
        high_x, high_y, high_z = rank(real(-1.0e30)), rank(real(-1.0e30)), rank(real(-1.0e30))
        first = b * across
        last = wp.min(chunk, (n - first + along - 1) / along)
        k = wp.int32(0)
        while k < last:
            i = first + k * along
            signal = viscosity_alpha * read.real(cs, i) + viscosity_beta * read.real(mu, i)
            if wp.static(switched):
                signal *= read.real(av_switch, i)
            vi = read.vec(v, i)
            check = read.real(rho, i) + read.real(e, i) + wp.dot(vec(read.point(x, i)), vi)
            low_x, high_x = wp.min(low_x, rank(vi[0])), wp.max(high_x, rank(vi[0]))
            low_y, high_y = wp.min(low_y, rank(vi[1])), wp.max(high_y, rank(vi[1]))
            low_z, high_z = wp.min(low_z, rank(vi[2])), wp.max(high_z, rank(vi[2]))
            speed = read.real(cl, i) + share * signal
            if wp.static(lagrangian):
                speed *= read.real(shrink, i)
            rate2 = real(0.0)
            if wp.static(contact):
                rate2 = read.real(contact_rate, i)
            dt_b = lowered(
                dt_b, limit(h, cfl, speed, rate2, wp.dot(read.vec(dvdt, i), read.vec(dvdt, i)), check)
            )
            k += 1
        block_dt[b] = value(dt_b)
        block_low[b] = vec(ranked(low_x), ranked(low_y), ranked(low_z))
        block_high[b] = vec(ranked(high_x), ranked(high_y), ranked(high_z))

    @wp.kernel(module=module)
    def fold(
        offset: wp.int32,
        # in:
        block_dt: wp.array[real],
        block_low: wp.array[vec],
        block_high: wp.array[vec],
        tile_wear: wp.array[real],
        # out:
        folded_dt: wp.array[real],
        folded_low: wp.array[vec],
        folded_high: wp.array[vec],
        folded_wear: wp.array[real],
    ):
        """Extremes of the blocks [s, m/s] and maxima of tile_wear [-], of every so many of them."""
        b = wp.tid() + offset
        smallest, worn = real(1.0e30), real(0.0)
        low, high = vec(real(1.0e30)), vec(real(-1.0e30))
        step = folded_dt.shape[0]
        # counted one by one, which the compiler unrolls: it then waits for several at once
        for k in range((block_dt.shape[0] - b + step - 1) / step):
            i = b + k * step
            smallest = wp.min(smallest, block_dt[i])
            low, high = wp.min(low, block_low[i]), wp.max(high, block_high[i])
        for k in range((tile_wear.shape[0] - b + step - 1) / step):
            worn = wp.max(worn, tile_wear[b + k * step])
        folded_dt[b] = smallest
        folded_low[b] = low
        folded_high[b] = high
        folded_wear[b] = worn

    @wp.kernel(module=module)
    def decide(
        offset: wp.int32,
        # in:
        block_dt: wp.array[real],
        block_low: wp.array[vec],
        block_high: wp.array[vec],
        tile_wear: wp.array[real],
        unlisted: wp.array[wp.int32],
        turned: wp.array[wp.int32],
        h: real,
        leap: real,
        plane_mask: wp.int32,
        # out:
        dt: wp.array[real],
        clock: wp.array[wp.float64],
        count: wp.array[wp.int32],
    ):
        """Close the step that was taken, and set dt [s] of the next one.

        clock = [time, t_stop, dt, smallest dt, largest dt, first dt, wear]; count = [status, steps].
        The last step before t_stop hits it exactly, and the one before is halved rather than leaving a sliver.
        Nothing comes nearer to anything by more than ``leap`` h: what is not yet in reach limits no other step.
        """
        smallest, worn = real(1.0e30), real(0.0)
        low, high = vec(real(1.0e30)), vec(real(-1.0e30))
        for k in range(offset, block_dt.shape[0]):
            smallest = wp.min(smallest, block_dt[k])
            low, high = wp.min(low, block_low[k]), wp.max(high, block_high[k])
        speed2 = real(0.0)
        for c in range(3):
            speed = high[c] - low[c]
            if (plane_mask >> c) & 1 == 1:  # an image moves the other way
                speed = real(2.0) * wp.max(-low[c], high[c])
            speed2 += speed * speed
        dt_leap = leap * h / wp.sqrt(speed2)
        if dt_leap < smallest:
            smallest = dt_leap
        for t in range(tile_wear.shape[0]):
            worn = wp.max(worn, tile_wear[t])
        if dt[0] > zero:
            taken = clock[2]
            clock[0] = clock[0] + taken
            if clock[1] - clock[0] < wp.float64(1.0e-6) * taken:
                clock[0] = clock[1]
            clock[3] = wp.min(clock[3], taken)
            clock[4] = wp.max(clock[4], taken)
            count[1] = count[1] + 1
        step = wp.float64(smallest)
        left = clock[1] - clock[0]
        status = wp.int32(RUNNING)
        if not smallest >= zero:  # -1, or not a number
            status = wp.int32(NON_FINITE)
        elif turned[0] == 1:
            status = wp.int32(INSIDE_OUT)
        elif step <= floor * clock[5]:
            status = wp.int32(COLLAPSED)
        elif left <= wp.float64(0.0):
            status = wp.int32(DONE)
        elif worn >= real(1.0) or unlisted[0] == 1:
            status = wp.int32(STALE)
        count[0] = status
        clock[6] = wp.float64(worn)
        dt[0] = zero
        if status == RUNNING:
            if clock[5] == wp.float64(0.0):
                clock[5] = step
            if step >= left:
                step = left
            elif step > wp.float64(0.5) * left:
                step = wp.float64(0.5) * left
            clock[2] = step
            dt[0] = real(step)

    return TimestepKernels(local, fold, decide)
