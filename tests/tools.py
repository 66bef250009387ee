"""Small scenes and shorthands for the tests of the engine."""

import numpy as np
import warp as wp

from warpsph import materials as lib
from warpsph.config import Numerics
from warpsph.device.launch import Launcher
from warpsph.fields import BY_NAME, whole
from warpsph.kernels.spec import Spec
from warpsph.scene import Scene
from warpsph.shapes import Box, Disc, Sphere
from warpsph.solver import Solver

K, G, DENSITY = 80e9, 27e9, 2700.0
ELASTIC = lib.Material("elastic", DENSITY, lib.LinearElastic(K=K), lib.Elastic(G=G))
PLASTIC = lib.Material("plastic", DENSITY, lib.LinearElastic(K=K), lib.PerfectlyPlastic(G=G, Y=0.3e9))
FLUID = lib.Material("fluid", 1000.0, lib.StiffenedGas(c0=1480.0, gamma0=2.0), lib.Fluid())
SPACING = 1e-3
DOUBLE = {dim: Spec(dim, wp.float64) for dim in (1, 2, 3)}
REALS = ("float64", "float32")


def jittered(dim, n, amount=0.2, seed=0):
    """Points of an n^dim lattice, each moved by up to ``amount`` spacings along every axis [m], shape [n^dim, 3]."""
    x = np.zeros((n**dim, 3))
    x[:, :dim] = np.stack(np.meshgrid(*[np.arange(n)] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    x[:, :dim] += np.random.default_rng(seed).uniform(-amount, amount, size=(n**dim, dim))
    return SPACING * x


def scene(dim, until=1.0, **numerics):
    """Start an empty scene."""
    return Scene("test", dim=dim, spacing=SPACING, until=until, numerics=Numerics(**numerics))


def body(
    dim, points, velocity=(0.0, 0.0, 0.0), material=ELASTIC, precision="float64", policy=None, **numerics
):
    """Solver of one body of given points; ``velocity`` may be one for each."""
    made = scene(dim, **numerics)
    made.add_body("body", points, material, velocity=velocity)
    return Solver(made.finalize(), precision=precision, policy=policy)


def collision(dim=2, radius=4.5, speed=400.0, material="aluminium", **numerics):
    """A ball about to hit another, somewhat off the axis; ``radius`` in spacings."""
    made = scene(dim, **numerics)
    r, gap = radius * SPACING, 1.2 * SPACING
    ball = {1: lambda c: Box(c[0] - r, c[0] + r), 2: lambda c: Disc(r, c[:2]), 3: lambda c: Sphere(r, c)}[dim]
    made.add_body("left", ball((-r - 0.5 * gap, 0.0, 0.0)), material, velocity=(speed, 0.0, 0.0))
    made.add_body("right", ball((r + 0.5 * gap, 0.4 * r, 0.0)), material)
    return made


def run(made, time, **options):
    """Run a scene to a time [s] and give its solver."""
    solver = Solver(made.finalize(), **options)
    solver.advance(time)
    return solver


def one_step(solver):
    """Take one step, far shorter than the largest stable one."""
    before = solver.reading.steps
    solver.advance(solver.reading.time + 1e-9 * solver.data.h / 6000.0)
    assert solver.reading.steps == before + 1
    return solver


def overwrite(solver, **fields):
    """Give fields new values, in id order."""
    ids = solver.particles.id.numpy()
    for name, values in fields.items():
        values = np.asarray(values)[ids]
        getattr(solver.particles, name).assign(packed(values) if BY_NAME[name].kind == "sym" else values)


def forces(solver):
    """Accelerations [m/s²] and powers per mass [W/kg] of the state as it is, without a step, in id order."""
    scheme, order = solver._scheme, np.argsort(solver.particles.id.numpy())
    solver._run_still(scheme.derive(solver._bind) + scheme.probe(solver._bind))
    return solver.particles.dvdt.numpy()[order], solver._work.dedt.numpy()[order]


def by_id(solver, name):
    """A field of any kind in id order, on the host."""
    arrays = solver.particles.arrays()
    return whole(arrays[name][np.argsort(arrays["id"])], BY_NAME[name].kind)


def packed(tensors):
    """The six numbers of symmetric tensors, shape [n, 6], as the device keeps them."""
    return np.asarray(tensors)[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]


def launch(kernel, n, spec, **values):
    """Run a kernel of known arguments on given numbers; the arrays afterwards, by name.

    Arrays of shape [n, 3, 3] become tensors, symmetric ones where the kernel has such, [n, 3] vectors; what is no array
    is passed as it is.
    """
    kinds = {(3, 3): spec.mat, (3,): spec.vec, (6,): spec.sym, (): spec.real}
    types = {arg.label: getattr(arg.type, "dtype", None) for arg in kernel.adj.args}
    symmetric = {name for name, dtype in types.items() if dtype is spec.sym}
    arrays = {}
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            value = packed(value) if name in symmetric else value
            integers = value.dtype.kind == "i"
            arrays[name] = wp.array(
                value, dtype=wp.int32 if integers else kinds[value.shape[1:]], device="cpu"
            )
    Launcher("cpu", 1).launch(kernel, n, **(values | arrays))
    return {name: whole(array.numpy(), "sym" if name in symmetric else "") for name, array in arrays.items()}
