"""The Godunov schemes: one step as an ordered list of launches (method sections 10 and 11; Connolly et al. 2013)."""

import warp as wp

from warpsph.config import Numerics
from warpsph.device.launch import Command
from warpsph.kernels.godunov_deviatoric import make_deviatoric
from warpsph.kernels.godunov_hydrodynamic import Reconstruction, make_hydrodynamic
from warpsph.kernels.godunov_pm import make_godunov_pm
from warpsph.kernels.kinematics import make_kinematics
from warpsph.kernels.spec import Spec

from . import GodunovSettings
from .scheme import Bind, Scheme, Traits, bound


class Godunov(Scheme):
    """What both families share: no artificial viscosity, only the jump of the Riemann problems limits the step."""

    viscosity_alpha = 0.0
    viscosity_beta = 2.0


class ParshikovMedin(Godunov):
    """All waves of a pair in one loop (`pm`; `con` of Young et al.)."""

    def __init__(self, settings: GodunovSettings, spec: Spec, numerics: Numerics, traits: Traits):
        """Pick the kernels; nothing is compiled before the first launch."""
        s, planes, fragile = settings, traits.planes, traits.fragile
        super().__init__(
            spec, numerics, correction=s.correction, gradient_ratio=s.gradient_ratio,
            exact_energy=s.exact_energy, traits=traits,
        )  # fmt: skip
        self._fluxes = make_godunov_pm(spec, self.smoothing, numerics.riemann, fragile, s.correction, planes)

    def probe(self, bind: Bind) -> list[Command]:
        """Forces and approach speeds."""
        return bound(bind, self._correction, self._fluxes)

    def step(self, bind: Bind) -> list[Command]:
        """One step from (x, v, e, ρ, τ) at t to t + dt."""
        return bound(
            bind,
            self._correction,  # S, G, K at x
            self._fluxes,  # A, B and L from v* and t* at x
            self._integrate.kick,  # v' = v + dt A, e' exact in energy
            self._constitutive,  # ρ', τ', ε_p', p', σ'
            self._integrate.drift,  # x' = x + dt v'
        )


class TimeSplit(Godunov):
    """Deviatoric and hydrodynamic stages, one after the other (`ts1`, `ts2`)."""

    def __init__(self, settings: GodunovSettings, spec: Spec, numerics: Numerics, traits: Traits):
        """Pick the kernels; nothing is compiled before the first launch."""
        s, planes, fragile = settings, traits.planes, traits.fragile
        super().__init__(
            spec, numerics, correction=s.correction, gradient_ratio=s.gradient_ratio, split=True, traits=traits
        )  # fmt: skip
        self.limiter_beta = numerics.limiter_beta
        self._second = s.order == 2
        states = Reconstruction(numerics.riemann, s.order, numerics.limiter, numerics.limit_jump, fragile)
        self._deviatoric = make_deviatoric(spec, self.smoothing, s.order, s.correction, planes)
        self._hydrodynamic = make_hydrodynamic(spec, self.smoothing, states, s.correction, planes)
        self._velocity_gradient = make_kinematics(spec, self.smoothing, s.correction, planes)

    def arrays(self, n: int) -> dict[str, wp.array]:
        """Add the volume rate, the slopes of the reconstruction, and v at the start of the step."""
        vec, sloped = self._spec.vec, n if self._second else 1
        return super().arrays(n) | {
            "div": wp.zeros(n, dtype=self._spec.real),
            "grad_p": wp.zeros(sloped, dtype=vec),
            "grad_rho": wp.zeros(sloped, dtype=vec),
            "v_start": wp.zeros(n, dtype=vec),
        }

    def probe(self, bind: Bind) -> list[Command]:
        """Forces and approach speeds."""
        return bound(bind, self._correction, self._deviatoric, self._velocity_gradient, self._hydrodynamic)

    def step(self, bind: Bind) -> list[Command]:
        """One step from (x, v, e, ρ, τ) at t to t + dt."""
        return bound(
            bind,
            self._correction,  # S, G, K at x
            self._deviatoric,  # A and B from τ, slopes of p and ρ
            self._integrate.kick,  # v~ = v + dt A, u~ exact in energy
            self._hydrodynamic,  # A, B and div v from the Riemann problems on p, v, ρ
            self._integrate.kick,  # v' = v~ + dt A, u' exact in energy
            self._velocity_gradient,  # L from v' at x
            self._constitutive,  # ρ' from div v, τ', ε_p', p', σ'
            self._integrate.drift_mean,  # x' = x + dt (v + v')/2
        )
