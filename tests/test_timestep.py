"""The time step: each of its limits where that one decides."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest
import warp as wp
from tools import REALS, SPACING, body, jittered, scene

from warpsph.device.launch import Launcher
from warpsph.errors import RunError
from warpsph.kernels.lanes import make_lanes
from warpsph.kernels.timestep import make_timestep
from warpsph.shapes import Box
from warpsph.solver import Solver


def first_step(made):
    """Length of the first step [s]."""
    solver = Solver(made.finalize())
    solver.advance(math.inf, lambda now: True)
    return solver.reading.dt_max


def gas(speed, energy):
    """Ideal gas that flows together from both sides at ``speed`` [m/s]."""
    made = scene(1)
    made.add_body(
        "gas",
        Box(-10 * SPACING, 10 * SPACING),
        "air",
        velocity=lambda x: -speed * np.sign(x) * [1.0, 0.0, 0.0],
        internal_energy=energy,
    )
    return made


def test_sound_limits_a_gas_at_rest():
    h, c = 1.2 * SPACING, math.sqrt(1.4 * 0.4 * 1000.0)
    assert first_step(gas(0.0, 1000.0)) <= 0.5 * h / (1.6 * c) * (1 + 1e-12)


def test_approach_limits_the_first_step_of_a_cold_gas():
    """The gas has no sound speed to speak of; without a limit its two halves would pass through each other."""
    dt = first_step(gas(100.0, 1e-12))
    assert 0.0 < 2.0 * 100.0 * dt < SPACING


def test_courant_number_scales_the_step():
    steps = []
    for cfl in (0.5, 0.25):
        made = scene(1, cfl=cfl)
        made.add_body("bar", Box(0.0, 10 * SPACING), "aluminium")
        steps.append(first_step(made))
    assert steps[0] == pytest.approx(2.0 * steps[1], rel=1e-12)


def test_ranks_are_in_the_order_of_the_numbers(precision):
    lanes, real = make_lanes(precision), precision.real

    @wp.kernel(module="unique")
    def ranks(numbers: wp.array[real], rank: wp.array[lanes.Bits], back: wp.array[real]):
        i = wp.tid()
        rank[i] = lanes.rank(numbers[i])
        back[i] = lanes.ranked(rank[i])

    numbers = np.array([-math.inf, -1e30, -7.5, -1e-30, -0.0, 0.0, 1e-30, 0.1, 7.5, 1e30, math.inf])
    source = wp.array(numbers, dtype=real, device="cpu")
    rank, back = (wp.empty(len(numbers), dtype=dtype, device="cpu") for dtype in (lanes.Bits, real))
    wp.launch(ranks, len(numbers), inputs=[source, rank, back], device="cpu")
    assert (np.diff(rank.numpy().astype(object)) > 0).all()
    np.testing.assert_array_equal(back.numpy(), source.numpy())


@pytest.mark.parametrize("precision", REALS)
def test_the_box_of_velocities_is_exact(precision):
    """All move one way along x, through zero along y: the diagonal of the box decides, none of their speeds."""
    v = np.zeros((25, 3))
    v[:, 0], v[:, 1] = np.linspace(-9e5, -5e5, 25), np.linspace(2e5, -1e5, 25)
    solver = body(2, jittered(2, 5), v, precision=precision)
    solver.advance(math.inf, lambda now: True)
    assert solver.reading.dt_max == pytest.approx(solver.data.h / 5e5, rel=1e-6)


@pytest.mark.parametrize("precision", REALS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_velocity_that_is_not_finite_ends_the_run_before_a_step(value, precision):
    """Extremes pass over what is not a number: the step must not."""
    solver = body(2, jittered(2, 5), precision=precision)
    solver.advance(math.inf, lambda now: True)
    v, steps = solver.particles.v.numpy(), solver.reading.steps
    v[12, 1] = value
    solver.particles.v.assign(v)
    with pytest.raises(RunError, match="velocity not finite"):
        solver.advance(math.inf)
    assert solver.reading.steps == steps


LOAD = """
import sys
import warp as wp

wp.config.kernel_cache_dir, wp.config.cpu_compiler_flags = sys.argv[1], "-march=native -Rpass=loop-vectorize"
wp.init()
from warpsph.kernels.spec import Spec
from warpsph.kernels.timestep import make_timestep
make_timestep(Spec(2, wp.float64)).local.module.load("cpu")
"""


def test_the_loop_over_particles_is_in_lanes(tmp_path):
    """A minimum that a compiler takes for one of what may be no number makes it go from particle to particle."""
    done = subprocess.run(
        [sys.executable, "-c", LOAD, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert re.search(r"timestep.*remark: vectorized loop", done.stdout + done.stderr)


@pytest.mark.parametrize(
    ("blocks", "tiles", "few"), [(1000, 77, 32), (33, 1000, 32), (32, 31, 32), (5, 1, 4)]
)
def test_a_fold_loses_nothing(precision, blocks, tiles, few):
    """Of numbers that are no multiple of the threads, and of fewer than them."""
    random, real, vec = np.random.default_rng(1), precision.real, precision.vec
    dt, wear = random.uniform(1.0, 2.0, blocks), random.uniform(0.0, 1.0, tiles)
    low, high = random.normal(size=(2, blocks, 3))
    left = {"dt": wp.zeros(few, dtype=real), "wear": wp.zeros(few, dtype=real)}
    left |= {name: wp.zeros(few, dtype=vec) for name in ("low", "high")}
    Launcher("cpu", 1).launch(
        make_timestep(precision).fold, few, block_dt=wp.array(dt, dtype=real), tile_wear=wp.array(wear, dtype=real),
        block_low=wp.array(low, dtype=vec), block_high=wp.array(high, dtype=vec),
        **{f"folded_{name}": array for name, array in left.items()},
    )  # fmt: skip
    numpy, found = wp.dtype_to_numpy(real), {name: array.numpy() for name, array in left.items()}
    assert found["dt"].min() == dt.astype(numpy).min() and found["wear"].max() == wear.astype(numpy).max()
    np.testing.assert_array_equal(found["low"].min(axis=0), low.astype(numpy).min(axis=0))
    np.testing.assert_array_equal(found["high"].max(axis=0), high.astype(numpy).max(axis=0))
