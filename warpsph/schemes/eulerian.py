"""The Eulerian scheme: one step as an ordered list of launches (method sections 3, 7 and 11; paper A eq 1)."""

import warp as wp

from warpsph.config import Numerics
from warpsph.device.launch import Command
from warpsph.kernels.artificial_stress import make_artificial_stress
from warpsph.kernels.coupling import Coupling
from warpsph.kernels.kinematics import make_kinematics
from warpsph.kernels.momentum_eulerian import PairTerms, make_momentum
from warpsph.kernels.parts import ARTIFICIAL, VISCOUS
from warpsph.kernels.spec import Spec
from warpsph.kernels.viscosity import MORRIS_MIN, make_switches

from . import EulerianSettings, LagrangianSettings
from .scheme import Bind, Scheme, Traits, bound


def viscosity(settings: EulerianSettings | LagrangianSettings, numerics: Numerics) -> tuple[float, float]:
    """α and β of the artificial viscosity: the scene's, or else the scheme's own."""
    alpha, beta = numerics.viscosity_alpha, numerics.viscosity_beta
    return settings.alpha if alpha is None else alpha, settings.beta if beta is None else beta


class Eulerian(Scheme):
    """Kernels and constants of the Eulerian family."""

    def __init__(self, settings: EulerianSettings, spec: Spec, numerics: Numerics, traits: Traits):
        """Pick the kernels; nothing is compiled before the first launch."""
        s, planes = settings, traits.planes
        switched, parts = s.viscosity != "monaghan", (VISCOUS, *([ARTIFICIAL] * s.artificial_stress))
        super().__init__(
            spec, numerics, correction=s.correction, gradient_ratio=s.gradient_ratio,
            exact_energy=s.exact_energy, parts=parts, switched=switched, traits=traits,
        )  # fmt: skip
        self.viscosity_alpha, self.viscosity_beta = viscosity(s, numerics)
        self.first_switch = MORRIS_MIN if s.viscosity == "morris" else 1.0
        coupling = Coupling(separate=numerics.contact is not None)
        terms = PairTerms(s.correction, switched, s.artificial_stress, planes, coupling, self.parts)
        self._momentum = make_momentum(spec, self.smoothing, terms)
        self._velocity_gradient = make_kinematics(
            spec, self.smoothing, s.correction, planes, coupling.separate
        )
        self._switch = getattr(make_switches(spec), s.viscosity) if switched else None
        self._artificial_stress = make_artificial_stress(spec) if s.artificial_stress else None

    def arrays(self, n: int) -> dict[str, wp.array]:
        """Add the artificial stress R."""
        stressed = n if self._artificial_stress else 1
        return super().arrays(n) | {"R": wp.zeros(stressed, dtype=self._spec.sym)}

    def probe(self, bind: Bind) -> list[Command]:
        """Forces and approach speeds."""
        return bound(bind, self._correction, self._momentum, self._contact)

    def derive(self, bind: Bind) -> list[Command]:
        """R from σ."""
        return bound(bind, self._artificial_stress)

    def step(self, bind: Bind) -> list[Command]:
        """One step from (x, v, e, ρ, τ) at t to t + dt."""
        return bound(
            bind,
            self._correction,  # S, G, K at x
            self._momentum,  # A and B from σ at x
            self._contact,  # and from other bodies
            self._integrate.kick,  # v' = v + dt A, e' exact in energy
            self._velocity_gradient,  # L from v' at x
            self._switch,  # BAL, MON
            self._constitutive,  # ρ', τ', ε_p', p', σ'
            self._artificial_stress,  # R from σ'
            self._integrate.drift,  # x' = x + dt v'
        )
