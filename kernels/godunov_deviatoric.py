"""Stage 1 of the time-split scheme: the deviatoric stress, without dissipation (Connolly et al. 2013, section 3.3)."""

import functools

import warp as wp

from .correction import make_gradient
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_deviatoric(s: Spec, smoothing: Smoothing, order: int, corrected: bool, planes: bool) -> wp.Kernel:
    """Build the loop; for second order it also leaves the slopes of pressure and density, and if asked the pairs."""
    real, vec, matrix, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    dot, act = tensor.dot, tensor.act
    zero, half = real(0.0), real(0.5)
    read = make_reads(s)
    lanes = make_lanes(s)
    worth, row_end, stride = lanes.worth, lanes.row_end, lanes.stride
    dim, on = s.dim, wp.constant(int(corrected))
    options = (smoothing.name, f"order{order}", "corrected" * corrected, "planes" * planes)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def deviatoric(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        p: wp.array[real],
        tau: wp.array[s.sym],
        K: wp.array[matrix],
        G: wp.array[vec],
        h: real,
        gradient_ratio: real,
        plane: point,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        grad_p: wp.array[vec],
        grad_rho: wp.array[vec],
        v_start: wp.array[vec],
    ):
        """dvdt = Σ f_ab/m_a [m/s²], dedt = Σ f_ab·(v_b - v_a)/(2 m_a) [W/kg], f_ab = V_a V_b (τ_a g_ab - τ_b g_ba).

        Section 10, stage 1 (Connolly et al. 2013, Eqs. 21 and 32). grad Q = Σ V_b (Q_b - Q_a) g_ab of p [Pa/m] and
        ρ [kg/m⁴]; v_start = v.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        first = start[i]
        last = row_end(first, n_neigh[i])
        own = i * on  # K and G are one long where there is no correction
        xi, vi, tau_i = read.point(x, i), read.vec(v, i), tau[i]
        p_i, rho_i = p[i], rho[i]
        r_max2 = support * support * h * h
        # scalars, not vectors: the compiler keeps them in registers
        f_x, f_y, f_z, power = real(0.0), real(0.0), real(0.0), real(0.0)
        p_x, p_y, p_z = real(0.0), real(0.0), real(0.0)
        rho_x, rho_y, rho_z = real(0.0), real(0.0), real(0.0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            sign = mirror.sign(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), sign, plane)
            r2 = dot(xij, xij)
            near = r2 < r_max2 and read.integer(neigh, k) != i
            if worth(near):
                r = wp.sqrt(r2)
                dw, w_ij = wp.where(near, dw_r(r, h), zero), zero
                if wp.static(corrected):
                    w_ij = wp.where(near, w(r, h), zero)
                g_ij = of_pair(xij, dw, w_ij, read.mat(K, own), read.vec(G, own), h, gradient_ratio)
                tau_j = mirror.symmetric(read.sym(tau, j), sign)
                f = act(tau_i + tau_j, g_ij)
                if wp.static(corrected):
                    other = j * on
                    K_j, G_j = (
                        mirror.tensor(read.mat(K, other), sign),
                        mirror.vector(read.vec(G, other), sign),
                    )
                    g_ji = of_pair(-xij, dw, w_ij, K_j, G_j, h, gradient_ratio)
                    f = act(tau_i, g_ij) - act(tau_j, g_ji)
                f *= read.real(vol, j)
                power += half * dot(f, mirror.vector(read.vec(v, j), sign) - vi)
                f_x += f[0]
                if wp.static(dim > 1):
                    f_y += f[1]
                if wp.static(dim > 2):
                    f_z += f[2]
                if wp.static(order == 2):
                    dp, drho = (
                        read.real(vol, j) * (read.real(p, j) - p_i),
                        read.real(vol, j) * (read.real(rho, j) - rho_i),
                    )
                    p_x += dp * g_ij[0]
                    rho_x += drho * g_ij[0]
                    if wp.static(dim > 1):
                        p_y += dp * g_ij[1]
                        rho_y += drho * g_ij[1]
                    if wp.static(dim > 2):
                        p_z += dp * g_ij[2]
                        rho_z += drho * g_ij[2]
            k += stride
        per_mass = vol[i] / m[i]
        dvdt[i] = per_mass * vec(f_x, f_y, f_z)
        dedt[i] = per_mass * power
        v_start[i] = vi
        if wp.static(order == 2):
            grad_p[i] = vec(p_x, p_y, p_z)
            grad_rho[i] = vec(rho_x, rho_y, rho_z)

    return deviatoric
