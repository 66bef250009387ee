"""One row of the material table: what the device functions of EOS, strength and damage read."""

import enum
import functools

import warp as wp

from .spec import Spec


class EosId(enum.IntEnum):
    """Equation of state of a material; the switch in ``eos.py`` has one row for each."""

    LINEAR_ELASTIC = 0
    STIFFENED_GAS = 1
    ISOTHERMAL_MIE_GRUENEISEN = 2
    SHOCK_MIE_GRUENEISEN = 3
    CUBIC_GRUENEISEN = 4
    POLYNOMIAL = 5
    IDEAL_GAS = 6


class StrengthId(enum.IntEnum):
    """Strength law of a material; the switch in ``strength.py`` has one row for each.

    Laws whose flow stress is linear in the plastic strain come first.
    """

    FLUID = 0
    ELASTIC = 1
    PERFECTLY_PLASTIC = 2
    LINEAR_HARDENING = 3
    JOHNSON_COOK = 4
    JOHNSON_HOLMQUIST_1 = 5


FIRST_NONLINEAR = StrengthId.JOHNSON_COOK
"""From this strength law on the return needs an iteration, and there may be temperature and damage."""


class DamageId(enum.IntEnum):
    """Damage law of a material; the switch in ``damage.py`` has one row for each but the first."""

    NONE = 0
    JOHNSON_COOK = 1
    JOHNSON_HOLMQUIST_1 = 2


@functools.cache
def _material(real: type) -> type:
    """Build the struct of one precision: a material does not know the dimension."""

    @wp.struct
    class Material:
        """Constants of one material in SI units, by the letters of the laws that use them; unused ones are 0."""

        eos: wp.int32  # EosId
        strength: wp.int32  # StrengthId
        damage: wp.int32  # DamageId
        rho0: real  # reference density [kg/m^3]
        c_min: real  # floor of the sound speed [m/s]
        p_min: real  # pressure cut-off [Pa], -inf for none
        D_tension: real  # damage from which on it bears no tension: 1 failed, 0 for a gas, inf for never
        D_shear: real  # the same for the shear of a Johnson-Cook metal
        A_shock: real  # slope of the shock velocity, Us = c + A_shock u
        # equation of state
        K: real
        c0: real
        gamma0: real
        S1: real
        S2: real
        S3: real
        Gamma0: real
        a: real
        k1: real
        k2: real
        k3: real
        B0: real
        B1: real
        gamma: real
        # strength
        G: real
        Y: real
        H: real
        # Johnson-Cook
        A: real
        B: real
        n: real
        m: real
        C: real
        rate0: real
        T0: real
        Tm: real
        Cv: real
        chi: real
        D1: real
        D2: real
        D3: real
        D4: real
        D5: real
        # Johnson-Holmquist 1, with C and rate0 as above; its pressure of failure T is P_T here, T is a temperature
        P_T: real
        P1: real
        s1: real
        P2: real
        s2: real
        cf: real
        sf_max: real
        eps_f_max: real
        P_max: real

    return Material


def make_material(s: Spec) -> type:
    """Give the struct of one specialisation; specialisations of one precision share it."""
    return _material(s.real)
