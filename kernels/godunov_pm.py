"""Parshikov & Medin's scheme: every pair solves Riemann problems of its longitudinal and transverse waves."""

import functools

import warp as wp

from .correction import make_gradient
from .interface import CLOSEST, make_interface
from .lanes import make_lanes, make_reads
from .material import make_material
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor


@functools.cache
def make_godunov_pm(
    s: Spec, smoothing: Smoothing, riemann: str, fragile: bool, corrected: bool, planes: bool
) -> wp.Kernel:
    """Build the pair loop; ``fragile``: some material bears no tension, or none once it has failed."""
    real, vec, matrix, point = s.real, s.vec, s.mat, s.point
    mirror, tensor, of_pair = make_mirror(s, planes), make_tensor(s), make_gradient(s, corrected)
    side, interface = make_interface(s, riemann)
    Material = make_material(s)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    dot, act = tensor.dot, tensor.act
    zero, half, one, two = real(0.0), real(0.5), real(1.0), real(2.0)
    closest = real(CLOSEST)
    read = make_reads(s)
    lanes = make_lanes(s)
    worth, raised, value, row_end, Bits = lanes.worth, lanes.raised, lanes.value, lanes.row_end, lanes.Bits
    stride = lanes.stride
    shear_share = real(0.75)
    dim, on = s.dim, wp.constant(int(corrected))
    flags = ("fragile" * fragile, "corrected" * corrected, "planes" * planes)
    options = (smoothing.name, riemann.replace("-", "_"), *flags)

    @wp.func
    def shear_impedance(rho: real, cs: real, cl: real):
        """Impedance ρ c_t of transverse waves: c_t² = G/ρ = 3/4 (c_l² - c²)."""
        return rho * wp.sqrt(wp.max(shear_share * (cl * cl - cs * cs), zero))

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def pair_fluxes(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        v: wp.array[vec],
        m: wp.array[real],
        rho: wp.array[real],
        vol: wp.array[real],
        cs: wp.array[real],
        cl: wp.array[real],
        sig: wp.array[s.sym],
        D: wp.array[real],
        mat: wp.array[wp.int32],
        materials: wp.array[Material],
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
        dvdx: wp.array[matrix],
        mu: wp.array[real],
    ):
        """dvdt = Σ f_ab/m_a [m/s²], dedt = Σ f_ab·(v* - v_a)/m_a [W/kg], dvdx = 2 Σ V_b (v* - v_a) ⊗ g_ab [1/s].

        f_ab = 2 V_a V_b t* (e·q_ab), q_ab = (g_ab - g_ba)/2, with the velocity v* and the traction t* of the plane
        normal to e, the direction from b to a (section 10; Connolly et al. 2013, Eqs. 15-16). The transverse problem
        is solved for the vector, which is the same as for any two of its components.
        mu = largest approach speed [m/s].
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        first = start[i]
        last = row_end(first, n_neigh[i])
        own = i * on  # K and G are one long where there is no correction
        xi, vi, sig_i = read.point(x, i), read.vec(v, i), sig[i]
        rho_i, cl_i = rho[i], cl[i]
        Zt_i = shear_impedance(rho_i, cs[i], cl_i)
        A_i = materials[mat[i]].A_shock
        bears_i = True
        if wp.static(fragile):
            bears_i = D[i] < materials[mat[i]].D_tension
        r_max2, closest2 = support * support * h * h, closest * closest * h * h
        # scalars, not vectors or matrices: the compiler keeps them in registers
        f_x, f_y, f_z, power = real(0.0), real(0.0), real(0.0), real(0.0)
        mu_top = Bits(0)
        xx, xy, xz = real(0.0), real(0.0), real(0.0)
        yx, yy, yz = real(0.0), real(0.0), real(0.0)
        zx, zy, zz = real(0.0), real(0.0), real(0.0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            sign = mirror.sign(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), sign, plane)
            r2 = dot(xij, xij)
            near = r2 < r_max2 and read.integer(neigh, k) != i
            if worth(near):
                r = wp.sqrt(wp.max(wp.where(near, r2, h * h), closest2))
                dw, w_ij = wp.where(near, dw_r(r, h), zero), zero
                if wp.static(corrected):
                    w_ij = wp.where(near, w(r, h), zero)
                g = of_pair(xij, dw, w_ij, read.mat(K, own), read.vec(G, own), h, gradient_ratio)
                e = (one / r) * xij
                slope = dot(e, g)
                if wp.static(corrected):
                    other = j * on
                    K_j, G_j = (
                        mirror.tensor(read.mat(K, other), sign),
                        mirror.vector(read.vec(G, other), sign),
                    )
                    slope = half * (slope - dot(e, of_pair(-xij, dw, w_ij, K_j, G_j, h, gradient_ratio)))
                vj = mirror.vector(read.vec(v, j), sign)
                t_i, t_j = act(sig_i, e), act(mirror.symmetric(read.sym(sig, j), sign), e)
                u_i, u_j, p_i, p_j = dot(vi, e), dot(vj, e), -dot(t_i, e), -dot(t_j, e)
                mu_top = raised(mu_top, wp.where(near and u_j > u_i, u_j - u_i, zero))
                left = side(
                    u_j, p_j, read.real(rho, j), read.real(cl, j), materials[read.integer(mat, j)].A_shock
                )
                right = side(u_i, p_i, rho_i, cl_i, A_i)
                bears = bears_i
                if wp.static(fragile):
                    bears = bears and read.real(D, j) < materials[read.integer(mat, j)].D_tension
                u_star, p_star = interface(left, right, bears)
                # the transverse vectors, by the acoustic solver; no traction between fluids, nor where the pair comes apart
                Zt_j = shear_impedance(read.real(rho, j), read.real(cs, j), read.real(cl, j))
                vt_i, vt_j = vi - u_i * e, vj - u_j * e
                s_i, s_j = t_i + p_i * e, t_j + p_j * e
                slide = Zt_i + Zt_j == zero or not (bears or p_star > zero)
                Z = wp.where(slide, zero, one / (Zt_i + Zt_j))
                to_i, to_j = wp.where(slide, half, Z * Zt_i), wp.where(slide, half, Z * Zt_j)
                vt = to_j * vt_j + to_i * vt_i + Z * (s_i - s_j)
                st = Z * (Zt_i * s_j + Zt_j * s_i + (Zt_i * Zt_j) * (vt_i - vt_j))
                dv = (u_star * e + vt) - vi
                t = (two * read.real(vol, j) * slope) * (st - p_star * e)
                power += dot(t, dv)
                f_x += t[0]
                u = (two * read.real(vol, j)) * dv
                xx += u[0] * g[0]
                if wp.static(dim > 1):
                    f_y += t[1]
                    xy += u[0] * g[1]
                    yx += u[1] * g[0]
                    yy += u[1] * g[1]
                if wp.static(dim > 2):
                    f_z += t[2]
                    xz += u[0] * g[2]
                    yz += u[1] * g[2]
                    zx += u[2] * g[0]
                    zy += u[2] * g[1]
                    zz += u[2] * g[2]
            k += stride
        per_mass = vol[i] / m[i]
        dvdt[i] = per_mass * vec(f_x, f_y, f_z)
        dedt[i] = per_mass * power
        dvdx[i] = matrix(xx, xy, xz, yx, yy, yz, zx, zy, zz)
        mu[i] = value(mu_top)

    return pair_fluxes
