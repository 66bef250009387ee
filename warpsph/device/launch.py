"""The one way kernels are launched: arguments bound by name, checked, and sliced over CPU threads."""

import contextlib
import functools
import inspect
import itertools
from dataclasses import dataclass

import warp as wp

from warpsph.messages import values

from .cores import count_cores
from .subnormals import Flushing
from .team import Team, Work, run_all

SLICES_PER_THREAD = 4
"""A CPU launch is cut into this many slices per thread, taken as they come: uneven rows balance out."""

SMALLEST_SLICE = 128
"""Particles below which a launch of a kernel with much to do for each is not cut further."""

SMALLEST_LIGHT_SLICE = 1024
"""The same for other kernels."""

WORTH_WAKING = 100000
"""Particles from which on it is worth to wake threads for a launch of such a kernel by itself."""

BLOCK = 128
"""Threads of a block on CUDA. No smaller share of a multiprocessor's registers is left over with it than with 256, and a
half more threads are under way where a thread takes more than 128 of them (docs/registers.md)."""

LABOUR = {"neigh", "neigh0", "materials"}
"""Arguments of kernels with much to do: rows of neighbours, laws of materials."""


@functools.cache
def _names(kernel: wp.Kernel) -> tuple[str, ...]:
    return tuple(inspect.signature(kernel.func).parameters)


@functools.cache
def _place(kernel: wp.Kernel) -> type | None:
    """Scalar type of a kernel's positions, the argument ``x``: what a hash grid that it looks up has to hold."""
    for var, name in zip(kernel.adj.args, _names(kernel), strict=True):
        if name == "x":
            return var.type.dtype._wp_scalar_type_
    return None


@dataclass(frozen=True)
class Pieces:
    """An argument that is another array for another range of threads: no array has more than 2^31 entries.

    Attributes:
        arrays: The arrays; the k-th serves the threads from k times ``length`` on.
        length: Threads that share an array.
    """

    arrays: tuple[wp.array, ...]
    length: int

    def serving(self, thread: int) -> wp.array:
        """The array of a thread."""
        return self.arrays[thread // self.length]


class Command:
    """A launch with its arguments bound: call it as often as you like.

    Attributes:
        slices: The launch in pieces that threads may share.
    """

    def __init__(self, launcher: "Launcher", slices: list[wp.Launch], worth: bool):
        """Take recorded slices; ``worth``: waking a thread to share them is."""
        self._launcher, self.slices, self._worth = launcher, slices, worth

    def __call__(self) -> None:
        """Run it; returns when the work is done (CPU) or queued (CUDA)."""
        self._launcher.execute(self.slices, self._worth)


class Launcher:
    """Launches kernels on one device.

    Warp runs a CPU launch on one thread but without holding the interpreter lock, so slices of a launch
    shared by threads run in parallel. Every kernel takes its slice's first index as ``offset``.

    Attributes:
        device: The Warp device.
        threads: CPU threads in use (1 on CUDA).
        arithmetic: ``with`` it, many launches in a row set the thread's arithmetic once (see `subnormals`).
    """

    def __init__(self, device: str = "cpu", threads: int | None = None):
        """Open a device.

        Raises:
            InputError: If there is no such device, or ``threads`` is below one.
        """
        self.device = find_device(device)
        cores = count_cores()
        if threads is not None and threads < 1:
            raise values.outside("threads", threads, f"1 or more (this machine has {cores})")
        self.threads = 1 if self.device.is_cuda else (threads or cores)
        self._team = Team(self.threads) if self.threads > 1 else None
        self._busy = False
        self.arithmetic = contextlib.nullcontext() if self.device.is_cuda else Flushing()

    def slices(self, dim: int, most: int, length: int | None = None) -> list[tuple[int, int]]:
        """Cut a launch of ``dim`` threads into ``most`` (first, size) pieces, or fewer if there are not as many threads.

        None of them goes across a multiple of ``length``.
        """
        count = 1 if self._team is None else min(self.threads * SLICES_PER_THREAD, most)
        edges = [dim * k // max(count, 1) for k in range(max(count, 1) + 1)]
        edges = sorted({*edges, *range(0, dim, length or dim)})
        return [(a, b - a) for a, b in itertools.pairwise(edges) if b > a]

    def execute(self, slices: list[wp.Launch], worth: bool = True) -> None:
        """Run recorded slices, shared by the team where there are several and it is ``worth`` to wake it."""
        pieces = [piece.launch for piece in slices]
        with self.arithmetic:
            self.share(pieces) if worth else run_all(pieces)

    def share(self, works: list[Work]) -> None:
        """Run pieces of work that do not depend on each other, by as many threads as there are.

        What they share themselves is run by the thread that does: no other is free. So is all that is recorded, for
        another thread would run it instead.
        """
        with self.arithmetic:
            if self._team is None or len(works) == 1 or self._busy or self.device.is_capturing:
                run_all(works)
                return
            self._busy = True
            try:
                self._team.share(works)
            finally:
                self._busy = False

    def together(self, works: list[Work], leave: Work) -> None:
        """Run a piece of work for each thread, see `Team.together`."""
        with self.arithmetic:
            if self._team is None:
                works[0]()
            else:
                self._team.together(works, leave)

    def bind(
        self,
        kernel: wp.Kernel,
        dim: int,
        *sources: object,
        particles: int | None = None,
        block: int | None = None,
        **named: object,
    ) -> Command:
        """Bind a launch, taking each argument by its name.

        A kernel has many arrays of one type in a row, and Warp cannot tell ``rho`` from ``m``. It checks
        neither structs nor the precision of a hash grid, which is that of positions; both are checked here.

        Args:
            kernel: Kernel to launch; its first parameter is ``offset``.
            dim: Number of threads.
            sources: Objects whose attributes supply arguments; the first that has the name wins.
            particles: Particles that the threads go through, if not one each.
            block: Threads of a block on CUDA, if not `BLOCK`.
            named: Arguments given here, before any source; a text is the name to look for instead.

        Raises:
            TypeError: An argument is missing, or belongs to another precision.
        """
        args = []
        for var, name in list(zip(kernel.adj.args, _names(kernel), strict=True))[1:]:
            value = named.get(name, name)
            if isinstance(value, str):
                owner = next((src for src in sources if hasattr(src, value)), None)
                if owner is None:
                    raise TypeError(f"{kernel.key}: no value for argument {value!r}")
                value = getattr(owner, value)
            args.append(_checked(kernel, var, name, value))
        light, count = LABOUR.isdisjoint(_names(kernel)), particles or dim
        most = count // (SMALLEST_LIGHT_SLICE if light else SMALLEST_SLICE)
        return Command(self, self._record(kernel, dim, args, most, block), not light or count >= WORTH_WAKING)

    def _record(
        self, kernel: wp.Kernel, dim: int, args: list, most: int, block: int | None
    ) -> list[wp.Launch]:
        """Record a launch in at most so many slices."""
        options = {"device": self.device, "block_dim": block or threads_of_block(self.device)}
        lengths = [arg.length for arg in args if isinstance(arg, Pieces)]
        recorded = []
        for first, size in self.slices(dim, most, min(lengths, default=dim)):
            given = [arg.serving(first) if isinstance(arg, Pieces) else arg for arg in args]
            recorded.append(wp.launch(kernel, size, [first, *given], record_cmd=True, **options))
        return recorded

    def launch(self, kernel: wp.Kernel, dim: int, *sources: object, **named: object) -> None:
        """Bind and run once."""
        self.bind(kernel, dim, *sources, **named)()


def _checked(kernel: wp.Kernel, var, name: str, value: object) -> object:
    """Refuse what Warp would accept and misread: foreign structs, foreign grids, arrays of another type."""
    if isinstance(value, wp.HashGrid):
        if _place(kernel) not in (None, value.dtype):
            raise TypeError(f"{kernel.key}: hash grid {name!r} has precision {value.dtype.__name__}")
        return value.id
    if hasattr(value, "_cls") and value._cls is not var.type:
        raise TypeError(f"{kernel.key}: struct {name!r} was built for another precision")
    if isinstance(value, Pieces):
        for array in value.arrays:
            _checked(kernel, var, name, array)
    if isinstance(value, wp.array):
        if not value.is_contiguous:  # loops over lanes count on it, see `kernels.lanes.Reads`
            raise TypeError(f"{kernel.key}: array {name!r} has gaps")
        expected, found = var.type.dtype, value.dtype
        if not wp.types.types_equal(expected, found):
            raise TypeError(
                f"{kernel.key}: array {name!r} has type {found.__name__}, not {expected.__name__}"
            )
    return value


def threads_of_block(device: wp.Device) -> int:
    """Give the number of threads that a block has on a device."""
    return BLOCK if device.is_cuda else 1


def find_device(name: str) -> wp.Device:
    """Give the Warp device of a name such as ``cpu`` or ``cuda:0``.

    Raises:
        InputError: If there is no such device; names the ones there are.
    """
    available = [d.alias for d in wp.get_devices()]
    if name == "cuda" and wp.is_cuda_available():
        name = wp.get_preferred_device().alias
    if name not in available:
        raise values.unknown("device", name, available)
    return wp.get_device(name)
