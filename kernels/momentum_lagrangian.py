"""The pair forces of the Total Lagrangian equations, over reference neighbours (method sections 4 and 5; paper A eq 2)."""

import functools
from dataclasses import dataclass

import warp as wp

from .hourglass import make_hourglass
from .kernel_type import ERODED, LAGRANGIAN
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .packets import make_near
from .parts import HOURGLASS, VISCOUS, Parts, part_types
from .parts import tag as tag_of
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor
from .viscosity import make_viscosity


@dataclass(frozen=True)
class LagrangianTerms:
    """Which terms the pair loop is compiled with.

    Attributes:
        corrected: Mixed-corrected gradients: g0_ba is not -g0_ab.
        hourglass: Ganzenmüller's zero-energy control.
        erosion: Particles may have left all lists.
        coupled: There are Eulerian particles: the sums add to those of the Eulerian loop.
        mutual: The force of a pair of both types acts on its Eulerian member too: the conservative coupling.
        sheet: Plane stress: the thickness changes.
        planes: Neighbour entries may be mirror images.
        parts: Parts of the forces that the run keeps apart.
    """

    corrected: bool
    hourglass: bool
    erosion: bool
    coupled: bool
    mutual: bool
    sheet: bool
    planes: bool
    parts: Parts = (VISCOUS,)

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        flags = [name for name, on in vars(self).items() if on is True]
        return "_".join(filter(None, [*flags, tag_of(self.parts)]))


@functools.cache
def make_momentum_lagrangian(s: Spec, smoothing: Smoothing, terms: LagrangianTerms) -> wp.Kernel:
    """Build the momentum and energy loop for one set of terms."""
    real, vec, matrix, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, viscosity = make_mirror(s, terms.planes), make_tensor(s), make_viscosity(s)
    Accelerations, Powers = part_types(s, len(terms.parts))
    viscous, zero_energy = (terms.parts.index(p) if p in terms.parts else 0 for p in (VISCOUS, HOURGLASS))
    restoring, w = make_hourglass(s), smoothing.w
    dot, product, half, zero, dim = tensor.dot, tensor.product, real(0.5), real(0.0), s.dim
    read, near = make_reads(s), make_near(s)
    Moving, Packet, Cofactor = near.motion.dtype, near.rest.dtype, near.cofs.dtype
    lanes = make_lanes(s)
    raised, value, row_end, Bits, stride = lanes.raised, lanes.value, lanes.row_end, lanes.Bits, lanes.stride
    worth = lanes.worth
    coupled, controlled = terms.coupled, terms.hourglass

    @wp.func
    def areal(rho: real, thickness: wp.array[real], i: wp.int32):
        """Mass over volume in the space of the problem, μ."""
        if wp.static(terms.sheet):
            return rho * read.real(thickness, i)
        return rho

    @wp.kernel(module=s.module(__name__, "_".join(p for p in (smoothing.name, terms.tag) if p), lanes=True))
    def momentum_lagrangian(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        X: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        vol0: wp.array[real],
        rho: wp.array[real],
        thickness: wp.array[real],
        cs: wp.array[real],
        rate0: wp.array[matrix],
        F: wp.array[matrix],
        sig: wp.array[s.sym],
        cof: wp.array[Cofactor],
        P: wp.array[matrix],
        G0: wp.array[vec],
        motion: wp.array[Moving],
        site: wp.array[Packet],
        rest: wp.array[Packet],
        mat: wp.array[wp.int32],
        stiffness: wp.array[real],
        kernel_type: wp.array[wp.int32],
        interface: wp.array[wp.int32],
        h: real,
        hourglass: real,
        viscosity_alpha: real,
        viscosity_beta: real,
        plane: point,
        dt: wp.array[real],
        start0: wp.array[wp.int32],
        n_neigh0: wp.array[wp.int32],
        neigh0: wp.array[wp.int32],
        slope0: wp.array[real],
        w0: wp.array[real],
        q0_sum: wp.array[vec],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        part_a: wp.array[Accelerations],
        part_power: wp.array[Powers],
        mu: wp.array[real],
    ):
        """dvdt = Σ f_ab / m_a [m/s²] and dedt = Σ (w_ab - f_ab·v_a) / m_a [W/kg] (sections 4, 5 and 11).

        f_ab = V0_a V0_b (P_a g0_ab - P_b g0_ba + μ_a μ_b Π_ab/2 (n_b - n_a)), n_a = cof_a g0_ab, n_b = cof_b g0_ba, with
        μ = m/V: as V = J V0 and cof = J F⁻ᵀ the viscous part is section 4's
        m_a m_b Π_ab/2 (J_a⁻¹ F_b⁻ᵀ g0_ba - J_b⁻¹ F_a⁻ᵀ g0_ab). P and cof hold the correction K, so that only
        q_ab = K⁻¹ g0_ab is needed here. Of a Lagrangian particle Σ V0_b P_a g0_ab and the power P_a : Fdot need no loop.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        lagrangian = kernel_type[i] == LAGRANGIAN
        if wp.static(coupled):
            if not lagrangian and (wp.static(not terms.mutual) or interface[i] == 0):
                return
        first = start0[i]
        last = row_end(first, wp.where(kernel_type[i] == ERODED, 0, n_neigh0[i]))
        xi, vi = read.point(x, i), read.vec(v, i)
        cof_i = near.cofactor(cof, i)
        if wp.static(coupled):
            P_i = near.piola(P, sig, cof, i)
        rho_i, cs_i, areal_i = rho[i], cs[i], areal(rho[i], thickness, i)
        # scalars, not vectors: the compiler keeps them in registers
        f_x, f_y, f_z, power = real(0.0), real(0.0), real(0.0), real(0.0)
        visc_x, visc_y, visc_z, visc_power = real(0.0), real(0.0), real(0.0), real(0.0)
        zero_x, zero_y, zero_z, zero_power = real(0.0), real(0.0), real(0.0), real(0.0)
        mu_top = Bits(0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh0, k))
            sign = mirror.sign(read.integer(neigh0, k))
            counts = read.integer(neigh0, k) != i
            if wp.static(terms.erosion):
                counts = counts and read.integer(kernel_type, j) != ERODED
            if wp.static(coupled):
                counts = counts and (lagrangian or read.integer(kernel_type, j) == LAGRANGIAN)
            at_rest = near.resting(rest, j)
            Xij = mirror.apart(read.point(X, i), near.X(X, at_rest, j), sign, plane)
            own = wp.where(counts, real(read.real(slope0, k)), zero) * Xij
            back = -own
            if wp.static(terms.corrected):
                weight = wp.where(counts, real(read.real(w0, k)), zero)
                own -= weight * read.vec(G0, i)
                back -= weight * mirror.vector(near.G0(G0, at_rest, j), sign)
            at_present, strained = near.present(site, j), near.strained(cof, j)
            vji = mirror.vector(near.v(v, motion, j), sign) - vi
            facing = mirror.vector(back, sign)  # of an image: it is cheaper to mirror vectors than tensors
            stress = mirror.vector(near.P_times(P, strained, j, facing), sign)
            f_x -= stress[0]
            if wp.static(dim > 1):
                f_y -= stress[1]
            if wp.static(dim > 2):
                f_z -= stress[2]
            if wp.static(coupled):
                if not lagrangian:
                    inner = product(P_i, own)
                    power += dot(vji, inner)
                    f_x += inner[0]
                    if wp.static(dim > 1):
                        f_y += inner[1]
                    if wp.static(dim > 2):
                        f_z += inner[2]
            xij = mirror.apart(xi, near.x(x, at_present, j), sign, plane)
            mu_ij = viscosity.approach(wp.where(counts, -dot(vji, xij), zero), dot(xij, xij), h)
            mu_top = raised(mu_top, -mu_ij)
            if worth(mu_ij < zero):
                rho_j = real(near.rho(rho, at_present, j))
                pi_ij = viscosity.pressure(
                    mu_ij,
                    half * (cs_i + near.cs(cs, strained, j)),
                    half * (rho_i + rho_j),
                    viscosity_alpha,
                    viscosity_beta,
                )
                area = mirror.vector(near.cof_times(cof, strained, j, facing), sign) - product(cof_i, own)
                drag = (half * pi_ij * areal_i * areal(rho_j, thickness, j)) * area
                visc_power += dot(vji, drag)
                visc_x += drag[0]
                if wp.static(dim > 1):
                    visc_y += drag[1]
                if wp.static(dim > 2):
                    visc_z += drag[2]
            if wp.static(controlled):
                r0, r = wp.sqrt(dot(Xij, Xij)), wp.sqrt(dot(xij, xij))
                E_i, E_j = stiffness[mat[i]], stiffness[read.integer(mat, j)]
                size = restoring(
                    Xij, xij, F[i], mirror.tensor(read.mat(F, j), sign), w(r0, h), hourglass, E_i, E_j
                )
                push = wp.where(counts, read.real(vol0, j) * size / wp.max(r, real(1.0e-6) * h), zero) * xij
                zero_power += dot(vji, push)
                zero_x += push[0]
                if wp.static(dim > 1):
                    zero_y += push[1]
                if wp.static(dim > 2):
                    zero_z += push[2]
            k += stride
        mu_max = value(mu_top)
        if lagrangian:
            P_own = near.piola(P, sig, cof, i)  # not before the loop, through which it would take registers
            inner = product(P_own, q0_sum[i])
            f_x += inner[0]
            f_y += inner[1]
            f_z += inner[2]
            power = wp.ddot(P_own, rate0[i])
        per_mass = vol0[i] / m[i]
        a, powers = Accelerations(), Powers()
        dv, de = vec(), real(0.0)
        if wp.static(coupled):
            a, powers = Accelerations(part_a[i]), Powers(part_power[i])
            dv, de = vec(dvdt[i]), real(dedt[i])
            mu_max = wp.max(mu_max, mu[i])
        dvdt[i] = dv + per_mass * vec(f_x + visc_x + zero_x, f_y + visc_y + zero_y, f_z + visc_z + zero_z)
        dedt[i] = de + per_mass * (power + half * (visc_power + zero_power))
        powers[wp.static(viscous)] = powers[wp.static(viscous)] + per_mass * half * visc_power
        a[wp.static(viscous)] = a[wp.static(viscous)] + per_mass * vec(visc_x, visc_y, visc_z)
        if wp.static(controlled):
            powers[wp.static(zero_energy)] = per_mass * half * zero_power
            a[wp.static(zero_energy)] = per_mass * vec(zero_x, zero_y, zero_z)
        part_a[i] = a
        part_power[i] = powers
        mu[i] = mu_max

    return momentum_lagrangian
