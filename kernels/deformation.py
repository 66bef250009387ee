"""Deformation gradient of Lagrangian particles, and what their forces need of it (method section 4; paper A eqs 2 and 13)."""

import functools
from typing import NamedTuple

import warp as wp

from .index import natural
from .kernel_type import LAGRANGIAN
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .packets import make_near
from .spec import Spec

SMALLEST_J = 0.01
"""A deformation gradient of a smaller determinant is none: matter is not compressed a hundredfold, it has turned over."""

LARGEST_MISMATCH = 1.25
"""An Eulerian particle's J and ρ0/ρ may part by this factor: beyond, F is not that of the matter around it any more."""

LARGEST_CONTRACTION = 4.0
"""Largest |F⁻¹| of an Eulerian particle beside the Lagrangian region: its pair forces stiffen with its square."""

KEPT, INVERTED = 0, -1
"""What `deformation` leaves in ``fate``: F is physical; it is not, and the particle cannot stay Lagrangian."""


class DeformationKernels(NamedTuple):
    """Kernels of this file."""

    rate: wp.Kernel
    deformation: wp.Kernel
    piola: wp.Kernel


@functools.cache
def make_deformation(s: Spec, corrected: bool, planes: bool) -> DeformationKernels:
    """Build the kernels for one specialisation; ``corrected``: gradients are, in the reference configuration."""
    real, vec, mat, point, dim = s.real, s.vec, s.mat, s.point, s.dim
    mirror = make_mirror(s, planes)
    half, zero, one, smallest = real(0.5), real(0.0), real(1.0), real(SMALLEST_J)
    mismatch, contraction2 = real(LARGEST_MISMATCH), real(LARGEST_CONTRACTION**2)
    options = ("corrected" * corrected, "planes" * planes)
    module = s.module(__name__, "_".join(filter(None, options)))
    over_lanes = s.module(__name__, "_".join(filter(None, ("rate", *options))), lanes=True)
    read, near = make_reads(s), make_near(s)
    put, Moving, Packet, Cofactor = near.put, near.motion.dtype, near.rest.dtype, near.cofs.dtype
    lanes = make_lanes(s)
    row_end, stride = lanes.row_end, lanes.stride

    @wp.func
    def serves(F: mat, J_of_matter: real):
        """Whether the F of an Eulerian particle still serves its Lagrangian neighbours."""
        ratio, inverse = wp.determinant(F) / J_of_matter, wp.inverse(F)
        return ratio < mismatch and ratio * mismatch > one and wp.ddot(inverse, inverse) < contraction2

    @wp.kernel(module=over_lanes)
    def rate(
        offset: wp.int32,
        # in:
        X: wp.array[point],
        v: wp.array[vec],
        kernel_type: wp.array[wp.int32],
        interface: wp.array[wp.int32],
        G0: wp.array[vec],
        motion: wp.array[Moving],
        rest: wp.array[Packet],
        plane: point,
        dt: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        slope0: wp.array[real],
        w0: wp.array[real],
        # out:
        rate0: wp.array[mat],
    ):
        """rate0 = Σ V0_b (v_b - v_a) ⊗ K⁻¹ g0_ab [1/s], which is Fdot K⁻ᵀ (section 4)."""
        i = natural(wp.tid() + offset)
        if dt[0] == zero:
            return
        if kernel_type[i] != LAGRANGIAN and interface[i] == 0:
            return
        first = start0[i]
        last = row_end(first, n_neigh0[i])
        Xi, vi = read.point(X, i), read.vec(v, i)
        # scalars, not a matrix: the compiler keeps them in registers
        xx, xy, xz = real(0.0), real(0.0), real(0.0)
        yx, yy, yz = real(0.0), real(0.0), real(0.0)
        zx, zy, zz = real(0.0), real(0.0), real(0.0)
        wx, wy, wz = real(0.0), real(0.0), real(0.0)
        k = wp.int32(first)
        while k < last:  # the slopes of what fills up the row are 0
            j = mirror.index(read.integer(neigh0, k))
            sign = mirror.sign(read.integer(neigh0, k))
            u = mirror.vector(near.v(v, motion, j), sign) - vi
            g = read.real(slope0, k) * mirror.apart(Xi, near.X_alone(X, rest, j), sign, plane)
            xx += u[0] * g[0]
            if wp.static(dim > 1):
                xy += u[0] * g[1]
                yx += u[1] * g[0]
                yy += u[1] * g[1]
            if wp.static(dim > 2):
                xz += u[0] * g[2]
                yz += u[1] * g[2]
                zx += u[2] * g[0]
                zy += u[2] * g[1]
                zz += u[2] * g[2]
            if wp.static(corrected):
                wx += read.real(w0, k) * u[0]
                if wp.static(dim > 1):
                    wy += read.real(w0, k) * u[1]
                if wp.static(dim > 2):
                    wz += read.real(w0, k) * u[2]
            k += stride
        found = mat(xx, xy, xz, yx, yy, yz, zx, zy, zz)
        if wp.static(corrected):
            found -= wp.outer(vec(wx, wy, wz), G0[i])
        rate0[i] = found

    @wp.kernel(module=module)
    def deformation(
        offset: wp.int32,
        # in:
        rate0: wp.array[mat],
        K0: wp.array[mat],
        vol: wp.array[real],
        vol0: wp.array[real],
        kernel_type: wp.array[wp.int32],
        interface: wp.array[wp.int32],
        dt: wp.array[real],
        # out:
        F: wp.array[mat],
        dvdx: wp.array[mat],
        fate: wp.array[wp.int32],
    ):
        """F' = F + dt Fdot, Fdot = rate0 Kᵀ; dvdx = Fdot F⁻¹ at the middle of the step [1/s] (section 4).

        That is F of the positions after the drift with v. An Eulerian particle beside the Lagrangian region keeps F up
        to date too, but has its velocity gradient from elsewhere (section 5): the two may part company.
        """
        i = natural(wp.tid() + offset)
        if dt[0] == zero:
            return
        fate[i] = wp.static(KEPT)
        lagrangian = kernel_type[i] == LAGRANGIAN
        if not lagrangian and interface[i] == 0:
            return
        Fdot = mat(rate0[i])
        if wp.static(corrected):
            Fdot = Fdot * wp.transpose(K0[i])
        F_new = F[i] + dt[0] * Fdot
        middle = half * (F[i] + F_new)
        physical = wp.determinant(F_new) > smallest and wp.determinant(middle) > smallest
        if not lagrangian and physical:
            physical = serves(F_new, vol[i] / vol0[i])
        if not physical:
            fate[i] = wp.static(INVERTED)
            middle = mat(F[i])
            F_new = mat(F[i])
        if lagrangian:
            dvdx[i] = Fdot * wp.inverse(middle)
        F[i] = F_new

    @wp.kernel(module=module)
    def piola(
        offset: wp.int32,
        # in:
        F: wp.array[mat],
        sig: wp.array[s.sym],
        cs: wp.array[real],
        K0: wp.array[mat],
        kernel_type: wp.array[wp.int32],
        interface: wp.array[wp.int32],
        dt: wp.array[real],
        # out:
        cof: wp.array[Cofactor],
        P: wp.array[mat],
        shrink: wp.array[real],
    ):
        """cof = J F⁻ᵀ K [-] and P = σ J F⁻ᵀ K [Pa], the first Piola-Kirchhoff stress with K (section 4; paper A eq 12).

        K is the correction in the reference configuration, 1 without: the forces need either only in front of it. A GPU
        keeps σ for P, and cs, see `packets`.
        shrink bounds the largest contraction of a line, 1/λ_min <= sqrt(|F⁻¹ F⁻ᵀ|∞): waves cross the reference
        configuration so much faster. It is exact where the principal directions are the axes; 1 for particles without F.
        """
        i = natural(wp.tid() + offset)
        if dt[0] == zero:
            return
        shrink[i] = one
        if kernel_type[i] != LAGRANGIAN and interface[i] == 0:
            return
        inverse = wp.inverse(F[i])
        cofactor = wp.determinant(F[i]) * wp.transpose(inverse)
        if wp.static(corrected):
            cofactor = cofactor * K0[i]
        put(P, cof, i, cofactor, sig[i], cs[i])
        C = inverse * wp.transpose(inverse)
        widest = real(0.0)
        for c in range(3):
            widest = wp.max(widest, wp.abs(C[c, 0]) + wp.abs(C[c, 1]) + wp.abs(C[c, 2]))
        shrink[i] = wp.max(one, wp.sqrt(widest))

    return DeformationKernels(rate, deformation, piola)
