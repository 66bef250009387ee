"""The pair forces of the Eulerian equations: stress, artificial viscosity and artificial stress in one loop."""

import functools
from dataclasses import dataclass

import warp as wp

from .correction import make_gradient
from .mirror import make_mirror
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
    """

    corrected: bool
    switched: bool
    artificial_stress: bool
    planes: bool

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        return "_".join(name for name, on in vars(self).items() if on)


@functools.cache
def make_momentum(s: Spec, smoothing: Smoothing, terms: PairTerms) -> wp.Kernel:
    """Build the momentum and energy loop for one set of terms."""
    real, vec, mat = s.real, s.vec, s.mat
    mirror, tensor, of_pair = make_mirror(s, terms.planes), make_tensor(s), make_gradient(s, terms.corrected)
    viscosity = make_viscosity(s)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    dot, product = tensor.dot, tensor.product
    switched, stressed = terms.switched, terms.artificial_stress
    half = real(0.5)
    dim, on = s.dim, wp.constant(int(terms.corrected))

    @wp.kernel(module=s.module(__name__, "_".join(p for p in (smoothing.name, terms.tag) if p)))
    def momentum(
        offset: wp.int32,
        # in:
        x: wp.array[vec],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        cs: wp.array[real],
        sig: wp.array[mat],
        av_switch: wp.array[real],
        R: wp.array[mat],
        K: wp.array[mat],
        G: wp.array[vec],
        h: real,
        spacing: real,
        gradient_ratio: real,
        viscosity_alpha: real,
        viscosity_beta: real,
        plane: vec,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        mu: wp.array[real],
        near: wp.array[wp.int32],
        slope: wp.array[real],
        n_near: wp.array[wp.int32],
    ):
        """dvdt = Σ f_ab / m_a [m/s²] and dedt = Σ (w_ab - f_ab·v_a) / m_a [W/kg] (sections 3 and 11; paper A eq 1).

        f_ab = V_a V_b (σ_a g_ab - σ_b g_ba) + m_a m_b/2 (Π_ab - f^4 R_ab)(g_ba - g_ab); mu = largest |mu_ab| [m/s].
        The pairs within the support, and their (dW/dr)/r, are left behind for the velocity gradient.
        """
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        first = start[i]
        own = i * on  # K and G are one long where there is no correction
        xi, vi, sig_i = x[i], v[i], sig[i]
        m_i, rho_i, cs_i, vol_i = m[i], rho[i], cs[i], vol[i]
        areal_i = m_i / vol_i
        r_max2 = support * support * h * h
        # scalars, not vectors: the compiler keeps them in registers
        f_x, f_y, f_z, power, mu_max = real(0.0), real(0.0), real(0.0), real(0.0), real(0.0)
        if wp.static(stressed):
            w_spacing = real(1.0) / w(spacing, h)
        found = wp.int32(0)
        for k in range(first, first + n_neigh[i]):
            j = mirror.index(neigh[k])
            sign = mirror.sign(neigh[k])
            xij = xi - mirror.point(x[j], sign, plane)
            r2 = dot(xij, xij)
            if r2 < r_max2:
                r = wp.sqrt(r2)
                dw = dw_r(r, h)
                near[first + found] = neigh[k]
                slope[first + found] = dw
                found += 1
                w_ij = real(0.0)
                if wp.static(terms.corrected):
                    w_ij = w(r, h)
                g_ij = of_pair(xij, dw, w_ij, K[own], G[own], h, gradient_ratio)
                other = j * on
                g_ji = of_pair(
                    -xij,
                    dw,
                    w_ij,
                    mirror.tensor(K[other], sign),
                    mirror.vector(G[other], sign),
                    h,
                    gradient_ratio,
                )
                vji = mirror.vector(v[j], sign) - vi
                inner = product(sig_i, g_ij)
                stress = vol[j] * (inner - product(mirror.tensor(sig[j], sign), g_ji))
                g_mean = -g_ij
                if wp.static(terms.corrected):
                    g_mean = half * (g_ji - g_ij)
                pi_ij = real(0.0)
                closing = -dot(vji, xij)
                if closing < real(0.0):
                    mu_ij = viscosity.approach(closing, r2, h)
                    mu_max = wp.max(mu_max, -mu_ij)
                    pi_ij = viscosity.pressure(
                        mu_ij, half * (cs_i + cs[j]), half * (rho_i + rho[j]), viscosity_alpha, viscosity_beta
                    )
                    if wp.static(switched):
                        pi_ij *= half * (av_switch[i] + av_switch[j])
                pair = pi_ij * g_mean
                if wp.static(stressed):
                    R_ij = R[i] + mirror.tensor(R[j], sign)
                    if wp.trace(R_ij) < real(0.0):  # zero, unless one of the two is in tension
                        f = w(r, h) * w_spacing
                        pair -= (f * f * f * f) * product(R_ij, g_mean)
                pair *= m[j] * areal_i
                power += vol[j] * dot(vji, inner) + half * dot(vji, pair)
                f_x += stress[0] + pair[0]
                if wp.static(dim > 1):
                    f_y += stress[1] + pair[1]
                if wp.static(dim > 2):
                    f_z += stress[2] + pair[2]
        dvdt[i] = vec(f_x, f_y, f_z) / areal_i
        dedt[i] = power / areal_i
        mu[i] = mu_max
        n_near[i] = found

    return momentum
