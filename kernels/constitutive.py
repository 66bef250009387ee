"""Constitutive update: density, pressure, deviator, plastic flow, damage (method sections 7 and 8)."""

import functools
import hashlib
import inspect

import warp as wp

from . import damage as damage_laws
from . import eos as eos_laws
from . import strength as strength_laws
from .damage import make_damage
from .deformation import INVERTED
from .eos import ETA_MIN, make_eos
from .index import natural
from .kernel_type import ERODED, LAGRANGIAN
from .material import FIRST_NONLINEAR, make_material
from .spec import Spec
from .strength import make_strength
from .tensor import make_tensor

PLANE_STRESS_TOLERANCE = 1.0e-9
"""Plane stress: sigma_zz is driven below this share of K + 4G/3."""

THICKNESS_STEP = 1.0
"""Largest logarithmic strain across a sheet in a step: hot or torn matter may have no thickness without stress."""

UNMET = 1.0e-3
"""A sigma_zz that stays above this share counts as out of range: no thickness will do."""


@functools.cache
def laws_text() -> str:
    """Tell one text of the material laws from another: they are in tables, which Warp does not look into."""
    texts = map(inspect.getsource, (eos_laws, strength_laws, damage_laws))
    return hashlib.sha256("".join(texts).encode()).hexdigest()[:16]


@functools.cache
def make_constitutive(s: Spec, plane_stress: bool, split: bool, lagrangian: bool = False) -> wp.Kernel:
    """Build the update.

    Args:
        s: Specialisation.
        plane_stress: Find the thickness rate that leaves sigma_zz = 0 (2D).
        split: The density follows a rate of its own, ``div``, not tr L: a Riemann scheme sums them apart.
        lagrangian: There are Lagrangian particles: their density is ρ0/J.
    """
    real, matrix, sym = s.real, s.mat, s.sym
    Material, tensor, eos = make_material(s), make_tensor(s), make_eos(s)
    strength, damage, nonlinear = make_strength(s), make_damage(s), int(FIRST_NONLINEAR)
    one, zero, stiff = real(1.0), real(0.0), real(4.0 / 3.0)
    widest, thinnest, unmet = real(THICKNESS_STEP), real(ETA_MIN), real(UNMET)
    tolerance = real(PLANE_STRESS_TOLERANCE if s.real is wp.float64 else 1.0e-5)

    @wp.func
    def trial(
        m: Material,
        L: matrix,
        dt: real,
        rho_new: real,
        e: real,
        tau: matrix,
        ep: real,
        T: real,
        D: real,
    ):
        """One strain increment to the density ρ': EOS, cut-off; Jaumann + 2 G dev D, radial return, damage."""
        p, c, out_of_range = eos(m, rho_new, e)
        p = wp.max(p, m.p_min)
        elastic = tensor.rotate(tau, L, dt) + (real(2.0) * m.G * dt) * tensor.deviator(tensor.stretch(L))
        if m.strength < nonlinear:
            tau_new, d_ep = strength.linear_return(m, elastic, ep)
            return tau_new, d_ep, p, c, out_of_range, D
        D_old = damage.tension(m, D, p)
        tau_new, d_ep = strength.nonlinear_return(m, elastic, ep, T, p, D_old, dt)
        D_new = damage.growth(m, D_old, d_ep, d_ep / dt, T, p, tau_new)
        if D_new >= one and D_old < one:  # it fails in this very step, and its strength drops at once
            tau_new, d_ep = strength.nonlinear_return(m, elastic, ep, T, p, D_new, dt)
        return tau_new, d_ep, damage.pressure(m, D_new, p), c, out_of_range, D_new

    if plane_stress:

        @wp.func
        def update(
            m: Material,
            L: matrix,
            dt: real,
            rho: real,
            e: real,
            tau: matrix,
            ep: real,
            T: real,
            D: real,
            c_old: real,
        ):
            """Secant search for L_zz with sigma_zz = 0, started with the elastic slope dt (K + 4G/3).

            ρ is the density at the end of the step if the thickness does not change. Where no thickness will do, it
            changes as far as it may in a step, and no further where ρ/ρ0 leaves the range from `ETA_MIN` to 1/`ETA_MIN`.
            """
            modulus = rho * c_old * c_old + stiff * m.G
            most, eta = widest / dt, rho / m.rho0
            lowest = wp.clamp(wp.log(thinnest * eta) / dt, -most, zero)
            highest = wp.clamp(wp.log(eta / thinnest) / dt, zero, most)
            L0 = zero
            rho_new = real(rho)
            tau_new, d_ep, p, c, out, D_new = trial(m, L, dt, rho, e, tau, ep, T, D)
            f0 = tau_new[2, 2] - p
            L1 = wp.clamp(L0 - f0 / (dt * modulus), lowest, highest)
            for _k in range(20):
                if wp.abs(f0) > tolerance * modulus:
                    L[2, 2] = L1
                    rho_new = rho * wp.exp(-dt * L1)
                    tau_new, d_ep, p, c, out, D_new = trial(m, L, dt, rho_new, e, tau, ep, T, D)
                    f1 = tau_new[2, 2] - p
                    slope = dt * modulus
                    if wp.abs(f1 - f0) > zero and (f1 - f0) / (L1 - L0) > real(0.1) * slope:
                        slope = (f1 - f0) / (L1 - L0)
                    L0, f0 = L1, f1
                    L1 = wp.clamp(L0 - f0 / slope, lowest, highest)
            if wp.abs(f0) > unmet * modulus:
                out = wp.int32(1)
            return rho_new, tau_new, d_ep, p, c, out, D_new, L[2, 2]

    else:

        @wp.func
        def update(
            m: Material,
            L: matrix,
            dt: real,
            rho: real,
            e: real,
            tau: matrix,
            ep: real,
            T: real,
            D: real,
            c_old: real,
        ):
            tau_new, d_ep, p, c, out, D_new = trial(m, L, dt, rho, e, tau, ep, T, D)
            return rho, tau_new, d_ep, p, c, out, D_new, zero

    variant = [name for name, on in (
        ("plane_stress", plane_stress), ("split", split), ("lagrangian", lagrangian)
    ) if on]  # fmt: skip

    @wp.kernel(module=s.module(__name__, "_".join(variant), tables=laws_text()))
    def constitutive(
        offset: wp.int32,
        # in:
        dvdx: wp.array[matrix],
        div: wp.array[real],
        e: wp.array[real],
        m: wp.array[real],
        mat: wp.array[wp.int32],
        materials: wp.array[Material],
        F: wp.array[matrix],
        vol0: wp.array[real],
        kernel_type: wp.array[wp.int32],
        fate: wp.array[wp.int32],
        dt: wp.array[real],
        # out:
        rho: wp.array[real],
        tau: wp.array[s.sym],
        ep: wp.array[real],
        ep_rate: wp.array[real],
        T: wp.array[real],
        D: wp.array[real],
        p: wp.array[real],
        cs: wp.array[real],
        cl: wp.array[real],
        sig: wp.array[s.sym],
        vol: wp.array[real],
        thickness: wp.array[real],
        p_high: wp.array[real],
        p_low: wp.array[real],
        clipped: wp.array[wp.int32],
    ):
        """ρ, τ, ε_p, T, D, p, c and σ = τ - p I after the step (sections 7-8), from dvdx and e at its end.

        ρ' = ρ exp(-dt div v), or ρ0/J of a Lagrangian particle whose F is physical (section 4).
        ``div`` is the rate of volume div v [1/s] of a scheme that splits it from dvdx, else 1 long and not read.
        In plane stress σ and the volume are those of the sheet: σ times, and V over, the thickness ratio.
        """
        i = natural(wp.tid() + offset)
        if dt[0] == zero:
            return
        follows = bool(True)  # the rate of volume
        if wp.static(lagrangian):
            if kernel_type[i] == ERODED:
                return
            follows = kernel_type[i] != LAGRANGIAN or fate[i] == wp.static(INVERTED)
        rho_next = real(0.0)
        if follows:
            rate = wp.trace(dvdx[i])
            if wp.static(split):
                rate = div[i]
            rho_next = rho[i] * wp.exp(-dt[0] * rate)
        else:
            vol_next = vol0[i] * wp.determinant(F[i])
            if wp.static(plane_stress):
                vol_next *= thickness[i]
            rho_next = m[i] / vol_next
        row = materials[natural(mat[i])]  # after exp: what is read before a call is kept on the stack
        rho_i, tau_i, d_ep, p_i, c_i, out, D_i, L_zz = update(
            row, dvdx[i], dt[0], rho_next, e[i], tensor.unpack(tau[i]), ep[i], T[i], D[i], cs[i]
        )
        sheet = one
        if wp.static(plane_stress):
            sheet = thickness[i] * wp.exp(dt[0] * L_zz)
            thickness[i] = sheet
        rho[i] = rho_i
        tau[i] = tensor.pack(tau_i)
        ep[i] = ep[i] + d_ep
        ep_rate[i] = d_ep / dt[0]
        if row.strength >= nonlinear:
            T[i] = T[i] + strength.warming(row, tau_i, d_ep, rho_i)
            D[i] = D_i
        p[i] = p_i
        cs[i] = c_i
        specific = one / rho_i
        cl[i] = wp.sqrt(c_i * c_i + stiff * row.G * specific)
        sig[i] = sheet * (tensor.pack(tau_i) - sym(p_i, p_i, p_i, zero, zero, zero))
        vol[i] = m[i] * specific / sheet
        p_high[i] = wp.max(p_high[i], p_i)
        p_low[i] = wp.min(p_low[i], p_i)
        clipped[i] = clipped[i] + out

    return constitutive
