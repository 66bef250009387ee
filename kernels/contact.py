"""Frictionless contact between bodies: a repulsive potential of every pair of particles of two bodies (section 6)."""

import functools

import warp as wp

from .kernel_type import ERODED
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .parts import CONTACT, Parts, part_types, tag
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor

CENTRE = 1e-3
"""Distance in h at which (dW/dr)/r is taken for its value at r = 0, where a kernel may divide 0 by 0."""


@functools.cache
def make_strangers(s: Spec, planes: bool) -> wp.Kernel:
    """Build the kernel that finds who has particles of other bodies near; ``planes``: entries may be mirror images."""
    mirror, read, lanes = make_mirror(s, planes), make_reads(s), make_lanes(s)
    row_end, stride = lanes.row_end, lanes.stride
    options = ("strangers", "planes" * planes)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def strangers(
        offset: wp.int32,
        # in:
        body: wp.array[wp.int32],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        n_strangers: wp.array[wp.int32],
    ):
        """n_strangers = entries of the row that are of another body, beyond the support too."""
        i = wp.tid() + offset
        first = start[i]
        last = row_end(first, n_neigh[i])
        found = wp.int32(0)
        k = wp.int32(first)
        while k < last:
            found += wp.where(read.integer(body, mirror.index(read.integer(neigh, k))) != body[i], 1, 0)
            k += stride
        n_strangers[i] = found

    return strangers


@functools.cache
def make_contact(s: Spec, smoothing: Smoothing, planes: bool, parts: Parts = (CONTACT,)) -> wp.Kernel:
    """Build the pair loop over particles of other bodies.

    Args:
        s: Specialisation.
        smoothing: Smoothing kernel.
        planes: Neighbour entries may be mirror images.
        parts: Parts of the forces that the run keeps apart.
    """
    real, vec, point = s.real, s.vec, s.point
    Accelerations, Powers = part_types(s, len(parts))
    row = parts.index(CONTACT)
    mirror, dot = make_mirror(s, planes), make_tensor(s).dot
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    lanes = make_lanes(s)
    last_end, stride = lanes.last_end, lanes.stride
    zero, half, three, four = real(0.0), real(0.5), real(3.0), real(4.0)
    centre, dim = real(CENTRE), s.dim

    @wp.kernel(
        module=s.module(__name__, "_".join(filter(None, (smoothing.name, "planes" * planes, tag(parts)))))
    )
    def contact(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        vol: wp.array[real],
        body: wp.array[wp.int32],
        mat: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        contact_modulus: wp.array[real],
        contact_scale: real,
        h: real,
        spacing: real,
        plane: point,
        dt: wp.array[real],
        n_strangers: wp.array[wp.int32],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        part_a: wp.array[Accelerations],
        part_power: wp.array[Powers],
        contact_rate: wp.array[real],
        cover: wp.array[real],
    ):
        """dvdt += Σ f_ab / m_a [m/s²], dedt += Σ f_ab·(v_b - v_a) / (2 m_a) [W/kg] (section 6; Young et al. eqs 15, 16).

        f_ab = -V_a V_b Kc n W^(n-1)/W(dp)^n grad_a W over the b of other bodies, n = 4, Kc the scale times the smaller
        modulus. contact_rate = Σ k_ab / m_a [1/s²], k_ab a bound of the stiffness; cover = highest Σ V_b W_ab so far.
        The entries of contact among the parts are taken for zero.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        if n_strangers[i] == 0:
            contact_rate[i] = zero
            return
        xi, vi, body_i, vol_i, modulus_i = x[i], v[i], body[i], vol[i], contact_modulus[mat[i]]
        r_max2 = support * support * h * h
        w_spacing = real(1.0) / w(spacing, h)
        steepest = -dw_r(centre * h, h) * w_spacing
        f_x, f_y, f_z, power, rate, share = real(0.0), real(0.0), real(0.0), real(0.0), real(0.0), real(0.0)
        count = n_neigh[i]
        if kernel_type[i] == ERODED:
            count = wp.int32(0)
        for k in range(start[i], last_end(start[i], count), stride):
            j = mirror.index(neigh[k])
            if body[j] != body_i and kernel_type[j] != ERODED:
                sign = mirror.sign(neigh[k])
                xij = mirror.apart(xi, x[j], sign, plane)
                r2 = dot(xij, xij)
                if r2 < r_max2:
                    r = wp.sqrt(r2)
                    w_ij = w(r, h)
                    f, slope = w_ij * w_spacing, dw_r(r, h) * w_spacing
                    # every factor is the same seen from b, to the last bit; V_a V_b alone may be 0 in single precision
                    size = contact_scale * wp.min(modulus_i, contact_modulus[mat[j]])
                    size *= wp.min(vol_i, vol[j])
                    size *= wp.max(vol_i, vol[j])
                    size *= four * f * f
                    push = -size * f * slope
                    # above both second derivatives of the potential: with D = |(dW/dr)/r| at r = 0, largest there,
                    # every kernel has -D <= W'' <= D/2
                    level = f * steepest
                    rate += size * wp.max(three * r2 * slope * slope + half * level, level)
                    share += vol[j] * w_ij
                    power += half * push * dot(mirror.vector(v[j], sign) - vi, xij)
                    f_x += push * xij[0]
                    if wp.static(dim > 1):
                        f_y += push * xij[1]
                    if wp.static(dim > 2):
                        f_z += push * xij[2]
        contact_rate[i] = rate / m[i]
        if rate > zero:
            dv, de = vec(f_x, f_y, f_z) / m[i], power / m[i]
            dvdt[i] = dvdt[i] + dv
            dedt[i] = dedt[i] + de
            a, powers = Accelerations(part_a[i]), Powers(part_power[i])
            a[wp.static(row)] = dv
            powers[wp.static(row)] = de
            part_a[i] = a
            part_power[i] = powers
            cover[i] = wp.max(cover[i], share)

    return contact
