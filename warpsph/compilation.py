"""Compile the kernels of a run side by side, before the first of them is launched."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import warp as wp

from .launch import count_cores

PER_THREAD = 4
"""Modules that a thread has to compile to be worth it: it makes a precompiled header first, in the time of some six."""


def kernels_of(*holders: object) -> set[wp.Kernel]:
    """Find the kernels among the attributes of objects, in named tuples too."""
    return {kernel for holder in holders for value in vars(holder).values() for kernel in _within(value)}


def compile_modules(kernels: set[wp.Kernel], device: wp.Device) -> None:
    """Load the modules of kernels, each compiled by one thread if the kernel cache lacks it.

    Warp by itself compiles a module at the first launch that needs it, one after the other.

    Args:
        kernels: Kernels that will be launched, with Warp's usual number of threads per block.
        device: Where they will be launched.
    """
    modules = sorted({kernel.module for kernel in kernels}, key=lambda module: module.name)
    workers = min(count_cores(), len(modules) // PER_THREAD)
    if workers < 2:
        wp.force_load(device, modules, max_workers=0)
        return
    pool = ThreadPoolExecutor(workers)
    try:
        for loaded in [pool.submit(wp.force_load, device, [module], max_workers=0) for module in modules]:
            loaded.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)  # who is told to stop does not wait for the compiler


def _within(value: object) -> Iterator[wp.Kernel]:
    if isinstance(value, wp.Kernel):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _within(part)
