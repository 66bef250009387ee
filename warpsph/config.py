"""Every numerical choice of a run, validated when it is made."""

from dataclasses import dataclass
from typing import Literal

from .errors import InputError

KERNELS = ("cubic_spline", "quintic_spline", "wendland_c2", "wendland_c4", "gaussian")
"""Smoothing kernels of method section 1."""

RIEMANN_SOLVERS = ("acoustic", "two-shock")
"""Riemann solvers of the Godunov schemes (method section 10)."""

LIMITERS = ("superbee", "minmod", "sweby", "mc", "vanleer")
"""Slope limiters of the second-order Godunov schemes (Connolly et al. 2013, Eq. 27)."""

RiemannName = Literal[*RIEMANN_SOLVERS]
"""Type of a scene's parameter that names a Riemann solver."""

LimiterName = Literal[*LIMITERS]
"""Type of a scene's parameter that names a limiter."""


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
        }
        for name, allowed in choices.items():
            if getattr(self, name) not in allowed:
                raise InputError(f"{name} {getattr(self, name)!r} is unknown; allowed: {', '.join(allowed)}")
        ranges = {
            "smoothing_ratio": (0.8, 3.0),
            "cfl": (0.0, 1.0),
            "skin": (0.0, 2.0),
            "limiter_beta": (1.0, 2.0),
        }
        for name, (low, high) in ranges.items():
            if not low <= getattr(self, name) <= high or (name == "cfl" and self.cfl == 0.0):
                raise InputError(
                    f"{name} = {getattr(self, name)!r} is out of range; allowed: {low} to {high}"
                )
