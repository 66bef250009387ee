"""How particles are dealt out to the blocks of a two-stage reduction."""

CPU_BLOCKS = 64
"""Blocks of a reduction on a CPU: fixed, so that sums do not depend on the number of threads."""

CUDA_BLOCKS = 512
"""Blocks of a reduction on a GPU."""


class Blocks:
    """Deal of n particles to blocks: contiguous runs on a CPU, strided (coalesced) on a GPU.

    Attributes:
        count: Number of blocks.
        chunk: Particles per block, at most.
        outer_stride: Distance of the first particles of two blocks.
        inner_stride: Distance of two particles of a block.
        n: Number of particles.
    """

    def __init__(self, n: int, cuda: bool):
        self.n = n
        self.count = min(CUDA_BLOCKS if cuda else CPU_BLOCKS, n)
        self.chunk = -(-n // self.count)
        self.outer_stride, self.inner_stride = (1, self.count) if cuda else (self.chunk, 1)
