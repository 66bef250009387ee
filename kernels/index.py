"""The index of a particle, said to be no negative one.

Warp counts a negative index from the end of the array. For each array that it is used with, the compiler has to see to
that, with the array's length in a register, unless it knows better.
"""

import warp as wp


@wp.func
def natural(i: wp.int32):
    """The same index, known not to be negative: its highest bit is none."""
    return i & wp.int32(0x7FFFFFFF)
