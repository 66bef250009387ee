"""What a particle's row holds, in a scene with Lagrangian particles: which loop in the Eulerian form it needs."""

import functools

import warp as wp

from .kernel_type import EULERIAN
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .spec import Spec

ANY, ALONE, PLAIN, MIXED = -1, 0, 1, 2
"""Not told apart; a Lagrangian particle without a term in the Eulerian form; one whose every pair has every term, as in a
purely Eulerian scene; all others, whose pairs have to be looked at one by one."""


@functools.cache
def make_company(s: Spec, planes: bool, separate: bool) -> wp.Kernel:
    """Build the kernel that looks through the rows.

    Args:
        s: Specialisation.
        planes: Neighbour entries may be mirror images.
        separate: Bodies act on each other through contact alone.
    """
    read, mirror, lanes = make_reads(s), make_mirror(s, planes), make_lanes(s)
    row_end, stride = lanes.row_end, lanes.stride
    options = ("planes" * planes, "separate" * separate)

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def company(
        offset: wp.int32,
        # in:
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        changed: wp.array[s.real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        company: wp.array[wp.int32],
    ):
        """company = `ALONE`, `PLAIN` or `MIXED` by the neighbours in the row, beyond the support too (section 5).

        Of a pair an Eulerian neighbour, or one of another body, means every term to an Eulerian particle; with contact
        only an Eulerian one of the same body does. Of those a Lagrangian particle has none if it is alone.
        """
        i = wp.tid() + offset
        if changed[0] == s.real(0.0):
            return
        first = start[i]
        last = row_end(first, n_neigh[i])
        whole = wp.int32(0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            eulerian = wp.where(read.integer(kernel_type, j) == wp.static(EULERIAN), 1, 0)
            foreign = wp.where(read.integer(body, j) != body[i], 1, 0)
            if wp.static(separate):
                whole += eulerian & (1 - foreign)
            else:
                whole += eulerian | foreign
            k += stride
        found = wp.int32(wp.static(MIXED))
        if kernel_type[i] == wp.static(EULERIAN):
            # what fills up the row counts, for it is the particle itself
            if whole == (last - first) / stride:
                found = wp.static(PLAIN)
        elif whole == 0:
            found = wp.static(ALONE)
        company[i] = found

    return company
