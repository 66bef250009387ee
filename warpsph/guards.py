"""What a run watches for besides states with which it cannot go on, and what it does where it finds any."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from . import checks
from .config import Numerics
from .messages import values

WATCHED = ("density", "energy_error", "interpenetration", "domain", "neighbours")
"""Guards by name, the fields of `Guards` among them."""

Action = Literal["stop", "warn"]
"""What a guard does: end the run, or say so once, count, and go on."""

EXACT, LOSSY = 1e-3, 0.1
"""Limits of the energy error where no other is given: of steps that conserve energy, and of those that do not."""

Corners = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Guards:
    """Limits of a run, each looked at after every `warpsph.watching.watch.EVERY` steps and before every output.

    A limit of ``math.inf`` is none. A state that is not finite and a time step that has collapsed always end the run;
    what becomes of a particle that turns over (J <= 0) `warpsph.config.Numerics.inverted` says.

    Attributes:
        energy_error: Change of the energy, less the work of constraints, over the largest of the energy at the start,
            the energy, and the kinetic energy [1]; None: `EXACT`, or `LOSSY` where numerics do not conserve energy.
        interpenetration: How deep bodies in contact may be in each other, in spacings.
        neighbours: How many entries a neighbour row may have, over those in a whole lattice.
        domain: Lowest and highest corner [m] of the box that no particle should leave, of as many components as the
            problem; None: there is none.
        stop: Guards that end the run, names of `WATCHED`; the others warn. ``"density"`` is that of a density that is
            not positive.
    """

    energy_error: float | None = None
    interpenetration: float = 1.0
    neighbours: float = 32.0
    domain: Corners | None = None
    stop: tuple[str, ...] = ("density", "domain")

    def __post_init__(self):
        """Check every value.

        Raises:
            InputError: Naming the field, the value and what is allowed.
        """
        for name in ("energy_error", "interpenetration", "neighbours"):
            value = getattr(self, name)
            if name != "energy_error" or value is not None:
                object.__setattr__(self, name, _limit(f"{name} of Guards", value))
        if self.domain is not None:
            object.__setattr__(self, "domain", _corners(self.domain))
        if isinstance(self.stop, str) or not isinstance(self.stop, Sequence):
            raise values.refuse("stop of Guards", self.stop, f"names among {', '.join(WATCHED)}")
        for name in self.stop:
            if name not in WATCHED:
                raise values.unknown("stop of Guards", name, WATCHED)
        object.__setattr__(self, "stop", tuple(self.stop))

    def changed(self, energy_limit: float | None = None, on_trouble: Action | None = None) -> "Guards":
        """The same guards with another limit of the energy error, or all of which stop or warn; None changes nothing.

        Raises:
            InputError: A value is not allowed.
        """
        if on_trouble not in (None, "stop", "warn"):
            raise values.unknown("on_trouble", on_trouble, ("stop", "warn"))
        limit = self.energy_error if energy_limit is None else _limit("energy_limit", energy_limit)
        stop = {None: self.stop, "stop": WATCHED, "warn": ()}[on_trouble]
        return replace(self, energy_error=limit, stop=stop)

    def energy_limit(self, numerics: Numerics) -> float:
        """The limit of the energy error [1]."""
        if self.energy_error is not None:
            return self.energy_error
        return EXACT if is_exact(numerics) and is_mutual(numerics) else LOSSY


def is_exact(numerics: Numerics) -> bool:
    """Whether the stepping conserves the energy of forces that are mutual, to round-off."""
    from .schemes import SCHEMES

    return getattr(SCHEMES[numerics.scheme], "exact_energy", True)


def is_mutual(numerics: Numerics) -> bool:
    """Whether action is reaction, which Eulerian beside Lagrangian particles may give up."""
    from .schemes import SCHEMES

    eulerian = getattr(SCHEMES[numerics.scheme], "eulerian", None)
    if eulerian is None:
        return True
    lopsided = eulerian.artificial_stress and numerics.interface_stress == "eulerian"
    return numerics.coupling == "conservative" and not lopsided


def _limit(name: str, value: object) -> float:
    """A positive number, which may be infinite.

    Raises:
        InputError: It is something else.
    """
    return math.inf if isinstance(value, float) and value == math.inf else checks.positive(name, value)


def _corners(value: object) -> Corners:
    """Two corners of a box.

    Raises:
        InputError: They are none, or the box is empty.
    """
    allowed = "two corners [m] of as many components, the lowest and the highest: ((-0.1, -0.1), (0.1, 0.1))"
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise values.refuse("domain of Guards", value, allowed)
    low, high = (checks.vector("a corner of the domain of Guards", corner, 1, 2, 3) for corner in value)
    if len(low) != len(high) or not all(a < b for a, b in zip(low, high, strict=True)):
        raise values.refuse("domain of Guards", value, allowed)
    return low, high
