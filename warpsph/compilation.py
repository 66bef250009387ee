"""Compile the kernels of a run side by side, before the first of them is launched."""

from collections.abc import Iterator

import warp as wp


def kernels_of(*holders: object) -> set[wp.Kernel]:
    """Find the kernels among the attributes of objects, in named tuples and dictionaries too."""
    return {kernel for holder in holders for value in vars(holder).values() for kernel in _within(value)}


def load(kernels: set[wp.Kernel], device: wp.Device, workers: int) -> None:
    """Load the modules of kernels on a device, compiling those that the kernel cache lacks in several threads.

    Warp would compile one module after the other, each at its first launch. A module that is loaded already costs
    nothing.

    Args:
        kernels: The kernels that will be launched.
        device: Where they will be launched.
        workers: Threads that compile.
    """
    modules = sorted({kernel.module for kernel in kernels}, key=lambda module: module.name)
    wp.force_load(device, modules, max_workers=workers)


def _within(value: object) -> Iterator[wp.Kernel]:
    if isinstance(value, wp.Kernel):
        yield value
    elif isinstance(value, tuple | list | dict):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _within(part)
