"""Constitutive update: density, deviator, plastic flow, pressure (method sections 7 and 8)."""

import functools

import warp as wp

from .eos import make_eos
from .material import make_material
from .spec import Spec
from .strength import make_strength
from .tensor import make_tensor

PLANE_STRESS_TOLERANCE = 1.0e-9
"""Plane stress: sigma_zz is driven below this share of K + 4G/3."""


@functools.cache
def make_constitutive(s: Spec, plane_stress: bool) -> wp.Kernel:
    """Build the update; ``plane_stress`` (2D) finds the thickness rate that leaves sigma_zz = 0."""
    real, matrix = s.real, s.mat
    Material, eos, strength, tensor = make_material(s), make_eos(s), make_strength(s), make_tensor(s)
    one, zero, stiff = real(1.0), real(0.0), real(4.0 / 3.0)
    tolerance = real(PLANE_STRESS_TOLERANCE if s.real is wp.float64 else 1.0e-5)

    @wp.func
    def trial(m: Material, L: matrix, dt: real, rho: real, e: real, tau: matrix, ep: real):
        """One strain increment: ρ' = ρ exp(-dt tr L), Jaumann + 2 G dev D, radial return, EOS, cut-off."""
        rho_new = rho * wp.exp(-dt * wp.trace(L))
        tau_new = tensor.rotate(tau, L, dt) + (real(2.0) * m.G * dt) * tensor.deviator(tensor.stretch(L))
        tau_new, d_ep = strength.return_map(m, tau_new, ep)
        p, c, out_of_range = eos(m, rho_new, e)
        return rho_new, tau_new, d_ep, wp.max(p, m.p_min), c, out_of_range

    if plane_stress:

        @wp.func
        def update(m: Material, L: matrix, dt: real, rho: real, e: real, tau: matrix, ep: real, c_old: real):
            """Secant search for L_zz with sigma_zz = 0, started with the elastic slope dt (K + 4G/3)."""
            modulus = rho * c_old * c_old + stiff * m.G
            L0 = zero
            rho_new, tau_new, d_ep, p, c, out = trial(m, L, dt, rho, e, tau, ep)
            f0 = tau_new[2, 2] - p
            L1 = L0 - f0 / (dt * modulus)
            for _k in range(20):
                if wp.abs(f0) > tolerance * modulus:
                    L[2, 2] = L1
                    rho_new, tau_new, d_ep, p, c, out = trial(m, L, dt, rho, e, tau, ep)
                    f1 = tau_new[2, 2] - p
                    slope = dt * modulus
                    if wp.abs(f1 - f0) > zero and (f1 - f0) / (L1 - L0) > real(0.1) * slope:
                        slope = (f1 - f0) / (L1 - L0)
                    L0, f0 = L1, f1
                    L1 = L0 - f0 / slope
            return rho_new, tau_new, d_ep, p, c, out, L[2, 2]

    else:

        @wp.func
        def update(m: Material, L: matrix, dt: real, rho: real, e: real, tau: matrix, ep: real, c_old: real):
            rho_new, tau_new, d_ep, p, c, out = trial(m, L, dt, rho, e, tau, ep)
            return rho_new, tau_new, d_ep, p, c, out, zero

    @wp.kernel(module=s.module(__name__, "plane_stress" if plane_stress else ""))
    def constitutive(
        offset: wp.int32,
        # in:
        dvdx: wp.array[matrix],
        e: wp.array[real],
        m: wp.array[real],
        mat: wp.array[wp.int32],
        materials: wp.array[Material],
        dt: wp.array[real],
        # out:
        rho: wp.array[real],
        tau: wp.array[matrix],
        ep: wp.array[real],
        p: wp.array[real],
        cs: wp.array[real],
        cl: wp.array[real],
        sig: wp.array[matrix],
        vol: wp.array[real],
        thickness: wp.array[real],
        p_high: wp.array[real],
        p_low: wp.array[real],
        clipped: wp.array[wp.int32],
    ):
        """ρ, τ, ε_p, p, c and σ = τ - p I after the step (sections 7-8), from dvdx and e at its end.

        In plane stress σ and the volume are those of the sheet: σ times, and V over, the thickness ratio.
        """
        i = wp.tid() + offset
        if dt[0] == zero:
            return
        row = materials[mat[i]]
        rho_i, tau_i, d_ep, p_i, c_i, out, L_zz = update(
            row, dvdx[i], dt[0], rho[i], e[i], tau[i], ep[i], cs[i]
        )
        sheet = one
        if wp.static(plane_stress):
            sheet = thickness[i] * wp.exp(dt[0] * L_zz)
            thickness[i] = sheet
        rho[i] = rho_i
        tau[i] = tau_i
        ep[i] = ep[i] + d_ep
        p[i] = p_i
        cs[i] = c_i
        cl[i] = wp.sqrt(c_i * c_i + stiff * row.G / rho_i)
        sig[i] = sheet * (tau_i - p_i * wp.identity(n=3, dtype=real))
        vol[i] = m[i] / (rho_i * sheet)
        p_high[i] = wp.max(p_high[i], p_i)
        p_low[i] = wp.min(p_low[i], p_i)
        clipped[i] = clipped[i] + out

    return constitutive
