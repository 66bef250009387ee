"""What pair loops of a GPU read of a Lagrangian neighbour: put together and taken apart again, nothing is lost."""

import numpy as np
import pytest
import warp as wp
from tools import SPACING, body, by_id, forces, jittered

from warpsph.device.launch import Launcher
from warpsph.kernels.packets import PACKET, make_near, make_packing
from warpsph.kernels.spec import Spec
from warpsph.memory.policy import THRIFTY
from warpsph.solver import PRECISIONS

N = 37
MODULE = "warpsph.tests.packets"


def reader(s, near):
    """A kernel that takes records apart."""
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    moving, resting, X_of, tensor, put = near[:5]
    Packet, Part = near.motion.dtype, near.tensors.dtype

    @wp.kernel(module=f"{MODULE}.{s.tag}", enable_backward=False)
    def apart(
        offset: wp.int32,
        x: wp.array[point],
        v: wp.array[vec],
        rho: wp.array[real],
        cs: wp.array[real],
        motion: wp.array[Packet],
        rest: wp.array[Packet],
        T: wp.array[mat],
        # out:
        P: wp.array[Part],
        x_out: wp.array[point],
        X_out: wp.array[point],
        X_alone: wp.array[point],
        v_out: wp.array[vec],
        G_out: wp.array[vec],
        rho_out: wp.array[real],
        cs_out: wp.array[real],
        T_out: wp.array[mat],
    ):
        i = wp.tid() + offset
        put(P, i, T[i])
        x_i, v_i, rho_i, cs_i = moving(x, v, rho, cs, motion, i)
        X_i, G_i = resting(x, v, rest, i)
        x_out[i] = x_i
        v_out[i] = v_i
        rho_out[i] = rho_i
        cs_out[i] = cs_i
        X_out[i] = X_i
        G_out[i] = G_i
        X_alone[i] = X_of(x, rest, i)
        T_out[i] = tensor(P, i)

    return apart


@pytest.mark.parametrize("lanes", [1, 8], ids=["gpu", "cpu"])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_nothing_is_lost(precision, lanes):
    s = Spec(3, *PRECISIONS[precision], lanes=lanes)
    near, packing = make_near(s), make_packing(s, True)
    rng, types = np.random.default_rng(1), {"x": s.point, "v": s.vec, "rho": s.real, "cs": s.real, "T": s.mat}
    given = {
        name: wp.array(rng.normal(size=(N, *getattr(dtype, "_shape_", ()))), dtype=dtype, device="cpu")
        for name, dtype in types.items()
    }
    layouts = {"motion": near.motion, "rest": near.rest, "P": near.tensors}
    for name, layout in layouts.items():
        given[name] = wp.zeros(layout.each * N, dtype=layout.dtype, device="cpu")
    launcher = Launcher("cpu", 1)
    launcher.launch(packing.motion, N, **{n: given[n] for n in ("x", "v", "rho", "cs", "motion")})
    launcher.launch(packing.rest, N, X=given["x"], G0=given["v"], rest=given["rest"])
    names = {"x_out": "x", "X_out": "x", "X_alone": "x", "v_out": "v", "G_out": "v"}
    names |= {"rho_out": "rho", "cs_out": "cs", "T_out": "T"}
    out = {name: wp.zeros_like(given[source]) for name, source in names.items()}
    launcher.launch(reader(s, near), N, **given, **out)
    for name, source in names.items():
        np.testing.assert_array_equal(out[name].numpy(), given[source].numpy(), err_msg=name)
    if lanes == 1:
        assert {wp.types.type_size_in_bytes(layout.dtype) for layout in layouts.values()} == {PACKET}


@pytest.mark.parametrize("precision", PRECISIONS)
def test_forces_of_a_gpu_are_those_of_a_cpu(precision):
    """In space, where every number of a record counts, at once and from a state in motion."""
    X, found = jittered(3, 6), []
    for policy in (None, THRIFTY):
        v = 300.0 * np.sin(X[:, [1, 2, 0]] / (2.0 * SPACING))
        solver = body(3, X, v, material="aluminium", precision=precision, policy=policy, scheme="tl")
        solver.advance(1e-6)
        found.append([*forces(solver), by_id(solver, "F"), by_id(solver, "x")])
    tolerance = 1e-11 if precision == "float64" else 2e-4
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(other, one, rtol=0, atol=tolerance * np.abs(one).max())
