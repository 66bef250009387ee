"""Mixed kernel-and-gradient correction (method section 2; Bonet & Lok 1999; paper A eqs 3-5 and 14).

A particle stores K = K_a / S_a and G = G_a / S_a, so that the corrected gradient of a pair is
g_ab = K (∇_a W_ab - G W_ab): K = 1, G = 0 is the plain gradient, the fallback.
"""

import functools

import warp as wp

from .company import ALONE
from .coupling import make_counts
from .lanes import make_lanes, make_reads
from .mirror import make_mirror
from .smoothing import Smoothing
from .spec import Spec
from .tensor import make_tensor

CONDITION = 2.0e-2
"""Smallest det(M)/max(|M|, 1)^d of the moment matrix that is inverted; a worse one falls back to the plain gradient.

On a lattice M is 1 inside a body, and the ratio 0.46 at a face and 0.1 to 0.2 at an edge or corner in 2D and 3D, 0.07 at
a corner where h is 0.8 of the spacing. A fragment or a bent line of particles has a small M, or a flat one: gradients that
make up for it take many times their energy from its particles, until a tension without bound (hvi_2d, ``sav1-mixed-as``).
"""


@functools.cache
def make_correction(
    s: Spec,
    smoothing: Smoothing,
    planes: bool,
    separate: bool = False,
    coupled: bool = False,
    erosion: bool = False,
) -> wp.Kernel:
    """Build the kernel that computes K and G.

    Args:
        s: Specialisation.
        smoothing: Smoothing kernel.
        planes: Neighbour entries may be mirror images.
        separate: Neighbours of another body do not count.
        coupled: There are Lagrangian particles: those that are alone need no correction, see `kernels.company`.
        erosion: Eroded neighbours do not count.
    """
    real, vec, mat, point, dim = s.real, s.vec, s.mat, s.point, s.dim
    mirror, tensor = make_mirror(s, planes), make_tensor(s)
    w, dw_r, support = smoothing.w, smoothing.dw_r, real(smoothing.support)
    read = make_reads(s)
    lanes = make_lanes(s)
    worth, row_end = lanes.worth, lanes.row_end
    bound, counts, zero = real(CONDITION), make_counts(separate, erosion), real(0.0)
    options = (smoothing.name, "planes" * planes, "separate" * separate)
    options += ("coupled" * coupled, "erosion" * erosion)

    @wp.func
    def inverse_or_identity(M: mat, neighbours: wp.int32):
        """M⁻¹ in the components that move, or 1 where M is ill-conditioned or there is one neighbour or none."""
        one = wp.identity(n=3, dtype=real)
        size = real(1.0)
        for c in range(dim):
            size = wp.max(size, wp.length(M[c]))
        for c in range(dim, 3):
            M[c, c] = size
        det = wp.determinant(M)
        ok = neighbours >= 2 and wp.abs(det) > bound * size * size * size
        if ok:
            one = wp.inverse(M)
        return one, ok

    @wp.kernel(module=s.module(__name__, "_".join(filter(None, options)), lanes=True))
    def correction(
        offset: wp.int32,
        # in:
        x: wp.array[point],
        vol: wp.array[real],
        body: wp.array[wp.int32],
        kernel_type: wp.array[wp.int32],
        company: wp.array[wp.int32],
        h: real,
        plane: point,
        dt: wp.array[real],
        start: wp.array[wp.int32],
        n_neigh: wp.array[wp.int32],
        neigh: wp.array[wp.int32],
        # out:
        K: wp.array[mat],
        G: wp.array[vec],
    ):
        """S = Σ V W, G = Σ V ∇W / S, K = [Σ V ∇~W~ ⊗ (x_b - x_a)]⁻¹ / S (section 2; paper A eqs 3-5)."""
        i = wp.tid() + offset
        if dt[0] == real(0.0):
            return
        if wp.static(coupled):
            if company[i] == wp.static(ALONE):
                return
        first = start[i]
        last = row_end(first, n_neigh[i])
        xi = read.point(x, i)
        r_max2 = support * support * h * h
        shepard = vol[i] * w(real(0.0), h)
        # scalars, not vectors or matrices: the compiler keeps them in registers
        G_x, G_y, G_z = real(0.0), real(0.0), real(0.0)
        b_x, b_y, b_z = real(0.0), real(0.0), real(0.0)
        xx, yy, zz = real(0.0), real(0.0), real(0.0)
        xy, yz, xz = real(0.0), real(0.0), real(0.0)
        neighbours = wp.int32(0)
        k = wp.int32(first)
        while k < last:
            j = mirror.index(read.integer(neigh, k))
            xij = mirror.apart(xi, read.point(x, j), mirror.sign(read.integer(neigh, k)), plane)
            r2 = tensor.dot(xij, xij)
            near = (
                r2 < r_max2
                and read.integer(neigh, k) != i
                and counts(body[i], read.integer(body, j), read.integer(kernel_type, j))
            )
            if worth(near):
                r, V_j = wp.sqrt(r2), wp.where(near, real(read.real(vol, j)), zero)
                weight = V_j * w(r, h)
                slope = V_j * dw_r(r, h) * xij
                shepard += weight
                G_x += slope[0]
                b_x += weight * xij[0]
                xx += slope[0] * xij[0]
                if wp.static(dim > 1):
                    G_y += slope[1]
                    b_y += weight * xij[1]
                    xy += slope[0] * xij[1]
                    yy += slope[1] * xij[1]
                if wp.static(dim > 2):
                    G_z += slope[2]
                    b_z += weight * xij[2]
                    yz += slope[1] * xij[2]
                    xz += slope[0] * xij[2]
                    zz += slope[2] * xij[2]
                neighbours += wp.where(near, 1, 0)
            k += 1
        log_G = vec(G_x, G_y, G_z) / shepard
        # Σ V (∇W - W G) ⊗ (x_b - x_a), in one loop: G is the same for all b
        M = wp.outer(log_G, vec(b_x, b_y, b_z)) - mat(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        M = (real(1.0) / shepard) * M
        inverse, ok = inverse_or_identity(M, neighbours)
        if ok:
            K[i] = inverse / shepard
            G[i] = log_G
        else:
            K[i] = inverse
            G[i] = vec()

    return correction


@functools.cache
def make_gradient(s: Spec, corrected: bool) -> wp.Function:
    """Build g_ab(xij, dw, w, K, G, h, limit): corrected and limited, or the plain ∇W = dw xij."""
    real, vec, mat = s.real, s.vec, s.mat
    tensor = make_tensor(s)

    if not corrected:

        @wp.func
        def of_pair(xij: vec, dw: real, w_ij: real, K: mat, G: vec, h: real, limit: real):
            return dw * xij

        return of_pair

    @wp.func
    def of_pair(xij: vec, dw: real, w_ij: real, K: mat, G: vec, h: real, limit: real):
        """K (∇W - G W), or ∇W where the ratio leaves [1/limit, limit]: along ∇W at least, in size at most.

        Paper A 3.2 compares component by component. That depends on the axes: pairs nearly along one of them lose
        the correction to a small cross component, and a ring breaks along the axes.
        """
        plain = dw * xij
        g = tensor.product(K, plain - w_ij * G)
        along, square, size = tensor.dot(g, plain), tensor.dot(plain, plain), tensor.dot(g, g)
        limited = along * limit < square or size > limit * limit * square
        return vec(  # by component: a choice of vectors would be a branch
            wp.where(limited, plain[0], g[0]),
            wp.where(limited, plain[1], g[1]),
            wp.where(limited, plain[2], g[2]),
        )

    return of_pair
