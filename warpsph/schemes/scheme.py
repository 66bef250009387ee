"""What every scheme has: its material update, its time step, and the arrays and constants its kernels are bound to."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import warp as wp

from warpsph.clock import STAGES
from warpsph.config import Numerics
from warpsph.device.blocks import Blocks
from warpsph.device.launch import Command
from warpsph.kernels.constitutive import make_constitutive
from warpsph.kernels.contact import make_contact, make_strangers
from warpsph.kernels.correction import make_correction
from warpsph.kernels.integrate import make_integrate
from warpsph.kernels.ledger import make_ledger
from warpsph.kernels.parts import CONTACT, Parts, part_types
from warpsph.kernels.smoothing import make_smoothing
from warpsph.kernels.spec import Spec
from warpsph.kernels.tiles import make_tiles
from warpsph.kernels.timestep import CONTACT_LEAP, LEAP, make_timestep
from warpsph.search.tiles import Tiles

Bind = Callable[..., Command]
"""``bind(kernel, n)`` binds a launch over all particles, or over n threads, to the solver's arrays."""


@dataclass(frozen=True)
class Traits:
    """What of a scene, and of the device it runs on, is compiled in.

    Attributes:
        planes: There are symmetry planes.
        fragile: Some material bears no tension, or none once it has failed.
        alone: There is one body.
        constrained: Some particle is fixed or driven.
    """

    planes: bool = False
    fragile: bool = False
    alone: bool = False
    constrained: bool = False


class Scheme(ABC):
    """A scheme as ordered lists of launches; a family adds its pair loops and `step`.

    Attributes:
        support: Support radius of the smoothing kernel in units of h.
        first_switch: Value the viscosity's switch starts from.
        viscosity_alpha: Share of the sound speed in the dissipation's signal speed, for the time step.
        viscosity_beta: The same for the approach speed.
        gradient_ratio: ``Cf`` of the correction's limiter.
        groups: Groups of the field table that the scheme needs.
        parts: Parts of the forces that it keeps apart.
        ledger: The kernel of conserved quantities and extremes.
        searching: Neighbour rows of present positions are needed.
        lasting: Those of its `arrays` that the next step goes on from and `derive` cannot find again.
        wearing_role: From which role on a tile of the body's own wears the rows out, see `kernels.tiles`.
    """

    first_switch = 1.0
    viscosity_alpha: float
    viscosity_beta: float
    searching = True
    lasting: tuple[str, ...] = ()

    def __init__(
        self,
        spec: Spec,
        numerics: Numerics,
        *,
        correction: bool,
        gradient_ratio: float,
        exact_energy: bool = True,
        split: bool = False,
        parts: Parts = (),
        switched: bool = False,
        lagrangian: bool = False,
        traits: Traits,
    ):
        """Pick the kernels that all families share; nothing is compiled before the first launch.

        Args:
            spec: Specialisation.
            numerics: Numerical settings of the scene.
            correction: Mixed correction of the gradients.
            gradient_ratio: ``Cf`` of its limiter.
            exact_energy: Section 11's stepping.
            split: The density has a rate of its own.
            parts: Parts of the forces that the ledger keeps apart, but for contact.
            switched: A switch scales the viscosity.
            lagrangian: There are Lagrangian particles.
            traits: What of the scene is compiled in.
        """
        self.gradient_ratio = gradient_ratio
        self._spec, self._corrected = spec, correction
        self.smoothing = make_smoothing(spec, numerics.kernel)
        self.support = self.smoothing.support
        contact = numerics.contact is not None
        planes, constrained = traits.planes, traits.constrained
        self._sheet = numerics.plane == "stress" and spec.dim == 2
        self.parts = (*parts, *([CONTACT] * contact))
        present = {
            "lagrangian": lagrangian,
            "contact": contact,
            "constraint": constrained,
            "sheet": self._sheet,
        }
        present |= {"switch": switched, "parts": bool(self.parts)}
        self.groups = frozenset(group for group, on in present.items() if on)
        self.wearing_role = 1 if correction else 2
        self._timestep = make_timestep(spec, lagrangian, contact, switched)
        self._tiles = make_tiles(spec, lagrangian)
        self._integrate = make_integrate(spec, exact_energy, self.parts, constrained)
        self.ledger = make_ledger(spec, self.parts, constrained)
        self._correction = (
            make_correction(spec, self.smoothing, planes, contact, lagrangian) if correction else None
        )
        self._strangers = make_strangers(spec, planes) if contact else None
        self._contact = make_contact(spec, self.smoothing, planes, self.parts) if contact else None
        self._constitutive = make_constitutive(spec, self._sheet, split, lagrangian)

    @property
    def leap(self) -> float:
        """Largest distance by which particles come nearer in a step [h]: none where nothing comes into reach."""
        if not self.searching:
            return math.inf
        return LEAP if self._contact is None else CONTACT_LEAP

    def arrays(self, n: int) -> dict[str, wp.array]:
        """Arrays that live from one launch to the next but are no state; 1 long where the scheme has no use for them.

        Args:
            n: Number of particles.
        """
        s, corrected = self._spec, n if self._corrected else 1
        parted, types = n if self.parts else 1, part_types(s, len(self.parts))
        unused = {"X": s.point, "F": s.mat, "vol0": s.real, "ripe": wp.int32, "fate": wp.int32}
        unused |= {"shrink": s.real, "contact_rate": s.real, "thickness": s.real, "av_switch": s.real}
        unused |= {"cover": s.real, "inverted": wp.int32, "company": wp.int32}
        unused |= {
            "fixed": wp.int32,
            "impulse": s.vec,
            "twist": s.vec,
            "work": s.real,
            "e_parts": types.power,
        }
        return {name: wp.zeros(1, dtype=dtype) for name, dtype in unused.items()} | {
            "dedt": wp.zeros(n, dtype=s.real),
            "div": wp.zeros(1, dtype=s.real),
            "K": wp.zeros(corrected, dtype=s.mat),
            "G": wp.zeros(corrected, dtype=s.vec),
            "n_strangers": wp.zeros(n if self._strangers else 1, dtype=wp.int32),
            "part_a": wp.zeros(parted, dtype=types.acceleration),
            "part_power": wp.zeros(parted, dtype=types.power),
            "turned": wp.zeros(1, dtype=wp.int32),
        }

    def settle(self, bind: Bind) -> list[Command]:
        """The launch that makes pressure, stress and volume agree with the scene's density and energy."""
        return [bind(self._constitutive)]

    @abstractmethod
    def probe(self, bind: Bind) -> list[Command]:
        """The launches that find forces and approach speeds without a step: they limit the very first one."""

    def derive(self, bind: Bind) -> list[Command]:
        """The launches that refill what one step leaves for the next and no checkpoint holds."""
        return []

    def listed(self, bind: Bind) -> list[Command]:
        """The launches that follow new neighbour rows."""
        return bound(bind, self._strangers)

    def plan(self, bind: Bind, blocks: Blocks, tiles: Tiles) -> list[Command]:
        """How far the next step may go, and whether it may be taken at all.

        Args:
            bind: Binds launches.
            blocks: How particles are dealt out to the threads that look for the smallest step.
            tiles: What tells whether the neighbour rows still hold every pair.
        """
        worn = self._worn(bind, tiles) if self.searching else []
        deal = {"chunk": blocks.chunk, "along": blocks.along, "across": blocks.across}
        local = bind(self._timestep.local, blocks.count, **deal)  # dt_a from the state
        folds, left = [], {}
        for stage, few in zip(STAGES, blocks.folds, strict=False):
            found = {f"folded_{name}": f"{stage}_{name}" for name in ("dt", "low", "high", "wear")}
            folds.append(bind(self._timestep.fold, few, **left, **found))
            left = {f"block_{name}": f"{stage}_{name}" for name in ("dt", "low", "high")}
            left |= {"tile_wear": f"{stage}_wear"}
        return [*worn, local, *folds, bind(self._timestep.decide, 1, **left)]  # dt and verdict

    def _worn(self, bind: Bind, tiles: Tiles) -> list[Command]:
        """Whether the neighbour rows still hold every pair."""
        k, threads = self._tiles, tiles.most * tiles.hands
        wear = bind(k.wear, threads)
        if tiles.hands == 1:
            return [bind(k.motion, threads), wear]
        parts = {"moved_low": "hand_low", "moved_high": "hand_high"}
        return [bind(k.motion, threads, **parts), bind(k.extents, tiles.most), wear]

    @abstractmethod
    def step(self, bind: Bind) -> list[Command]:
        """One step from t to t + dt."""


def bound(bind: Bind, *kernels: wp.Kernel | None) -> list[Command]:
    """Bind kernels in order; None is left out."""
    return [bind(kernel) for kernel in kernels if kernel is not None]
