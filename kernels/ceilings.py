"""What a device can do at best, to hold a step's kernels against: a large copy, and a long row of multiply-adds."""

import functools
from typing import NamedTuple

import warp as wp

from .packets import PACKET
from .spec import Spec

CHAINS = 64
"""Independent sums of a thread: enough to keep vector units and pipelines full."""

PUT = """
#if defined(__CUDA_ARCH__)
    reinterpret_cast<int4*>(target.data)[i] = reinterpret_cast<const int4*>(source.data)[i];
#else
    target.data[i] = source.data[i];
#endif
"""
"""Puts a packet in its place, in one piece on a GPU: Warp's vectors are not aligned, and go number by number."""


class CeilingKernels(NamedTuple):
    """Kernels of this file, and the type of what is copied.

    Attributes:
        copy: Moves `packet` by `packet`.
        multiply_add: `CHAINS` chains of multiply-adds.
        packet: `PACKET` bytes of numbers.
    """

    copy: wp.Kernel
    multiply_add: wp.Kernel
    packet: type


@functools.cache
def make_ceilings(s: Spec) -> CeilingKernels:
    """Build the kernels for one precision."""
    real, chains = s.real, wp.types.vector(CHAINS, s.real)
    packet = wp.types.vector(PACKET // wp.types.type_size_in_bytes(real), real)
    module = s.module(__name__)

    @wp.func_native(PUT)
    def put(target: wp.array[packet], source: wp.array[packet], i: wp.int32): ...

    @wp.kernel(module=module)
    def copy(
        offset: wp.int32,
        # in:
        source: wp.array[packet],
        # out:
        target: wp.array[packet],
    ):
        """target = source [-]: two transfers of a packet and no arithmetic."""
        i = wp.tid() + offset
        put(target, source, i)

    @wp.kernel(module=module)
    def multiply_add(
        offset: wp.int32,
        # in:
        rounds: wp.int32,
        factor: real,
        # out:
        total: wp.array[real],
    ):
        """c ← c factor + factor in each chain, again and again [-]: two operations a round and no memory."""
        i = wp.tid() + offset
        chain, step = chains(), chains()
        for k in range(wp.static(CHAINS)):
            chain[k] = real(i + k)
            step[k] = factor
        for _round in range(rounds):
            chain = factor * chain + step
        out = real(0.0)
        for k in range(wp.static(CHAINS)):
            out += chain[k]
        total[i] = out

    return CeilingKernels(copy, multiply_add, packet)
