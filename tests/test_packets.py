"""What pair loops of a GPU read of a Lagrangian neighbour: put together and taken apart again, nothing is lost."""

import numpy as np
import pytest
import warp as wp
from tools import SPACING, body, by_id, forces, jittered

from warpsph.device.launch import Launcher
from warpsph.fields import whole
from warpsph.kernels.packets import PACKET, make_near, make_packing
from warpsph.kernels.spec import Spec
from warpsph.memory.policy import THRIFTY
from warpsph.solver import PRECISIONS

N = 37
MODULE = "warpsph.tests.packets"


def reader(s, near):
    """A kernel that takes records apart."""
    real, vec, mat, point = s.real, s.vec, s.mat, s.point
    put, Moving, Packet, Cofactor = near.put, near.motion.dtype, near.rest.dtype, near.cofs.dtype

    @wp.kernel(module=f"{MODULE}.{s.tag}", enable_backward=False)
    def apart(
        offset: wp.int32,
        x: wp.array[point],
        v: wp.array[vec],
        rho: wp.array[real],
        cs: wp.array[real],
        motion: wp.array[Moving],
        site: wp.array[Packet],
        rest: wp.array[Packet],
        T: wp.array[mat],
        sig: wp.array[s.sym],
        # out:
        P: wp.array[mat],
        cof: wp.array[Cofactor],
        x_out: wp.array[point],
        X_out: wp.array[point],
        X_alone: wp.array[point],
        v_out: wp.array[vec],
        G_out: wp.array[vec],
        rho_out: wp.array[real],
        cs_out: wp.array[real],
        T_out: wp.array[mat],
        P_out: wp.array[mat],
        Pv_out: wp.array[vec],
        Tv_out: wp.array[vec],
    ):
        i = wp.tid() + offset
        put(P, cof, i, T[i], sig[i], cs[i])
        r, q, t = near.present(site, i), near.resting(rest, i), near.strained(cof, i)
        x_out[i] = near.x(x, r, i)
        v_out[i] = near.v(v, motion, i)
        rho_out[i] = near.rho(rho, r, i)
        cs_out[i] = near.cs(cs, t, i)
        X_out[i] = near.X(x, q, i)
        G_out[i] = near.G0(v, q, i)
        X_alone[i] = near.X_alone(x, rest, i)
        T_out[i] = near.cofactor(cof, i)
        P_out[i] = near.piola(P, sig, cof, i)
        Pv_out[i] = near.P_times(P, t, i, v[i])
        Tv_out[i] = near.cof_times(cof, t, i, v[i])

    return apart


@pytest.mark.parametrize("lanes", [1, 8], ids=["gpu", "cpu"])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_nothing_is_lost(precision, lanes):
    s = Spec(3, *PRECISIONS[precision], lanes=lanes)
    near, packing = make_near(s), make_packing(s, True)
    rng, types = np.random.default_rng(1), {"x": s.point, "v": s.vec, "rho": s.real, "cs": s.real, "T": s.mat}
    types["sig"] = s.sym
    given = {
        name: wp.array(rng.normal(size=(N, *getattr(dtype, "_shape_", ()))), dtype=dtype, device="cpu")
        for name, dtype in types.items()
    }
    layouts = {"motion": near.motion, "site": near.site, "rest": near.rest, "cof": near.cofs}
    for name, layout in layouts.items():
        given[name] = wp.zeros(layout.each * N, dtype=layout.dtype, device="cpu")
    launcher = Launcher("cpu", 1)
    launcher.launch(packing.motion, N, **{n: given[n] for n in ("v", "motion")})
    launcher.launch(packing.site, N, **{n: given[n] for n in ("x", "rho", "site")})
    launcher.launch(packing.rest, N, X=given["x"], G0=given["v"], rest=given["rest"])
    names = {"x_out": "x", "X_out": "x", "X_alone": "x", "v_out": "v", "G_out": "v"}
    names |= {"rho_out": "rho", "cs_out": "cs", "T_out": "T"}
    results = {"P": "T", "P_out": "T", "Pv_out": "v", "Tv_out": "v"}
    out = {name: wp.zeros_like(given[like]) for name, like in (names | results).items()}
    launcher.launch(reader(s, near), N, **given, **out)
    for name, source in names.items():
        np.testing.assert_array_equal(out[name].numpy(), given[source].numpy(), err_msg=name)
    sig, T, v = (given[name].numpy().astype(float) for name in ("sig", "T", "v"))
    P = whole(sig, "sym") @ T
    tolerance = 1e-13 if s.real is wp.float64 else 1e-5
    for name, known in (("P_out", P), ("Pv_out", P @ v[:, :, None]), ("Tv_out", T @ v[:, :, None])):
        np.testing.assert_allclose(
            out[name].numpy().reshape(known.shape), known, atol=tolerance, err_msg=name
        )
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
