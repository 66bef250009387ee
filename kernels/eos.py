"""Equations of state p(ρ, e) with their isentropic sound speed, and the switch over them.

Each is a device function ``(m: Material, rho, e) -> (p [Pa], c [m/s], out_of_range)``. The sound speed is the
analytic c² = ∂p/∂ρ|e + p/ρ² ∂p/∂e|ρ. ``out_of_range`` is 1 where the law has no answer (ρ/ρ0 below `ETA_MIN`, a
shock denominator below `DENOMINATOR_MIN`, c² < 0, a gas with ρ <= 0 or e < 0); p and c are finite there too, and
c never falls below ``m.c_min``. A state that is not a number stays one, so that the run finds it.
ζ = ρ/ρ0 - 1 and η = ρ/ρ0 throughout.
"""

import functools
from collections.abc import Callable

import warp as wp

from .material import EosId, make_material
from .spec import Spec

ETA_MIN = 1e-3
"""Lowest ρ/ρ0 at which the law of a solid is evaluated: below it the pressure stays as it is there."""

DENOMINATOR_MIN = 0.01
"""Lowest value of a shock denominator 1 - (S1 - 1) ζ - …; it equals η c0/Us, so this is far beyond any impact."""


@functools.cache
def _sound_speed(real: type, Material: type) -> wp.Function:
    @wp.func
    def sound_speed(m: Material, c2: real):
        """Root of c² with the floor ``m.c_min``; the flag tells c² < 0."""
        out = wp.int32(0)
        if c2 < real(0.0):
            out = wp.int32(1)
        if c2 < m.c_min * m.c_min:
            return m.c_min, out
        return wp.sqrt(c2), out

    return sound_speed


@functools.cache
def _compression(real: type, Material: type) -> wp.Function:
    eta_min = real(ETA_MIN)

    @wp.func
    def compression(m: Material, rho: real):
        """ζ = ρ/ρ0 - 1, held at ``ETA_MIN`` - 1; the flag tells that it was."""
        eta = rho / m.rho0
        if eta < eta_min:
            return eta_min - real(1.0), wp.int32(1)
        return eta - real(1.0), wp.int32(0)

    return compression


def _linear_elastic(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)

    @wp.func
    def linear_elastic(m: Material, rho: real, e: real):
        """Pressure p = K ζ; c² = K/ρ0."""
        z, out = compression(m, rho)
        c, imaginary = sound_speed(m, m.K / m.rho0)
        return m.K * z, c, wp.max(out, imaginary)

    return linear_elastic


def _stiffened_gas(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)

    @wp.func
    def stiffened_gas(m: Material, rho: real, e: real):
        """Pressure p = c0² (ρ - ρ0) + (γ0 - 1) ρ e; c² = c0² + (γ0 - 1)(e + p/ρ) (Young et al., Eq. 17)."""
        z, out = compression(m, rho)
        r = m.rho0 * (real(1.0) + z)
        gain = m.gamma0 - real(1.0)
        p = m.rho0 * m.c0 * m.c0 * z + gain * r * e
        c, imaginary = sound_speed(m, m.c0 * m.c0 + gain * (e + p / r))
        return p, c, wp.max(out, imaginary)

    return stiffened_gas


def _isothermal_mie_grueneisen(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)
    D_min = real(DENOMINATOR_MIN)

    @wp.func
    def isothermal_mie_grueneisen(m: Material, rho: real, e: real):
        """Pressure p = ρ0 c0² ζ/D, D = 1 - (S1 - 1) ζ; c = c0/D (Connolly et al. 2013, Eq. 36, D not squared)."""
        z, out = compression(m, rho)
        D = real(1.0) - (m.S1 - real(1.0)) * z
        if D < D_min:
            D = D_min
            out = wp.int32(1)
        c, imaginary = sound_speed(m, m.c0 * m.c0 / (D * D))
        return m.rho0 * m.c0 * m.c0 * z / D, c, wp.max(out, imaginary)

    return isothermal_mie_grueneisen


def _shock_mie_grueneisen(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)
    D_min = real(DENOMINATOR_MIN)

    @wp.func
    def shock_mie_grueneisen(m: Material, rho: real, e: real):
        """Pressure p = ρ0 c0² N/D² + Γ0 ρ0 e, N = ζ (η - Γ0 ζ/2), D = η - S1 ζ (Connolly et al. 2013, Eq. 37).

        c² = c0² (N'/D² + 2 (S1 - 1) N/D³) + Γ0 p/(ρ0 η²), ' = d/dζ.
        """
        z, out = compression(m, rho)
        eta = real(1.0) + z
        b = real(1.0) - real(0.5) * m.Gamma0
        D = real(1.0) - (m.S1 - real(1.0)) * z
        if D < D_min:
            D = D_min
            out = wp.int32(1)
        N = z * (real(1.0) + b * z)
        dN = real(1.0) + real(2.0) * b * z
        c02 = m.c0 * m.c0
        p = m.rho0 * (c02 * N / (D * D) + m.Gamma0 * e)
        slope = c02 * (dN + real(2.0) * (m.S1 - real(1.0)) * N / D) / (D * D)
        c, imaginary = sound_speed(m, slope + m.Gamma0 * p / (m.rho0 * eta * eta))
        return p, c, wp.max(out, imaginary)

    return shock_mie_grueneisen


def _cubic_grueneisen(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)
    D_min = real(DENOMINATOR_MIN)

    @wp.func
    def cubic_grueneisen(m: Material, rho: real, e: real):
        """Pressure p = ρ0 c0² N/D² + (Γ0 + a ζ) ρ0 e, in tension ρ0 c0² ζ + (Γ0 + a ζ) ρ0 e (LS-DYNA's *EOS_GRUNEISEN).

        N = ζ [1 + (1 - Γ0/2) ζ - a/2 ζ²], D = 1 - (S1 - 1) ζ - S2 ζ²/η - S3 ζ³/η²;
        c² = c0² (N'/D² - 2 N D'/D³) + a e + (Γ0 + a ζ) p/(ρ0 η²), ' = d/dζ.
        """
        z, out = compression(m, rho)
        eta = real(1.0) + z
        hugoniot, slope = z, real(1.0)
        if z > real(0.0):
            u = z / eta
            b = real(1.0) - real(0.5) * m.Gamma0
            N = z * (real(1.0) + z * (b - real(0.5) * m.a * z))
            dN = real(1.0) + z * (real(2.0) * b - real(1.5) * m.a * z)
            D = real(1.0) - z * (m.S1 - real(1.0) + u * (m.S2 + u * m.S3))
            dD = real(1.0) - m.S1 - u * (real(2.0) - u) * m.S2 - u * u * (real(3.0) - real(2.0) * u) * m.S3
            if D < D_min:
                D = D_min
                out = wp.int32(1)
            hugoniot = N / (D * D)
            slope = (dN - real(2.0) * N * dD / D) / (D * D)
        c02 = m.c0 * m.c0
        G = m.Gamma0 + m.a * z
        p = m.rho0 * (c02 * hugoniot + G * e)
        c, imaginary = sound_speed(m, c02 * slope + m.a * e + G * p / (m.rho0 * eta * eta))
        return p, c, wp.max(out, imaginary)

    return cubic_grueneisen


def _polynomial(real: type, Material: type) -> wp.Function:
    compression, sound_speed = _compression(real, Material), _sound_speed(real, Material)

    @wp.func
    def polynomial(m: Material, rho: real, e: real):
        """Pressure p = k1 ζ + k2 ζ² + k3 ζ³ + (B0 + B1 ζ) ρ0 e, k2 = k3 = 0 in tension (Connolly et al. 2013, Eq. 39).

        c² = (k1 + 2 k2 ζ + 3 k3 ζ²)/ρ0 + B1 e + (B0 + B1 ζ) p/(ρ0 η²).
        """
        z, out = compression(m, rho)
        eta = real(1.0) + z
        k2, k3 = real(m.k2), real(m.k3)
        if z < real(0.0):
            k2, k3 = real(0.0), real(0.0)
        B = m.B0 + m.B1 * z
        p = z * (m.k1 + z * (k2 + z * k3)) + B * m.rho0 * e
        slope = (m.k1 + z * (real(2.0) * k2 + real(3.0) * z * k3)) / m.rho0 + m.B1 * e
        c, imaginary = sound_speed(m, slope + B * p / (m.rho0 * eta * eta))
        return p, c, wp.max(out, imaginary)

    return polynomial


def _ideal_gas(real: type, Material: type) -> wp.Function:
    sound_speed = _sound_speed(real, Material)

    @wp.func
    def ideal_gas(m: Material, rho: real, e: real):
        """Pressure p = (γ - 1) ρ e; c² = γ (γ - 1) e. No pressure where ρ <= 0 or e < 0."""
        gain = m.gamma - real(1.0)
        p, out = gain * rho * e, wp.int32(0)
        if rho <= real(0.0) or e < real(0.0):
            p, out = real(0.0), wp.int32(1)
        c, imaginary = sound_speed(m, m.gamma * gain * e)
        return p, c, wp.max(out, imaginary)

    return ideal_gas


MODELS: dict[EosId, Callable[[type, type], wp.Function]] = {
    EosId.LINEAR_ELASTIC: _linear_elastic,
    EosId.STIFFENED_GAS: _stiffened_gas,
    EosId.ISOTHERMAL_MIE_GRUENEISEN: _isothermal_mie_grueneisen,
    EosId.SHOCK_MIE_GRUENEISEN: _shock_mie_grueneisen,
    EosId.CUBIC_GRUENEISEN: _cubic_grueneisen,
    EosId.POLYNOMIAL: _polynomial,
    EosId.IDEAL_GAS: _ideal_gas,
}
"""Every equation of state; a new one is one function above, one row here and one dataclass on the host."""


@functools.cache
def _eos(real: type, Material: type) -> wp.Function:
    ids = tuple(int(i) for i in MODELS)
    models = tuple(make(real, Material) for make in MODELS.values())

    @wp.func
    def eos(m: Material, rho: real, e: real):
        """Pressure p [Pa], sound speed c [m/s] and out_of_range of the material's own equation of state."""
        p, c, out = real(0.0), real(0.0), wp.int32(0)
        for k in range(wp.static(len(ids))):
            if m.eos == wp.static(ids[k]):
                p, c, out = wp.static(models[k])(m, rho, e)
        return p, c, out

    return eos


def make_eos(s: Spec) -> wp.Function:
    """Give the switch ``eos(m: Material, rho, e) -> (p, c, out_of_range)`` of one specialisation."""
    return _eos(s.real, make_material(s))
