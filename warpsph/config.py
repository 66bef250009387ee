"""Every numerical choice of a run, validated when it is made."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from . import checks
from .messages import values

KERNELS = ("cubic_spline", "quintic_spline", "wendland_c2", "wendland_c4", "gaussian")
"""Smoothing kernels of method section 1."""

RIEMANN_SOLVERS = ("acoustic", "two-shock")
"""Riemann solvers of the Godunov schemes (method section 10)."""

LIMITERS = ("superbee", "minmod", "sweby", "mc", "vanleer")
"""Slope limiters of the second-order Godunov schemes (Connolly et al. 2013, Eq. 27)."""

STRAIN_MEASURES = ("logarithmic", "green-lagrange", "almansi", "plastic")
"""Measures of the equivalent strain that converts a particle (method section 5)."""

RiemannName = Literal[*RIEMANN_SOLVERS]
"""Type of a scene's parameter that names a Riemann solver."""

LimiterName = Literal[*LIMITERS]
"""Type of a scene's parameter that names a limiter."""

CouplingName = Literal["conservative", "printed"]
"""Type of a scene's parameter that names a coupling."""

InterfaceStressName = Literal["both", "none", "eulerian"]
"""Type of a scene's parameter that says where artificial stress of a mixed pair acts."""


@dataclass(frozen=True)
class Contact:
    """Frictionless contact between bodies (method section 6; paper A eqs 15-16). Give one of the two.

    Attributes:
        stiffness: k = Kc dx^dim / K, K the smaller bulk modulus of the two materials; about 0.25 [-].
        modulus: Kc itself [Pa/m^dim], which belongs to one resolution.
    """

    stiffness: float | None = None
    modulus: float | None = None

    def __post_init__(self):
        """Check that there is one stiffness.

        Raises:
            InputError: There is none, or there are two, or it is not positive.
        """
        given = {name: value for name, value in vars(self).items() if value is not None}
        if len(given) != 1:
            allowed = "one of them: stiffness (k, about 0.25) or modulus (Kc in Pa/m^dim)"
            raise values.refuse("stiffness, modulus of Contact", (self.stiffness, self.modulus), allowed)
        for name, value in given.items():
            checks.positive(f"{name} of Contact", value)


@dataclass(frozen=True)
class Conversion:
    """When Total Lagrangian particles become Eulerian ones (method section 5; paper A 2.3). Give at least one criterion.

    Attributes:
        strain: A particle converts above this equivalent strain [-].
        measure: What that strain is, one of `STRAIN_MEASURES`.
        damage: A particle converts at D = 1, and reference neighbours with it.
        layers: How many layers of reference neighbours do.
        radius: How far away the neighbours of a layer may be in the reference configuration [m]; default the support.
        criterion: A criterion of your own: gives, for a `warpsph.kernels.spec.Spec` s, a ``wp.func`` of (F: s.mat,
            tau: s.mat, p: s.real, ep: s.real, D: s.real, T: s.real) -> s.real; the particle converts from 1 on.
    """

    strain: float | None = None
    measure: str = "logarithmic"
    damage: bool = False
    layers: int = 1
    radius: float | None = None
    criterion: Callable | None = None

    def __post_init__(self):
        """Check every value.

        Raises:
            InputError: Naming the field, the value and what is allowed.
        """
        if self.strain is None and not self.damage and self.criterion is None:
            raise values.missing("criterion of Conversion", "strain, damage or criterion")
        for name in ("strain", "radius"):
            if getattr(self, name) is not None:
                checks.positive(f"{name} of Conversion", getattr(self, name))
        if self.measure not in STRAIN_MEASURES:
            raise checks.refuse("measure of Conversion", self.measure, ", ".join(STRAIN_MEASURES))
        if isinstance(self.layers, bool) or not isinstance(self.layers, int) or not 0 <= self.layers <= 100:
            raise checks.refuse("layers of Conversion", self.layers, "a whole number, 0 to 100")
        if self.criterion is not None and not callable(self.criterion):
            raise checks.refuse("criterion of Conversion", self.criterion, "a function of a Spec")


@dataclass(frozen=True)
class Numerics:
    """Numerical settings of a scene.

    Attributes:
        scheme: Name of the scheme, see `warpsph.schemes.SCHEMES`.
        kernel: Smoothing kernel, one of `KERNELS`.
        smoothing_ratio: h over the particle spacing.
        cfl: Courant number of the time step (method section 9).
        skin: Verlet skin over h: neighbour rows reach this much beyond the kernel's support.
        plane: ``"strain"`` or ``"stress"``; matters in 2D only.
        riemann: Riemann solver of the Godunov schemes, one of `RIEMANN_SOLVERS`.
        limiter: Slope limiter of the second-order ones, one of `LIMITERS`.
        limiter_beta: Sweby's β of the limiter ``"sweby"``: 1 is minmod, 2 superbee.
        limit_jump: Slopes are bounded by the pair's own difference too, so that its two states never cross.
        viscosity_alpha: Linear coefficient of the artificial viscosity in place of the scheme's own.
        viscosity_beta: Quadratic one.
        contact: Contact between bodies; without it they interact through the conservation equations ("kernel contact").
        conversion: When Total Lagrangian particles convert (schemes ``adaptle...``).
        erosion: A Total Lagrangian particle leaves all lists when it fails (schemes ``tl...``).
        coupling: Force between particles of two kernel types: ``"conservative"``, or ``"printed"`` as in paper A.
        interface_stress: On which of two such particles artificial stress acts: ``"both"``, ``"none"``, ``"eulerian"``.
        hourglass: Coefficient of Ganzenmüller's zero-energy control of Total Lagrangian particles; 0 is off,
            beyond 10 it would need shorter steps.
        inverted: What happens to a Total Lagrangian particle that turns over (J <= 0): the run must ``"stop"``, or it
            and its neighbours ``"convert"``.
    """

    scheme: str = "sav1"
    kernel: str = "cubic_spline"
    smoothing_ratio: float = 1.2
    cfl: float = 0.5
    skin: float = 0.4
    plane: str = "strain"
    riemann: str = "acoustic"
    limiter: str = "superbee"
    limiter_beta: float = 1.5
    limit_jump: bool = False
    viscosity_alpha: float | None = None
    viscosity_beta: float | None = None
    contact: Contact | None = None
    conversion: Conversion | None = None
    erosion: bool = False
    coupling: CouplingName = "conservative"
    interface_stress: InterfaceStressName = "both"
    hourglass: float = 0.0
    inverted: Literal["stop", "convert"] = "stop"

    def __post_init__(self):
        """Check every value.

        Raises:
            InputError: Naming the field, the value and what is allowed.
        """
        from .schemes import SCHEMES

        choices = {
            "scheme": tuple(SCHEMES),
            "kernel": KERNELS,
            "plane": ("strain", "stress"),
            "riemann": RIEMANN_SOLVERS,
            "limiter": LIMITERS,
            "coupling": ("conservative", "printed"),
            "interface_stress": ("both", "none", "eulerian"),
            "inverted": ("stop", "convert"),
        }
        for name, allowed in choices.items():
            if getattr(self, name) not in allowed:
                raise values.unknown(name, getattr(self, name), allowed)
        ranges = {
            "smoothing_ratio": (0.8, 3.0),
            "cfl": (0.0, 1.0),
            "skin": (0.0, 2.0),
            "limiter_beta": (1.0, 2.0),
            "viscosity_alpha": (0.0, math.inf),
            "viscosity_beta": (0.0, math.inf),
            "hourglass": (0.0, 10.0),
        }
        for name, (low, high) in ranges.items():
            if getattr(self, name) is None:
                continue
            if not low <= getattr(self, name) <= high or (name == "cfl" and self.cfl == 0.0):
                raise values.outside(name, getattr(self, name), f"{low} to {high}")
        for name, kind in (("contact", Contact), ("conversion", Conversion)):
            if not isinstance(getattr(self, name), kind | None):
                raise checks.refuse(name, getattr(self, name), f"warpsph.config.{kind.__name__}(...) or None")
