"""How particles are dealt out to the blocks of a two-stage reduction."""

CPU_BLOCKS = 256
"""Blocks of a reduction on a CPU: fixed, so that sums do not depend on the number of threads."""

CUDA_BLOCKS = 2048
"""Blocks of a reduction on a GPU."""


class Blocks:
    """Deal of n particles to blocks of neighbours in memory.

    Attributes:
        count: Number of blocks.
        chunk: Particles per block; the last may hold fewer, none is empty.
        n: Number of particles.
    """

    def __init__(self, n: int, cuda: bool):
        self.n = n
        self.chunk = -(-n // min(CUDA_BLOCKS if cuda else CPU_BLOCKS, n))
        self.count = -(-n // self.chunk)
