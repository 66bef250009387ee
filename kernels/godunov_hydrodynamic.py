"""Stage 2 of the time-split scheme: Riemann problems of the pressure (Connolly et al. 2013, section 3.3)."""

import functools
from dataclasses import dataclass

import warp as wp

from .correction import make_gradient
from .interface import CLOSEST, make_interface
from .lanes import make_lanes, make_reads
from .limiters import make_limiter
from .material import make_material
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@dataclass(frozen=True)
class Reconstruction:
    """What the states of a Riemann problem are made of.

    Attributes:
        riemann: Riemann solver.
        order: 1: the particles' own values; 2: linear reconstruction (MUSCL).
        limiter: Limiter of the slopes.
        jump: Slopes are bounded by the pair's own difference too.
        fragile: Some material bears no tension, or none once it has failed.
    """

    riemann: str
    order: int
    limiter: str
    jump: bool
    fragile: bool

    @property
    def tag(self) -> str:
        """Short name of the combination."""
        limiter = (self.limiter, "jump" * self.jump) if self.order == 2 else ()
        return "_".join(filter(None, (self.riemann.replace("-", "_"), *limiter, "fragile" * self.fragile)))


@functools.cache
def make_hydrodynamic(
    s: Spec, smoothing: Smoothing, states: Reconstruction, corrected: bool, planes: bool
) -> wp.Kernel:
    """Build the loop."""
    real, vec, matrix, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    side, interface = make_interface(s, states.riemann)
    Material = make_material(s)
    limited = make_limiter(s, states.limiter, states.jump)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    read = make_reads(s)
    lanes = make_lanes(s)
    taken, raised, value, row_end, Bits = lanes.worth, lanes.raised, lanes.value, lanes.row_end, lanes.Bits
    stride = lanes.stride
    dot, quadratic = tensor.dot, tensor.quadratic
    zero, half, one, two = real(0.0), real(0.5), real(1.0), real(2.0)
    closest = real(CLOSEST)
    dim, on, second, fragile = s.dim, wp.constant(int(corrected)), states.order == 2, states.fragile
    options = (smoothing.name, states.tag, "corrected" * corrected, "planes" * planes)

    @wp.func
    def of_volume(u_over: real, dilation: real):
        """Part of a pair's velocity difference that changes the volume: sound brings it, and no more than that."""
        low = wp.where(wp.abs(u_over) < wp.abs(dilation), u_over, dilation)
        return wp.where(u_over * dilation > zero, low, zero)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def hydrodynamic(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        v_start: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        p: wp.array[real],
        cs: wp.array[real],
        cl: wp.array[real],
        dvdx: wp.array[matrix],
        grad_p: wp.array[vec],
        grad_rho: wp.array[vec],
        D: wp.array[real],
        mat: wp.array[wp.int32],
        materials: wp.array[Material],
        K: wp.array[matrix],
        G: wp.array[vec],
        h: real,
        gradient_ratio: real,
        limiter_beta: real,
        plane: point,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        dvdt: wp.array[vec],
        dedt: wp.array[real],
        div: wp.array[real],
        mu: wp.array[real],
    ):
        """dvdt = Σ f_ab/m_a [m/s²], dedt = Σ f_ab·(v* - v_a)/m_a [W/kg], div = 2 Σ V_b (v* - v_a)·g_ab [1/s].

        f_ab = -2 V_a V_b p* q_ab, q_ab = (g_ab - g_ba)/2; v* = u* along e, the direction from b to a, and the pair's
        mean across it, which does no work without correction (section 10, stage 2; Connolly et al. 2013, Eqs. 22 and
        34). The Riemann problems know v_start, the velocity before the first stage: at a free surface p is not 0 but
        balances τ, and what the first stage alone does to v is no jump. The power is that on v, which this stage kicks.
        Second order: the states lie (r/2)(1 - c_l dt/r) off the particles on the limited slope (Eqs. 23-27), but that
        of u at r/2, less the share c_l dt/r of what of its slope is div v: sound that arrives within dt carries no
        shear, and a viscosity of order rho c_l^2 dt would stop a shear flow. dvdx is that of v_start.
        mu = largest approach speed [m/s].
        """
        i = wp.tid() + offset
        step = dt[0]
        if step == zero:
            return
        first = start[i]
        last = row_end(first, n_neigh[i])
        own = i * on  # K and G are one long where there is no correction
        xi, vi, kicked_i = read.point(x, i), read.vec(v_start, i), read.vec(v, i)
        r_max2, closest2 = support * support * h * h, closest * closest * h * h
        p_i, rho_i, cs_i = p[i], rho[i], cs[i]
        A_i = materials[mat[i]].A_shock
        bears_i, whole_i = True, True
        if wp.static(fragile):
            lost_i = materials[mat[i]].D_tension
            bears_i, whole_i = D[i] < lost_i, D[i] < wp.max(lost_i, one)
        if wp.static(second):
            L_i, grad_p_i, grad_rho_i = dvdx[i], read.vec(grad_p, i), read.vec(grad_rho, i)
            reach_i = cl[i] * step
        # scalars, not vectors: the compiler keeps them in registers
        f_x, f_y, f_z, power, rate = real(0.0), real(0.0), real(0.0), real(0.0), real(0.0)
        mu_top = Bits(0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            sign = mirror.sign(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), sign, plane)
            r2 = dot(xij, xij)
            near = r2 < r_max2 and read.integer(neigh, k) != i
            if taken(near):
                vj = mirror.vector(read.vec(v_start, j), sign)
                r = wp.sqrt(wp.max(wp.where(near, r2, h * h), closest2))
                dw, w_ij = wp.where(near, dw_r(r, h), zero), zero
                per_r = one / r
                e = per_r * xij
                u_i, u_j = dot(vi, e), dot(vj, e)
                mu_top = raised(mu_top, wp.where(near and u_j > u_i, u_j - u_i, zero))
                left = side(
                    u_j,
                    read.real(p, j),
                    read.real(rho, j),
                    read.real(cs, j),
                    materials[read.integer(mat, j)].A_shock,
                )
                right = side(u_i, p_i, rho_i, cs_i, A_i)
                bears, whole = bears_i, whole_i
                if wp.static(fragile):
                    lost_j = materials[read.integer(mat, j)].D_tension
                    bears, whole = (
                        bears and read.real(D, j) < lost_j,
                        whole and read.real(D, j) < wp.max(lost_j, one),
                    )
                if wp.static(second):
                    if whole:
                        # differences over the pair: slope times r
                        u_over = limited(
                            per_r * quadratic(L_i, xij),
                            per_r * quadratic(mirror.tensor(read.mat(dvdx, j), sign), xij),
                            u_i - u_j,
                            limiter_beta,
                        )
                        p_over = limited(
                            dot(grad_p_i, xij),
                            dot(mirror.vector(read.vec(grad_p, j), sign), xij),
                            p_i - read.real(p, j),
                            limiter_beta,
                        )
                        rho_over = limited(
                            dot(grad_rho_i, xij),
                            dot(mirror.vector(read.vec(grad_rho, j), sign), xij),
                            rho_i - read.real(rho, j),
                            limiter_beta,
                        )
                        swept_i, swept_j = (
                            wp.min(reach_i * per_r, one),
                            wp.min(step * read.real(cl, j) * per_r, one),
                        )
                        to_i, to_j = half * (one - swept_i), half * (one - swept_j)
                        rho_l, rho_r = read.real(rho, j) + to_j * rho_over, rho_i - to_i * rho_over
                        if rho_l > zero and rho_r > zero:
                            sound = of_volume(
                                u_over, half * r * (wp.trace(L_i) + wp.trace(read.mat(dvdx, j)))
                            )
                            u_l = u_j + half * (u_over - swept_j * sound)
                            u_r = u_i - half * (u_over - swept_i * sound)
                            left = side(u_l, read.real(p, j) + to_j * p_over, rho_l, read.real(cs, j), left.A)
                            right = side(u_r, p_i - to_i * p_over, rho_r, cs_i, A_i)
                u_star, p_star = interface(left, right, bears)
                flux = -two * read.real(vol, j) * p_star
                if wp.static(corrected):
                    w_ij = wp.where(near, w(r, h), zero)
                    g_ij = of_pair(xij, dw, w_ij, read.mat(K, own), read.vec(G, own), h, gradient_ratio)
                    other = j * on
                    K_j, G_j = (
                        mirror.tensor(read.mat(K, other), sign),
                        mirror.vector(read.vec(G, other), sign),
                    )
                    q = half * (g_ij - of_pair(-xij, dw, w_ij, K_j, G_j, h, gradient_ratio))
                    dv = half * (vj - vi) + (u_star - half * (u_i + u_j)) * e
                    kicked_j = mirror.vector(read.vec(v, j), sign)
                    dv_kicked = (
                        half * (kicked_j - kicked_i) + (u_star - half * dot(kicked_i + kicked_j, e)) * e
                    )
                    rate += two * read.real(vol, j) * dot(dv, g_ij)
                    power += flux * dot(dv_kicked, q)
                    f = flux * q
                    f_x += f[0]
                    f_y += f[1]
                    f_z += f[2]
                else:
                    rate += two * read.real(vol, j) * (u_star - u_i) * (dw * r)
                    power += flux * (u_star - dot(kicked_i, e)) * (dw * r)
                    f = (flux * dw) * xij
                    f_x += f[0]
                    if wp.static(dim > 1):
                        f_y += f[1]
                    if wp.static(dim > 2):
                        f_z += f[2]
            k += stride
        per_mass = vol[i] / m[i]
        dvdt[i] = per_mass * vec(f_x, f_y, f_z)
        dedt[i] = per_mass * power
        div[i] = rate
        mu[i] = value(mu_top)

    return hydrodynamic
