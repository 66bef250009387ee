"""What threads of a CPU agree on while they replay a step side by side: who takes a slice, and that all have come so far.

Here alone threads write what others read, and wait for each other; particles are none of it.
"""

import functools
from typing import NamedTuple

import warp as wp

from .spec import Spec

PATIENCE = 1000
"""Looks at the others before a waiting thread lets the system run something else on its core: some 50 microseconds."""

MET, LEFT = range(2)
"""Entries of ``meeting``: how often a thread has come; not 0: somebody will not come any more."""


class TeamKernels(NamedTuple):
    """Kernels of this file."""

    claim: wp.Kernel
    meet: wp.Kernel
    countdown: wp.Kernel


@functools.cache
def make_team(s: Spec) -> TeamKernels:
    """Build the kernels, which are the same for every specialisation; on a GPU nobody launches them."""
    module = s.module(__name__)

    @wp.func_native(
        """
        #ifdef __CUDA_ARCH__
        return 1;
        #else
        return 1 - (__atomic_fetch_add(&claims.data[k], 1, __ATOMIC_ACQ_REL) & 1);
        #endif
        """
    )
    def first(claims: wp.array[wp.int32], k: wp.int32) -> wp.int32: ...

    @wp.func_native(
        """
        #ifndef __CUDA_ARCH__
        const long long met = __atomic_fetch_add(&meeting.data[0], 1, __ATOMIC_ACQ_REL);
        const long long all = met - met % threads + threads;
        for (long long looks = 0; __atomic_load_n(&meeting.data[0], __ATOMIC_ACQUIRE) < all; ++looks) {
            if (__atomic_load_n(&meeting.data[1], __ATOMIC_RELAXED))
                return 1;
            if (looks > patience)
                reinterpret_cast<wp::int32 (*)()>(give_way)();
            #ifdef __x86_64__
            else
                __builtin_ia32_pause();
            #endif
        }
        #endif
        return 0;
        """
    )
    def missed(
        meeting: wp.array[wp.int64], threads: wp.int32, patience: wp.int32, give_way: wp.uint64
    ) -> wp.int32: ...

    @wp.kernel(module=module)
    def claim(
        offset: wp.int32,
        # out:
        claims: wp.array[wp.int32],
        mine: wp.array[wp.int32],
    ):
        """mine = 1 for the first of the two threads that come to a slice in a step, 0 for the second [-]."""
        k = wp.tid() + offset
        mine[0] = first(claims, k)

    @wp.kernel(module=module)
    def meet(
        offset: wp.int32,
        # in:
        threads: wp.int32,
        give_way: wp.uint64,
        # out:
        meeting: wp.array[wp.int64],
        alone: wp.array[wp.int32],
    ):
        """Wait until all ``threads`` have come so far: alone = 0; or until one has left: 1 [-].

        ``give_way``: address of a function of C that lets another program run on this core.
        """
        i = wp.tid() + offset
        alone[i] = missed(meeting, threads, wp.static(PATIENCE), give_way)

    @wp.kernel(module=module)
    def countdown(
        offset: wp.int32,
        # in:
        alone: wp.array[wp.int32],
        # out:
        rest: wp.array[wp.int32],
    ):
        """Repetitions that a thread has before it [-]: one fewer, or none once it is alone."""
        i = wp.tid() + offset
        rest[i] = wp.where(alone[i] == 0, rest[i] - 1, 0)

    return TeamKernels(claim, meet, countdown)
