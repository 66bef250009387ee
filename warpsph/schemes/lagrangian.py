"""The Total Lagrangian scheme: one step as an ordered list of launches (method sections 4, 7 and 11; paper A eq 2)."""

from collections.abc import Sequence

import warp as wp

from warpsph.config import Conversion, Numerics
from warpsph.device.launch import Command
from warpsph.kernels.conversion import Criteria, make_conversion
from warpsph.kernels.deformation import make_deformation
from warpsph.kernels.momentum_lagrangian import LagrangianTerms, make_momentum_lagrangian
from warpsph.kernels.parts import HOURGLASS, VISCOUS
from warpsph.kernels.spec import Spec
from warpsph.search.reference import Reference

from . import LagrangianSettings
from .eulerian import viscosity
from .scheme import Bind, Scheme, Traits, bound


class Lagrangian(Scheme):
    """What schemes with Lagrangian particles share: their arrays, and how they start.

    Attributes:
        reference: Reference neighbours; the solver gives them before the first launch.
        reference_correction: Mixed correction in the reference configuration.
        hourglass: Coefficient of the zero-energy control.
        turns: 1: a particle that turns over converts; 0: it stops the run.
        layers: Layers of reference neighbours that convert with a failed one.
        strain_limit: Equivalent strain that converts a particle.
    """

    reference: Reference

    def __init__(
        self,
        settings: LagrangianSettings,
        spec: Spec,
        numerics: Numerics,
        traits: Traits,
        parts: Sequence[int] = (),
        *,
        correction: bool,
    ):
        """Pick the kernels; nothing is compiled before the first launch.

        Args:
            settings: The scheme's settings.
            spec: Specialisation.
            numerics: Numerical settings of the scene.
            traits: What of the scene is compiled in.
            parts: Parts of the forces beside viscosity, hourglass control and contact.
            correction: Mixed correction of Eulerian particles' gradients.
        """
        planes = traits.planes
        super().__init__(
            spec, numerics, correction=correction, gradient_ratio=settings.gradient_ratio,
            parts=(VISCOUS, *parts, *([HOURGLASS] * (numerics.hourglass > 0.0))), lagrangian=True, traits=traits,
        )  # fmt: skip
        self.viscosity_alpha, self.viscosity_beta = viscosity(settings, numerics)
        self.reference_correction, self.hourglass = settings.correction, numerics.hourglass
        self._deformation = make_deformation(spec, settings.correction, planes)
        given = numerics.conversion
        self.turns = int(numerics.inverted == "convert")
        self.layers, self.strain_limit = (given.layers, given.strain or 1.0) if given else (0, 1.0)
        self._ends = make_conversion(spec, _criteria(given), planes, self._sheet)

    def arrays(self, n: int) -> dict[str, wp.array]:
        """Add cofactor, first Piola-Kirchhoff stress and what the ends of Lagrangian particles need."""
        s = self._spec
        fresh = {
            "rate0": s.mat,
            "cof": s.mat,
            "P": s.mat,
            "fate": wp.int32,
            "fate_next": wp.int32,
            "interface": wp.int32,
        }
        lagrangian = {name: wp.zeros(n, dtype=dtype) for name, dtype in fresh.items()}
        flags = {name: wp.zeros(1, dtype=s.real) for name in ("spreading", "changed")}
        return super().arrays(n) | lagrangian | flags | {"shrink": wp.ones(n, dtype=s.real)}

    def derive(self, bind: Bind) -> list[Command]:
        """Reference pairs from X, interfaces from the kernel types, Fdot from v, cofactor and P from F and σ."""
        return [
            *self.reference.pairs(bind, "dt"),
            bind(self._ends.interfaces, changed="dt"),
            bind(self._deformation.rate),
            bind(self._deformation.piola),
        ]


class TotalLagrangian(Lagrangian):
    """All particles are Lagrangian to the end, or until they are eroded: bodies only meet in contact."""

    def __init__(self, settings: LagrangianSettings, spec: Spec, numerics: Numerics, traits: Traits):
        """Pick the kernels; nothing is compiled before the first launch."""
        super().__init__(settings, spec, numerics, traits, correction=False)
        self.searching = not traits.alone  # one body alone has nothing to find
        terms = LagrangianTerms(
            settings.correction,
            numerics.hourglass > 0.0,
            numerics.erosion,
            False,
            False,
            self._sheet,
            traits.planes,
            self.parts,
        )
        self._momentum = make_momentum_lagrangian(spec, self.smoothing, terms)
        self._erodes = numerics.erosion
        if traits.alone:
            self._strangers = self._contact = None

    def probe(self, bind: Bind) -> list[Command]:
        """Forces and approach speeds."""
        return bound(bind, self._momentum, self._contact)

    def step(self, bind: Bind) -> list[Command]:
        """One step from (x, v, e, F, τ) at t to t + dt."""
        motion = bound(
            bind,
            self._momentum,  # A and B from P at x
            self._contact,  # and from other bodies
            self._integrate.kick,  # v' = v + dt A, e' exact in energy
            self._deformation.rate,  # Fdot from v'
            self._deformation.deformation,  # F' and L
            self._constitutive,  # ρ' = ρ0/J', τ', ε_p', p', σ'
        )
        rest = bound(
            bind,
            self._deformation.piola,  # P' from σ' and F'
            self._integrate.drift,  # x' = x + dt v'
        )
        return motion + self._end(bind) + rest

    def _end(self, bind: Bind) -> list[Command]:
        """D >= 1 leaves all lists, and J <= 0 stops the run."""
        judge = [bind(self._ends.judge)]
        if not self._erodes:
            return judge
        return [
            bind(self._ends.begin, 1),
            *judge,
            bind(self._ends.erode),
            *self.reference.pairs(bind, "changed"),  # without those that have left,
            bind(self._deformation.rate, dt="changed"),  # whose power must not be counted either
        ]


def _criteria(conversion: Conversion | None) -> Criteria:
    """What of a conversion is compiled in."""
    if conversion is None:
        return Criteria()
    measure = conversion.measure if conversion.strain is not None else ""
    return Criteria(measure, conversion.damage, conversion.criterion)
