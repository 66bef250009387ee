"""The particles on the device: one array per row of the field table."""

from collections.abc import Callable

import numpy as np
import warp as wp

from .device.copies import to_device, to_host
from .device.launch import Launcher
from .fields import BY_NAME, CONSTANT, Field, of_groups, whole
from .kernels.kernel_type import ERODED, EULERIAN, LAGRANGIAN
from .kernels.parts import Parts, part_types
from .kernels.sort import make_sort
from .kernels.spec import Spec
from .messages import restarts
from .scene import SceneData
from .state import InOrder, State

WIDTH = {"int": (), "real": (), "vec": (3,), "point": (3,), "mat": (3, 3), "sym": (6,)}
"""Shape of one entry by a field's kind; ``parts`` has as many numbers as the run has parts."""


def element_types(spec: Spec, parts: Parts) -> dict[str, type]:
    """Type of one entry on the device by a field's kind."""
    return {
        "int": wp.int32, "real": spec.real, "vec": spec.vec, "point": spec.point, "mat": spec.mat, "sym": spec.sym,
        "parts": part_types(spec, len(parts)).power,
    }  # fmt: skip


class Particles:
    """Device arrays named by the symbols of `warpsph.fields`, all of length ``n``.

    Attributes:
        n: Number of particles.
        spec: Dimension and precision of the arrays.
        fields: The rows of the table that this run has.
        largest: Type of the largest entries.
    """

    def __init__(
        self,
        data: SceneData,
        spec: Spec,
        launcher: Launcher,
        groups: frozenset[str] = frozenset(),
        parts: Parts = (),
    ):
        """Allocate the fields of the groups and fill in what the scene gives; the rest starts at zero.

        Args:
            data: The scene.
            spec: Dimension and precision.
            launcher: The device.
            groups: Groups of fields that the run has.
            parts: Parts of the forces that it keeps apart.
        """
        self.n, self.spec, self._launcher = len(data.x), spec, launcher
        self._data, self.fields = data, of_groups(groups)
        self._shown = [f for f in of_groups(groups | CONSTANT) if f.output]
        self._types = element_types(spec, parts)
        self._width = WIDTH | {"parts": (len(parts),)}
        given = {name: getattr(data, name) for name in ("x", "v", "m", "rho", "e", "body", "mat", "fixed")}
        given |= {"id": np.arange(self.n), "av_switch": np.ones(self.n), "thickness": np.ones(self.n)}
        given |= {"p_high": np.full(self.n, -np.inf), "p_low": np.full(self.n, np.inf)}
        given["T"] = np.array([m.initial_temperature for m in data.materials])[data.mat]
        given |= {"X": data.x, "vol0": data.m / data.rho, "F": np.broadcast_to(np.eye(3), (self.n, 3, 3))}
        if "lagrangian" in groups:
            given["kernel_type"] = np.where(data.eulerian, EULERIAN, LAGRANGIAN)
        for f in self.fields:
            values = given.get(f.name, np.zeros((self.n, *self._width[f.kind])))
            setattr(self, f.name, self._upload(values, f.kind))
        self.largest = max(
            (getattr(self, f.name).dtype for f in self.fields), key=wp.types.type_size_in_bytes
        )

    def _upload(self, values: np.ndarray, kind: str) -> wp.array:
        host = wp.dtype_to_numpy({"int": wp.int32, "point": self.spec.place}.get(kind, self.spec.real))
        return wp.array(
            np.ascontiguousarray(values, dtype=host), dtype=self._types[kind], device=self._launcher.device
        )

    def reorder(self, order: wp.array, scratch: Callable[[type], wp.array]) -> None:
        """Move every particle in memory: the k-th is the former order[k]. Array addresses stay the same.

        Args:
            order: Permutation, shape [n].
            scratch: Gives room for n entries of a type.
        """
        gather = make_sort(self.spec)
        for f in self.fields:
            old = getattr(self, f.name)
            new = scratch(old.dtype)
            self._launcher.launch(gather[old.dtype], self.n, order=order, source=old, target=new)
            wp.copy(old, new)

    def lasting(self) -> dict[str, wp.array]:
        """The array of every field by name, in memory order."""
        return {f.name: getattr(self, f.name) for f in self.fields}

    def arrays(self) -> dict[str, np.ndarray]:
        """Copy every field to the host, in memory order."""
        return to_host(self.lasting())

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take over the arrays of a checkpoint.

        Raises:
            InputError: If numbers of bodies, materials and the like stand for nothing.
        """
        self._check(arrays)
        for f in self.fields:
            to_device(getattr(self, f.name), arrays[f.name])

    def _check(self, arrays: dict[str, np.ndarray]) -> None:
        """Check what kernels rely on: a wrong index would make them read and write elsewhere."""
        ends = {"body": len(self._data.bodies), "mat": len(self._data.materials), "kernel_type": ERODED + 1}
        sound = [0 <= arrays[name].min() <= arrays[name].max() < end for name, end in ends.items()]
        if not all(sound) or not np.array_equal(np.sort(arrays["id"]), np.arange(self.n)):
            raise restarts.wrong_numbers(["id", *ends])

    def state(self, time: float, step: int, host: Callable[[str], np.ndarray] | None = None) -> State:
        """Copy the output fields to the host, in id order.

        Args:
            time: Time [s].
            step: Number of steps taken.
            host: Gives a field on the host in memory order; the state then gathers a field when it is asked for.
        """
        data = self._data
        stored = host or (lambda name: getattr(self, name).numpy())
        fields = InOrder([f.name for f in self._shown], lambda name: self._whole(BY_NAME[name], stored))
        if host is None:
            fields = dict(fields)
        return State(
            time=time, step=step, dim=data.dim, spacing=data.spacing, h=data.h, scene=data.name,
            bodies=list(data.bodies), materials=[m.name for m in data.materials], fields=fields,
        )  # fmt: skip

    def _whole(self, f: Field, stored: Callable[[str], np.ndarray]) -> np.ndarray:
        """A field as the state gives it, in memory order; where the run has no use for it, as it was at the start."""
        if hasattr(self, f.name):
            return whole(stored(f.name), f.kind)
        return getattr(self._data, f.name)[stored("id")].astype(np.int32)
