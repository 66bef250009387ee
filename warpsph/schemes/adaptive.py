"""Total Lagrangian and Eulerian particles coupled, the former turning into the latter (AdapTLE; method section 5)."""

from dataclasses import replace

import warp as wp

from warpsph.config import Numerics
from warpsph.device.launch import Command
from warpsph.kernels.artificial_stress import make_artificial_stress
from warpsph.kernels.company import MIXED, PLAIN, make_company
from warpsph.kernels.coupling import PURE, Coupling
from warpsph.kernels.kinematics import make_kinematics
from warpsph.kernels.momentum_eulerian import PairTerms, make_momentum
from warpsph.kernels.momentum_lagrangian import LagrangianTerms, make_momentum_lagrangian
from warpsph.kernels.parts import ARTIFICIAL
from warpsph.kernels.spec import Spec

from . import EulerianSettings, LagrangianSettings
from .lagrangian import Lagrangian
from .scheme import Bind, Traits, bound

NO_EULERIAN = EulerianSettings("monaghan", 0.0, 0.0)
"""The scheme of pairs across bodies where there are no Eulerian particles: the Lagrangian one's viscosity serves both."""


class Adaptive(Lagrangian):
    """Each particle sums over its reference neighbours, its present ones, or, beside the other type, over both."""

    lasting = ("shrink",)
    # of a particle that has just converted it is the Lagrangian one: the next step is found with it

    def __init__(self, settings: LagrangianSettings, spec: Spec, numerics: Numerics, traits: Traits):
        """Pick the kernels; nothing is compiled before the first launch."""
        s = settings.eulerian or NO_EULERIAN
        planes, parts = traits.planes, [ARTIFICIAL] * s.artificial_stress
        super().__init__(settings, spec, numerics, traits, parts, correction=s.correction)
        coupling = Coupling(numerics.coupling, numerics.interface_stress, numerics.contact is not None)
        mutual = numerics.coupling == "conservative"
        terms = PairTerms(s.correction, False, s.artificial_stress, planes, coupling, self.parts, MIXED)
        plain = replace(terms, coupling=PURE, company=PLAIN)
        lagrangian_terms = LagrangianTerms(
            settings.correction,
            numerics.hourglass > 0.0,
            False,
            True,
            mutual,
            self._sheet,
            planes,
            self.parts,
        )
        self._company = make_company(spec, planes, coupling.separate)
        self._momentum = make_momentum(spec, self.smoothing, terms)
        self._momentum_plain = make_momentum(spec, self.smoothing, plain)
        self._momentum_lagrangian = make_momentum_lagrangian(spec, self.smoothing, lagrangian_terms)
        self._velocity_gradient = make_kinematics(
            spec, self.smoothing, s.correction, planes, coupling.separate, coupled=True
        )
        self._artificial_stress = make_artificial_stress(spec) if s.artificial_stress else None
        self._converts = settings.eulerian is not None
        self.spread_radius = numerics.conversion.radius if numerics.conversion else None

    def arrays(self, n: int) -> dict[str, wp.array]:
        """Add the artificial stress R, and what the rows hold."""
        stressed = n if self._artificial_stress else 1
        own = {"R": wp.zeros(stressed, dtype=self._spec.sym), "company": wp.zeros(n, dtype=wp.int32)}
        return super().arrays(n) | own

    def derive(self, bind: Bind) -> list[Command]:
        """R from σ besides."""
        return super().derive(bind) + bound(bind, self._artificial_stress)

    def listed(self, bind: Bind) -> list[Command]:
        """What the rows hold."""
        return [*super().listed(bind), bind(self._company, changed="dt")]

    def probe(self, bind: Bind) -> list[Command]:
        """Forces and approach speeds."""
        forces = (self._momentum_plain, self._momentum, self._momentum_lagrangian, self._contact)
        return bound(bind, self._correction, *forces)

    def step(self, bind: Bind) -> list[Command]:
        """One step from (x, v, e, ρ or F, τ) at t to t + dt."""
        motion = bound(
            bind,
            self._correction,  # S, G, K at x, where there are rows
            self._momentum_plain,  # A and B of pairs in the Eulerian form, of particles that have no other
            self._momentum,  # and of the others
            self._momentum_lagrangian,  # and of those in the Lagrangian one
            self._contact,  # and from other bodies
            self._integrate.kick,  # v' = v + dt A, e' exact in energy
            self._velocity_gradient,  # L from v' at x of Eulerian particles
            self._deformation.rate,  # Fdot from v', of Lagrangian ones and their neighbours
            self._deformation.deformation,  # F', and L of Lagrangian ones
            self._constitutive,  # ρ', τ', ε_p', p', σ'
            self._deformation.piola,  # P' from σ' and F'
        )
        rest = bound(
            bind,
            self._artificial_stress,  # R from σ'
            self._integrate.drift,  # x' = x + dt v'
        )
        return motion + self._end(bind) + rest

    def _end(self, bind: Bind) -> list[Command]:
        """Lagrangian particles that meet a criterion become Eulerian, with as many layers of neighbours as asked for."""
        if not self._converts:
            return [bind(self._ends.judge)]
        fates = ("fate", "fate_next")
        passes = range(max(self.layers, 1))
        radius = "support" if self.spread_radius is None else self.spread_radius
        return [
            bind(self._ends.begin, 1),
            bind(self._ends.judge),
            *(
                bind(self._ends.spread, fate=fates[k % 2], fate_next=fates[(k + 1) % 2], spread_radius=radius)
                for k in passes
            ),
            bind(self._ends.convert, fate=fates[len(passes) % 2]),
            bind(self._ends.interfaces),
            bind(self._company),
        ]
