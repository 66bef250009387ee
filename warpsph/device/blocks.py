"""How particles are dealt out to the threads of a reduction."""

import math

import numpy as np

CPU_BLOCKS = 256
"""Blocks of a reduction on a CPU: fixed, so that sums do not depend on the number of threads."""

CUDA_BLOCKS = 2048
"""Blocks of the ledger on a GPU: the host adds them up."""

CUDA_STEP_BLOCKS = 32768
"""Blocks of the time step's reduction on a GPU, which has to fill it in every step."""

FOLDS = (1024, 32)
"""So many partial results are left of these by one kernel after the other, before the one thread that ends the step.

A thread waits for every partial result that it goes through: in three stages for 32 each, in two for 181."""


class Blocks:
    """Deal of n particles to blocks, each the work of one thread.

    On a CPU the particles of a block are neighbours in memory; on a GPU those that the threads read at one time are.

    Attributes:
        count: Number of blocks.
        chunk: Particles per block; the last may hold fewer, none is empty on a CPU.
        along: From one particle of a block to the next.
        across: From a particle of one block to the same one of the next.
        n: Number of particles.
        folds: Partial results that the kernels between the blocks and the last thread leave; none on a CPU.
    """

    def __init__(self, n: int, cuda: bool, most: int | None = None):
        """Deal to ``most`` blocks, or to as many as suit the device."""
        self.n = n
        self.chunk = -(-n // min(most or (CUDA_BLOCKS if cuda else CPU_BLOCKS), n))
        self.count = -(-n // self.chunk)
        self.along, self.across = (self.count, 1) if cuda else (1, self.chunk)
        self.folds = tuple(min(most, self.count) for most in FOLDS) if cuda else ()


def total(values: np.ndarray) -> float:
    """Sum of partial results without rounding; with one beyond all numbers, what floating point makes of it."""
    try:
        return math.fsum(values.tolist())
    except (ValueError, OverflowError):
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.sum(values))
