"""Ceilings of a device, measured: how fast it copies memory, and how fast it multiplies and adds."""

import time
from dataclasses import dataclass
from types import SimpleNamespace

import warp as wp

from warpsph.device.launch import Command, Launcher
from warpsph.kernels.ceilings import CHAINS, make_ceilings
from warpsph.kernels.packets import PACKET
from warpsph.kernels.spec import Spec

COPIED_CPU, COPIED_CUDA = 1 << 29, 1 << 30
"""Bytes of the array that is copied: more than any cache holds."""

THREADS_CPU, THREADS_CUDA = 1 << 10, 1 << 20
"""Threads that multiply and add; of a GPU so many that its last wave of blocks, perhaps a small one, hardly counts."""

ROUNDS = 10_000
"""Multiply-adds of each of a thread's chains."""

REPEATS = 5
"""Repetitions; the fastest counts, for a ceiling is what nothing disturbs."""


@dataclass(frozen=True)
class Ceilings:
    """What a device does at best in one precision.

    Attributes:
        bandwidth: Bytes read and written by a copy [1/s].
        flops: Multiplications and additions [1/s].
    """

    bandwidth: float
    flops: float


def measure(launcher: Launcher, real: type) -> Ceilings:
    """Measure the ceilings of a device, with its threads, in a precision (``wp.float32`` or ``wp.float64``)."""
    kernels = make_ceilings(Spec(3, real))
    cuda = launcher.device.is_cuda
    count = (COPIED_CUDA if cuda else COPIED_CPU) // PACKET
    threads, rounds = (THREADS_CUDA if cuda else THREADS_CPU), ROUNDS
    with wp.ScopedDevice(launcher.device):
        work = SimpleNamespace(
            source=wp.ones(count, dtype=kernels.packet), target=wp.zeros(count, dtype=kernels.packet),
            total=wp.zeros(threads, dtype=real), rounds=rounds, factor=0.5,
        )  # fmt: skip
    copy = _fastest(launcher, launcher.bind(kernels.copy, count, work))
    sums = _fastest(launcher, launcher.bind(kernels.multiply_add, threads, work))
    return Ceilings(bandwidth=2.0 * PACKET * count / copy, flops=2.0 * CHAINS * rounds * threads / sums)


def _fastest(launcher: Launcher, command: Command) -> float:
    """Shortest time of a launch [s]; the first one, which loads the kernel, does not count."""
    return min([_taken(launcher.device, command) for _ in range(1 + REPEATS)][1:])


def _taken(device: wp.Device, command: Command) -> float:
    """Time of a launch [s]: on CUDA between two events, for the way to the device and back is none of its own."""
    if device.is_cuda:
        begin, end = (wp.Event(device, enable_timing=True) for _ in range(2))
        device.stream.record_event(begin)
        command()
        device.stream.record_event(end)
        return 1e-3 * wp.get_event_elapsed_time(begin, end)
    start = time.perf_counter()
    command()
    return time.perf_counter() - start
