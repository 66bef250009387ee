"""Small made-up states for the tests of output."""

import numpy as np

from warpsph.state import State


def impact(time=0.0, dim=2, real=np.float64, seed=0):
    """A block that has flown for a time towards a plate; every output field holds something."""
    rng = np.random.default_rng(seed)
    axes = [np.arange(k) * 1e-3 for k in (6, 6, 6)[:dim]]
    block = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dim)
    x = np.zeros((2 * len(block), 3))
    x[: len(block), :dim] = block
    x[len(block) :, :dim] = block
    x[len(block) :, 0] += 8e-3
    n, body = len(x), np.repeat([0, 1], len(block)).astype(np.int32)
    v = np.where(body[:, None] == 0, [500.0, 0.0, 0.0], 0.0)
    stress = rng.normal(size=(n, 3, 3)) * 1e8
    fields = {
        "id": np.arange(n, dtype=np.int32),
        "body": body,
        "mat": np.zeros(n, dtype=np.int32),
        "kernel_type": np.zeros(n, dtype=np.int32),
        "fixed": np.zeros(n, dtype=np.int32),
        "x": (x + v * time).astype(real),
        "v": v.astype(real),
        "m": np.full(n, 2.7e-3, dtype=real),
        "rho": np.full(n, 2700.0, dtype=real),
        "e": rng.random(n).astype(real),
        "p": np.linspace(-1e9, 2e9, n).astype(real),
        "tau": (stress + stress.transpose(0, 2, 1)).astype(real),
        "ep": rng.random(n).astype(real),
        "p_high": np.full(n, 2e9, dtype=real),
        "p_low": np.full(n, -1e9, dtype=real),
        "T": np.linspace(293.15, 900.0, n).astype(real),
        "D": rng.random(n).astype(real),
        "X": x.astype(real),
        "F": (np.eye(3) + 0.1 * rng.normal(size=(n, 3, 3))).astype(real),
    }
    return State(
        time=time,
        step=round(time * 1e9),
        dim=dim,
        spacing=1e-3,
        h=1.2e-3,
        scene="block_on_plate",
        bodies=["block", "plaque d'acier trempé"],
        materials=["aluminium"],
        fields=fields,
    )
