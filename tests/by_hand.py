"""The equations of the method once more, in numpy, dense and slow: what the kernels are compared with."""

import math

import numpy as np


def cubic_spline(r, dim, h):
    """W [1/m^dim] and dW/dr of the cubic spline."""
    q, sigma = r / h, {1: 2 / 3, 2: 10 / (7 * math.pi), 3: 1 / math.pi}[dim] / h**dim
    w = np.where(q < 1, 1 - 1.5 * q**2 + 0.75 * q**3, 0.25 * np.maximum(2 - q, 0) ** 3)
    dw = np.where(q < 1, -3 * q + 2.25 * q**2, -0.75 * np.maximum(2 - q, 0) ** 2)
    return sigma * w, sigma * dw / h


def gradients(x, V, dim, h, corrected, others=True):
    """Gradients g_ab [1/m^(dim+1)], shape [a, b, 3], plain or with the mixed correction (section 2), never limited.

    ``others``: which b count, shape [b].
    """
    xij = x[:, None] - x
    r = np.linalg.norm(xij, axis=-1)
    w, dw = cubic_spline(r, dim, h)
    counts = (r < 2.0 * h) & np.broadcast_to(others, len(x))
    plain = (counts * dw / np.where(r > 0.0, r, 1.0))[..., None] * xij
    if not corrected:
        return plain
    w = w * counts
    S, G = w @ V, np.einsum("b,abi->ai", V, plain)
    tilde = plain / S[:, None, None] - G[:, None] * (w / S[:, None] ** 2)[..., None]
    M = -np.einsum("b,abi,abj->aij", V, tilde, xij)
    M[:, range(dim, 3), range(dim, 3)] = 1.0
    g = np.einsum("aij,abj->abi", np.linalg.inv(M), tilde)
    g[~(counts & (r > 0.0))] = 0.0
    return g


def cofactor(F):
    """J F⁻ᵀ."""
    return np.linalg.det(F)[:, None, None] * np.linalg.inv(F).swapaxes(1, 2)


def lagrangian_forces(g, V0, P):
    """f_ab = V0_a V0_b (P_a g0_ab - P_b g0_ba) [N], shape [a, b, 3] (section 4)."""
    first = np.einsum("aij,abj->abi", P, g)
    return np.outer(V0, V0)[..., None] * (first - np.einsum("bij,baj->abi", P, g))


def lagrangian_powers(g, V0, P, v):
    """m_a de_a/dt = Σ V0_a V0_b (v_b - v_a)·(P_a g0_ab) [W], shape [a] (section 4)."""
    first = np.outer(V0, V0)[..., None] * np.einsum("aij,abj->abi", P, g)
    return np.einsum("abi,abi->a", v[None] - v[:, None], first)


def viscous_forces(x, v, m, rho, cs, h, alpha, beta, q):
    """f_ab = m_a m_b Π_ab/2 q_ab [N], shape [a, b, 3], of approaching pairs (sections 3 and 4)."""
    xij, vij = x[:, None] - x, v[:, None] - v
    closing = np.minimum(np.sum(vij * xij, axis=-1), 0.0)
    mu = h * closing / (np.sum(xij**2, axis=-1) + 0.01 * h**2)
    mean = 0.5 * (cs[:, None] + cs)
    big_pi = (-alpha * mean * mu + beta * mu**2) / (0.5 * (rho[:, None] + rho))
    return (0.5 * np.outer(m, m) * big_pi)[..., None] * q


def lagrangian_viscous_directions(g, F):
    """q_ab = J_a⁻¹ F_b⁻ᵀ g0_ba - J_b⁻¹ F_a⁻ᵀ g0_ab, shape [a, b, 3] (section 4)."""
    J, inverse = np.linalg.det(F), np.linalg.inv(F)
    own = np.einsum("aji,abj->abi", inverse, g) / J[None, :, None]
    other = np.einsum("bji,baj->abi", inverse, g) / J[:, None, None]
    return other - own
