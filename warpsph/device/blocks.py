"""How particles are dealt out to the threads of a reduction."""

import math

import numpy as np

CPU_BLOCKS = 256
"""Blocks of a reduction on a CPU: fixed, so that sums do not depend on the number of threads."""

CUDA_BLOCKS = 2048
"""Blocks of the ledger on a GPU: the host adds them up."""

CUDA_STEP_BLOCKS = 32768
"""Blocks of the time step's reduction on a GPU, which has to fill it in every step."""

FOLDS = 128
"""So many partial results of these are left to the one thread that ends the step."""


class Blocks:
    """Deal of n particles to blocks, each the work of one thread.

    On a CPU the particles of a block are neighbours in memory; on a GPU those that the threads read at one time are.

    Attributes:
        count: Number of blocks.
        chunk: Particles per block; the last may hold fewer, none is empty on a CPU.
        along: From one particle of a block to the next.
        across: From a particle of one block to the same one of the next.
        n: Number of particles.
        folds: Partial results that a kernel between the blocks and the last thread leaves; 0: there is none.
    """

    def __init__(self, n: int, cuda: bool, most: int | None = None):
        """Deal to ``most`` blocks, or to as many as suit the device."""
        self.n = n
        self.chunk = -(-n // min(most or (CUDA_BLOCKS if cuda else CPU_BLOCKS), n))
        self.count = -(-n // self.chunk)
        self.along, self.across = (self.count, 1) if cuda else (1, self.chunk)
        self.folds = min(FOLDS, self.count) if cuda else 0


def total(values: np.ndarray) -> float:
    """Sum of partial results without rounding; with one beyond all numbers, what floating point makes of it."""
    try:
        return math.fsum(values.tolist())
    except (ValueError, OverflowError):
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.sum(values))
