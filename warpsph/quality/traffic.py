"""A model of what the kernels of a step move and compute: bytes and arithmetic per pair, bytes per particle.

Bytes are those that a loop asks for. Neighbours are shared between particles, so that most of them come from a cache:
a loop that asks for more than the memory delivers is not a mistake. Arithmetic is counted by hand in the kernels, each
addition, multiplication, division, root and comparison as one.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import warp as wp

from warpsph.schemes import SCHEMES, LagrangianSettings
from warpsph.solver import Solver

from .stopwatch import one_by_one, short_name

INT = 4
"""Bytes of an entry of a row."""


@dataclass(frozen=True)
class PairLoop:
    """What a loop does for a pair within the support, in d dimensions.

    Attributes:
        scalars: Numbers loaded or left behind that do not grow with d.
        vectors: Vectors, d numbers each.
        symmetric: Symmetric tensors, d (d + 1)/2 numbers each.
        tensors: Other tensors, d² numbers each.
        ints: Integers.
        flops: Operations as factors of 1, d and d².
        lagrangian: The pairs are those of the reference configuration.
    """

    scalars: float = 0.0
    vectors: float = 0.0
    symmetric: float = 0.0
    tensors: float = 0.0
    ints: float = 0.0
    flops: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lagrangian: bool = False

    def bytes(self, dim: int, real: int) -> float:
        """Bytes of a pair, with numbers of ``real`` bytes."""
        numbers = self.scalars + dim * self.vectors + dim * (dim + 1) / 2 * self.symmetric
        return real * (numbers + dim * dim * self.tensors) + INT * self.ints

    def operations(self, dim: int) -> float:
        """Operations of a pair."""
        return sum(factor * dim**k for k, factor in enumerate(self.flops))

    def __add__(self, other: "PairLoop") -> "PairLoop":
        sums = (
            getattr(self, name) + getattr(other, name)
            for name in ("scalars", "vectors", "symmetric", "tensors", "ints")
        )
        flops = tuple(a + b for a, b in zip(self.flops, other.flops, strict=True))
        return PairLoop(*sums, flops, self.lagrangian)


LOOPS = {
    # x v sig, m rho vol cs
    "momentum": PairLoop(4, 2, 1, 0, 1, (30, 13, 4)),
    # x v, vol
    "velocity_gradient": PairLoop(1, 2, 0, 0, 1, (14, 6, 2)),
    # X v, slope0
    "rate": PairLoop(1, 2, 0, 0, 1, (0, 3, 2), lagrangian=True),
    # X v x, P cof, slope0 cs rho
    "momentum_lagrangian": PairLoop(3, 3, 0, 2, 1, (18, 12, 6), lagrangian=True),
    # x v tau, vol p rho
    "deviatoric": PairLoop(3, 2, 1, 0, 1, (18, 12, 3)),
    # x v_start grad_p grad_rho dvdx, p rho cs cl vol A_shock, mat
    "hydrodynamic": PairLoop(6, 4, 0, 1, 2, (109, 20, 4)),
    # x v sig, rho cs cl vol A_shock, mat
    "pair_fluxes": PairLoop(5, 2, 1, 0, 2, (50, 34, 6)),
    # x, vol
    "correction": PairLoop(1, 1, 0, 0, 1, (27, 8, 1)),
}
"""What a pair costs in each loop, without correction."""

BOTH = PairLoop(0, 1, 0, 1, 0, (20, 14, 4))
"""What is added where both gradients of a pair are corrected: K and G of the neighbour, W, limits."""

CORRECTED = {
    "momentum": BOTH, "deviatoric": BOTH, "hydrodynamic": BOTH, "pair_fluxes": BOTH,
    "velocity_gradient": PairLoop(flops=(14, 9, 2)),
    "rate": PairLoop(1, flops=(0, 2, 0)),
    "momentum_lagrangian": PairLoop(1, 1, flops=(0, 4, 0)),
}  # fmt: skip
"""What is added with corrected gradients."""


@dataclass(frozen=True)
class Traffic:
    """What a kernel moves and computes in a step.

    Attributes:
        bytes: Bytes.
        flops: Operations; 0 where the kernel has no pairs, for they are not counted there.
        pairs: Pairs.
    """

    bytes: float
    flops: float
    pairs: float


@dataclass(frozen=True)
class Pairs:
    """How many pairs there are.

    Attributes:
        neighbours: Mean number of neighbours.
        eulerian: Share of Eulerian particles; the others have their pairs in the reference configuration.
    """

    neighbours: float
    eulerian: float


def traffic(kernel: str, solver: Solver, touched: int, pairs: Pairs) -> Traffic:
    """Model a kernel in one step.

    Args:
        kernel: Its short name.
        solver: The solver.
        touched: Its bytes per particle, see `touched_by`.
        pairs: The pairs.
    """
    n, dim = solver.particles.n, solver.data.dim
    real = wp.types.type_size_in_bytes(solver.particles.spec.real)
    loop = LOOPS.get(kernel, PairLoop())
    if _corrected(solver.data.numerics.scheme, loop.lagrangian):
        loop += CORRECTED.get(kernel, PairLoop())
    share = 1.0 - pairs.eulerian if loop.lagrangian else pairs.eulerian
    count = n * pairs.neighbours * share if kernel in LOOPS else 0.0
    return Traffic(n * touched + count * loop.bytes(dim, real), count * loop.operations(dim), count)


def touched_by(solver: Solver, work: Callable[[], None]) -> dict[str, int]:
    """Find the bytes per particle and step of the arrays that each kernel is launched with.

    Args:
        solver: The solver.
        work: Steps the solver.

    Returns:
        By the kernel's short name, the bytes of all its array arguments with one entry for each particle.
    """
    launcher, n = solver.launcher, solver.particles.n
    execute, calls, size = launcher.execute, Counter(), {}

    def looking(slices: list[wp.Launch], *options: bool) -> None:
        kernel = slices[0].kernel
        name = short_name(kernel.key)
        calls[name] += 1
        if name not in size:
            size[name] = _per_particle(kernel, slices[0].params[1:], n)
        execute(slices, *options)

    steps, launcher.execute = solver.reading.steps, looking
    try:
        with one_by_one(solver):
            work()
    finally:
        del launcher.execute
    steps = solver.reading.steps - steps
    return {name: size[name] * max(round(calls[name] / steps), 1) for name in size}


def _per_particle(kernel: wp.Kernel, values: Sequence, n: int) -> int:
    """Bytes that the array arguments with one entry for each of n particles have of each."""
    total = 0
    for argument, value in zip(kernel.adj.args, values, strict=True):
        if wp.types.is_array(argument.type) and value.shape[0] == n:
            total += wp.types.type_size_in_bytes(argument.type.dtype)
    return total


def _corrected(scheme: str, lagrangian: bool) -> bool:
    """Whether a scheme corrects the gradients of such pairs."""
    settings = SCHEMES[scheme]
    if isinstance(settings, LagrangianSettings) and not lagrangian:
        settings = settings.eulerian
    return settings is not None and settings.correction
