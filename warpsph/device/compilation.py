"""Compile the kernels of a run side by side, before the first of them is launched."""

import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import warp as wp

from warpsph.messages import output

from .cores import count_cores
from .launch import threads_of_block

PER_THREAD = 4
"""Modules that a thread has to compile to be worth it: it makes a precompiled header first, in the time of some six."""

PER_MODULE = 2e6
"""Bytes that a compiled module may take on the disk."""


def kernels_of(*holders: object) -> set[wp.Kernel]:
    """Find the kernels among the attributes of objects, in named tuples too."""
    return {kernel for holder in holders for value in vars(holder).values() for kernel in _within(value)}


def compile_modules(kernels: set[wp.Kernel], device: wp.Device) -> None:
    """Load the modules of kernels, each compiled by one thread if the kernel cache lacks it.

    Warp by itself compiles a module at the first launch that needs it, one after the other.

    Args:
        kernels: Kernels that will be launched, with the device's usual number of threads per block.
        device: Where they will be launched.

    Raises:
        DiskError: If the disk of the kernel cache is too full for those that it lacks.
    """
    modules = sorted({kernel.module for kernel in kernels}, key=lambda module: module.name)
    _check_room(modules, device)
    block, workers = threads_of_block(device), min(count_cores(), len(modules) // PER_THREAD)
    if workers < 2:
        wp.force_load(device, modules, block_dim=block, max_workers=0)
        return
    pool = ThreadPoolExecutor(workers)
    try:
        loading = [pool.submit(wp.force_load, device, [module], block, max_workers=0) for module in modules]
        for loaded in loading:
            loaded.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)  # who is told to stop does not wait for the compiler


def _check_room(modules: Sequence[wp.Module], device: wp.Device) -> None:
    """See that the kernel cache takes what has to be compiled: on a full disk the compiler would end the process."""
    cache = Path(wp.config.kernel_cache_dir)
    free = shutil.disk_usage(cache).free
    if free < PER_MODULE * len(modules):
        block = threads_of_block(device)
        lacking = [module for module in modules if not (cache / module.get_module_identifier(block)).is_dir()]
        if free < PER_MODULE * len(lacking):
            raise output.full_cache(cache, PER_MODULE * len(lacking), free)


def _within(value: object) -> Iterator[wp.Kernel]:
    if isinstance(value, wp.Kernel):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _within(part)
