"""The Eulerian scheme: one step as an ordered list of launches (method sections 3, 7 and 11; paper A eq 1)."""

from warpsph.config import Numerics
from warpsph.kernels.artificial_stress import make_artificial_stress
from warpsph.kernels.constitutive import make_constitutive
from warpsph.kernels.correction import make_correction
from warpsph.kernels.integrate import make_integrate
from warpsph.kernels.kinematics import make_kinematics
from warpsph.kernels.momentum_eulerian import PairTerms, make_momentum
from warpsph.kernels.smoothing import make_smoothing
from warpsph.kernels.spec import Spec
from warpsph.kernels.tiles import make_tiles
from warpsph.kernels.timestep import make_timestep
from warpsph.kernels.viscosity import MORRIS_MIN, make_switches

from . import EulerianSettings


class Eulerian:
    """Kernels and constants of the Eulerian family.

    Attributes:
        settings: The scheme's settings.
        support: Support radius of the smoothing kernel in units of h.
        first_switch: Value the viscosity's switch starts from.
    """

    def __init__(self, settings: EulerianSettings, spec: Spec, numerics: Numerics, planes: bool):
        """Pick the kernels; nothing is compiled before the first launch."""
        s = self.settings = settings
        smoothing = make_smoothing(spec, numerics.kernel)
        self.support = smoothing.support
        self.first_switch = MORRIS_MIN if s.viscosity == "morris" else 1.0
        switched = s.viscosity != "monaghan"
        terms = PairTerms(s.correction, switched, s.artificial_stress, planes)
        self._timestep, self._tiles = make_timestep(spec), make_tiles(spec)
        self._correction = make_correction(spec, smoothing, planes) if s.correction else None
        self._momentum = make_momentum(spec, smoothing, terms)
        self._integrate = make_integrate(spec)
        self._velocity_gradient = make_kinematics(spec, smoothing, s.correction, planes)
        self._switch = getattr(make_switches(spec), s.viscosity) if switched else None
        self._constitutive = make_constitutive(spec, numerics.plane == "stress" and spec.dim == 2)
        self._artificial_stress = make_artificial_stress(spec) if s.artificial_stress else None

    def settle(self, bind) -> list:
        """The launch that makes pressure, stress and volume agree with the scene's density and energy."""
        return [bind(self._constitutive)]

    def probe(self, bind) -> list:
        """The launches that find forces and approach speeds without a step: they limit the very first one."""
        return [bind(kernel) for kernel in (self._correction, self._momentum) if kernel is not None]

    def derive(self, bind) -> list:
        """The launches that refill what one step leaves for the next and no checkpoint holds."""
        return [bind(self._artificial_stress)] if self._artificial_stress else []

    def plan(self, bind, n_blocks: int, n_tiles: int) -> list:
        """How far the next step may go, and whether it may be taken at all."""
        sequence = [
            (self._tiles.motion, n_tiles),  # whether the neighbour rows
            (self._tiles.wear, n_tiles),  # still hold every pair
            (self._timestep.local, n_blocks),  # dt_a from the state
            (self._timestep.decide, 1),  # dt and verdict
        ]
        return [bind(kernel, n) for kernel, n in sequence]

    def step(self, bind) -> list:
        """One step from (x, v, e, ρ, τ) at t to t + dt; `bind(kernel)` binds a launch to the solver's arrays."""
        sequence = [
            self._correction,  # S, G, K at x
            self._momentum,  # A and B from σ at x
            self._integrate.kick,  # v' = v + dt A, e' exact in energy
            self._velocity_gradient,  # L from v' at x
            self._switch,  # BAL, MON
            self._constitutive,  # ρ', τ', ε_p', p', σ'
            self._artificial_stress,  # R from σ'
            self._integrate.drift,  # x' = x + dt v'
        ]
        return [bind(kernel) for kernel in sequence if kernel is not None]
