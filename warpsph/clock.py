"""Time, time step and the device's verdict on the next step, kept in device memory."""

from dataclasses import dataclass

import numpy as np
import warp as wp

from .device.blocks import Blocks
from .device.launch import Launcher
from .kernels.spec import Spec

TIME, T_STOP, DT, DT_MIN, DT_MAX, DT_FIRST, WEAR = range(7)
"""Entries of `Clock.clock`."""

STAGES = ("folded", "last")
"""First words of the names of what each kernel leaves that folds the extremes of the blocks on a GPU."""


@dataclass(frozen=True)
class Reading:
    """The clock as the host reads it: times in s, the share of the skin used up, the status of `kernels.timestep`."""

    time: float
    dt: float
    dt_min: float
    dt_max: float
    wear: float
    status: int
    steps: int


class Clock:
    """Device arrays of the time step, named as the kernels of `kernels.timestep` know them.

    Attributes:
        dt: The step [s], shape [1]; 0 when no step is to be taken.
        clock: time, t_stop, dt, smallest, largest and first dt [s], wear of the skin, float64.
        count: Status and number of steps, int32.
        block_dt: Partial minima of dt [s].
        block_low: Partial minima of the components of velocity [m/s].
        block_high: Partial maxima of them [m/s].
        folded_dt: Minima of those of dt on a GPU, as the next ones.
        folded_low: Minima of those of velocity.
        folded_high: Maxima of those of velocity.
        folded_wear: Largest wear of the tiles.
        last_dt: Minima of those, few enough for one thread; ``last_low``, ``last_high``, ``last_wear`` likewise.
    """

    def __init__(self, spec: Spec, launcher: Launcher, blocks: Blocks):
        with wp.ScopedDevice(launcher.device):
            self.dt = wp.zeros(1, dtype=spec.real)
            self.clock = wp.array([0.0, 0.0, 0.0, np.inf, 0.0, 0.0, 0.0], dtype=wp.float64)
            self.count = wp.zeros(2, dtype=wp.int32)
            self.block_dt = wp.zeros(blocks.count, dtype=spec.real)
            self.block_low, self.block_high = (wp.zeros(blocks.count, dtype=spec.vec) for _ in range(2))
            extremes = {"dt": spec.real, "low": spec.vec, "high": spec.vec, "wear": spec.real}
            for stage, few in zip(STAGES, blocks.folds, strict=False):
                for name, dtype in extremes.items():
                    setattr(self, f"{stage}_{name}", wp.zeros(few, dtype=dtype))

    def read(self) -> Reading:
        """Read the clock: the one synchronisation of a batch of steps."""
        c, n = self.clock.numpy(), self.count.numpy()
        return Reading(
            float(c[TIME]),
            float(c[DT]),
            float(c[DT_MIN]),
            float(c[DT_MAX]),
            float(c[WEAR]),
            int(n[0]),
            int(n[1]),
        )

    def stop_at(self, time: float) -> None:
        """Set the time [s] that no step may pass and the last one hits exactly."""
        values = self.clock.numpy().copy()
        values[T_STOP] = time
        self.clock.assign(values)
