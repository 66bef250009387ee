"""The pair forces of the Eulerian equations: stress, artificial viscosity and artificial stress in one loop."""

import functools
from dataclasses import dataclass

import warp as wp

from .company import ALONE, ANY, PLAIN
from .correction import make_gradient
from .coupling import ALL, ARTIFICIAL_STRESS, FORCE, PURE, Coupling, make_coupling
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .parts import ARTIFICIAL, VISCOUS, Parts, part_types
from .parts import tag as tag_of
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor
from .viscosity import make_viscosity


@dataclass(frozen=True)
class PairTerms:
    """Which terms the pair loop is compiled with.

    Attributes:
        corrected: Mixed-corrected gradients (section 2).
        switched: The viscosity is scaled by the pair mean of a switch (Balsara, Morris & Monaghan).
        artificial_stress: Gray et al.'s term.
        planes: Neighbour entries may be mirror images.
        coupling: What pairs of two kernel types, or of two bodies, share.
        parts: Parts of the forces that the run keeps apart.
        company: `PLAIN`: for particles of this company; `MIXED`: for all others; `ANY`: for all (see `kernels.company`).
    """

    corrected: bool
    switched: bool
    artificial_stress: bool
    planes: bool
    coupling: Coupling = PURE
    parts: Parts = (VISCOUS,)
    company: int = ANY

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        flags = [name for name, on in vars(self).items() if on is True]
        flags.append("plain" * (self.company == PLAIN))
        return "_".join(filter(None, [*flags, self.coupling.tag, tag_of(self.parts)]))


@functools.cache
def make_momentum(s: Spec, smoothing: Smoothing, terms: PairTerms) -> wp.Kernel:
    """Build the momentum and energy loop for one set of terms."""
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, terms.planes), make_tensor(s), make_gradient(s, terms.corrected)
    viscosity, terms_of = make_viscosity(s), make_coupling(s, terms.coupling)
    Accelerations, Powers = part_types(s, len(terms.parts))
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    dot, act = tensor.dot, tensor.act
    read = make_reads(s)
    lanes = make_lanes(s)
    worth, raised, value, row_end, Bits = lanes.worth, lanes.raised, lanes.value, lanes.row_end, lanes.Bits
    stride = lanes.stride
    switched, stressed = terms.switched, terms.artificial_stress
    viscous, artificial = (terms.parts.index(p) if p in terms.parts else 0 for p in (VISCOUS, ARTIFICIAL))
    half = real(0.5)
    dim, on, coupled = s.dim, wp.constant(int(terms.corrected)), bool(terms.coupling.form)
    shared = bool(terms.coupling.tag)  # a pair may lack some of the terms

    @wp.kernel(module=s.module(__name__, "_".join(p for p in (smoothing.name, terms.tag) if p), lanes=True))
    def momentum(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        X: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        cs: wp.array[real],
        sig: wp.array[s.sym],
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        company: wp.array[wp.int32],
        av_switch: wp.array[real],
        R: wp.array[s.sym],
        K: wp.array[mat],
        G: wp.array[vec],
        h: real,
        spacing: real,
        gradient_ratio: real,
        viscosity_alpha: real,
        viscosity_beta: real,
        plane: point,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        part_a: wp.array[Accelerations],
        part_power: wp.array[Powers],
        mu: wp.array[real],
    ):
        """dvdt = Σ f_ab / m_a [m/s²] and dedt = Σ (w_ab - f_ab·v_a) / m_a [W/kg] (sections 3 and 11; paper A eq 1).

        f_ab = V_a V_b (σ_a g_ab - σ_b g_ba) + m_a m_b/2 (Π_ab - f^4 R_ab)(g_ba - g_ab); mu = largest |mu_ab| [m/s].
        What viscosity and artificial stress contribute is kept in part_a and part_power.
        """
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        count = wp.int32(n_neigh[i])
        if wp.static(terms.company != ANY):
            if (company[i] == wp.static(PLAIN)) != wp.static(terms.company == PLAIN):
                return
            count = wp.where(company[i] == wp.static(ALONE), 0, count)
        first = start[i]
        last = row_end(first, count)
        own = i * on  # K and G are one long where there is no correction
        xi, vi, sig_i = read.point(x, i), read.vec(v, i), sig[i]
        m_i, rho_i, cs_i, vol_i = m[i], rho[i], cs[i], vol[i]
        areal_i = m_i / vol_i
        r_max2 = support * support * h * h
        # scalars, not vectors: the compiler keeps them in registers
        f_x, f_y, f_z, power = real(0.0), real(0.0), real(0.0), real(0.0)
        visc_x, visc_y, visc_z, visc_power = real(0.0), real(0.0), real(0.0), real(0.0)
        art_x, art_y, art_z, art_power = real(0.0), real(0.0), real(0.0), real(0.0)
        mu_top = Bits(0)
        if wp.static(stressed):
            w_spacing = real(1.0) / w(spacing, h)
        bits = wp.int32(wp.static(ALL))
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            sign = mirror.sign(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), sign, plane)
            r2 = dot(xij, xij)
            near = r2 < r_max2 and read.integer(neigh, k) != i
            if worth(near):
                if wp.static(shared):
                    Xij = vec()
                    if wp.static(coupled):
                        Xij = mirror.apart(read.point(X, i), read.point(X, j), sign, plane)
                    bits = terms_of(
                        kernel_type[i],
                        read.integer(kernel_type, j),
                        body[i] == read.integer(body, j),
                        Xij,
                        support * h,
                    )
                r = wp.sqrt(r2)
                dw = wp.where(near, dw_r(r, h), real(0.0))
                w_ij = real(0.0)
                if wp.static(terms.corrected):
                    w_ij = wp.where(near, w(r, h), real(0.0))
                g_ij = of_pair(xij, dw, w_ij, read.mat(K, own), read.vec(G, own), h, gradient_ratio)
                other = j * on
                g_ji = of_pair(
                    -xij,
                    dw,
                    w_ij,
                    mirror.tensor(read.mat(K, other), sign),
                    mirror.vector(read.vec(G, other), sign),
                    h,
                    gradient_ratio,
                )
                vji = mirror.vector(read.vec(v, j), sign) - vi
                g_mean = -g_ij
                if wp.static(terms.corrected):
                    g_mean = half * (g_ji - g_ij)
                pair_mass = read.real(m, j) * areal_i
                if (bits & wp.static(FORCE)) != 0:
                    inner = act(sig_i, g_ij)
                    stress = read.real(vol, j) * (inner - act(mirror.symmetric(read.sym(sig, j), sign), g_ji))
                    power += read.real(vol, j) * dot(vji, inner)
                    f_x += stress[0]
                    if wp.static(dim > 1):
                        f_y += stress[1]
                    if wp.static(dim > 2):
                        f_z += stress[2]
                    mu_ij = viscosity.approach(wp.where(near, -dot(vji, xij), real(0.0)), r2, h)
                    mu_top = raised(mu_top, -mu_ij)
                    pi_ij = viscosity.pressure(
                        mu_ij,
                        half * (cs_i + read.real(cs, j)),
                        half * (rho_i + read.real(rho, j)),
                        viscosity_alpha,
                        viscosity_beta,
                    )
                    if wp.static(switched):
                        pi_ij *= half * (av_switch[i] + read.real(av_switch, j))
                    drag = (pair_mass * pi_ij) * g_mean
                    visc_power += dot(vji, drag)
                    visc_x += drag[0]
                    if wp.static(dim > 1):
                        visc_y += drag[1]
                    if wp.static(dim > 2):
                        visc_z += drag[2]
                if wp.static(stressed):
                    R_ij = R[i] + mirror.symmetric(read.sym(R, j), sign)
                    # zero, unless one of the two is in tension
                    if (bits & wp.static(ARTIFICIAL_STRESS)) != 0 and tensor.trace(R_ij) < real(0.0):
                        f = w(r, h) * w_spacing
                        push = (-pair_mass * (f * f * f * f)) * act(R_ij, g_mean)
                        art_power += dot(vji, push)
                        art_x += push[0]
                        if wp.static(dim > 1):
                            art_y += push[1]
                        if wp.static(dim > 2):
                            art_z += push[2]
            k += stride
        per_mass = real(1.0) / areal_i
        dvdt[i] = per_mass * vec(f_x + visc_x + art_x, f_y + visc_y + art_y, f_z + visc_z + art_z)
        dedt[i] = per_mass * (power + half * (visc_power + art_power))
        a, powers = Accelerations(), Powers()
        powers[wp.static(viscous)] = per_mass * half * visc_power
        a[wp.static(viscous)] = per_mass * vec(visc_x, visc_y, visc_z)
        if wp.static(stressed):
            powers[wp.static(artificial)] = per_mass * half * art_power
            a[wp.static(artificial)] = per_mass * vec(art_x, art_y, art_z)
        part_a[i] = a
        part_power[i] = powers
        mu[i] = value(mu_top)

    return momentum
