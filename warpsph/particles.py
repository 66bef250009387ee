"""The particles on the device: one array per row of the field table."""

import numpy as np
import warp as wp

from .fields import FIELDS
from .kernels.sort import make_sort
from .kernels.spec import Spec
from .launch import Launcher
from .scene import SceneData
from .state import State

WIDTH = {"int": (), "real": (), "vec": (3,), "mat": (3, 3)}
"""Shape of one entry by a field's kind."""


class Particles:
    """Device arrays named by the symbols of `warpsph.fields`, all of length ``n``.

    Attributes:
        n: Number of particles.
        spec: Dimension and precision of the arrays.
    """

    def __init__(self, data: SceneData, spec: Spec, launcher: Launcher):
        """Allocate every field and fill in what the scene gives; the rest starts at zero."""
        self.n, self.spec, self._launcher = len(data.x), spec, launcher
        self._data = data
        given = {name: getattr(data, name) for name in ("x", "v", "m", "rho", "e", "body", "mat", "fixed")}
        given |= {"id": np.arange(self.n), "av_switch": np.ones(self.n), "thickness": np.ones(self.n)}
        given |= {"p_high": np.full(self.n, -np.inf), "p_low": np.full(self.n, np.inf)}
        given["T"] = np.array([m.initial_temperature for m in data.materials])[data.mat]
        for f in FIELDS:
            values = given.get(f.name, np.zeros((self.n, *WIDTH[f.kind])))
            setattr(self, f.name, self._upload(values, f.kind))
        self._scratch = {kind: wp.empty_like(getattr(self, name)) for kind, name in
                         {"int": "id", "real": "m", "vec": "x", "mat": "tau"}.items()}  # fmt: skip

    def _upload(self, values: np.ndarray, kind: str) -> wp.array:
        dtype = {"int": wp.int32, "real": self.spec.real, "vec": self.spec.vec, "mat": self.spec.mat}[kind]
        host = np.int32 if kind == "int" else wp.dtype_to_numpy(self.spec.real)
        return wp.array(np.ascontiguousarray(values, dtype=host), dtype=dtype, device=self._launcher.device)

    def reorder(self, order: wp.array) -> None:
        """Move every particle in memory: the k-th is the former order[k]. Array addresses stay the same."""
        gather = make_sort(self.spec)
        for f in FIELDS:
            old, new = getattr(self, f.name), self._scratch[f.kind]
            self._launcher.launch(gather[old.dtype], self.n, order=order, source=old, target=new)
            wp.copy(old, new)

    def arrays(self) -> dict[str, np.ndarray]:
        """Copy every field to the host, in memory order: what a checkpoint holds."""
        return {f.name: getattr(self, f.name).numpy().copy() for f in FIELDS}  # on a CPU numpy() is a view

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take over the arrays of a checkpoint."""
        for f in FIELDS:
            getattr(self, f.name).assign(arrays[f.name])

    def state(self, time: float, step: int) -> State:
        """Copy the output fields to the host, in id order."""
        data, order = self._data, np.argsort(self.id.numpy())
        fields = {f.name: getattr(self, f.name).numpy()[order] for f in FIELDS if f.output}
        return State(
            time=time, step=step, dim=data.dim, spacing=data.spacing, h=data.h, scene=data.name,
            bodies=list(data.bodies), materials=[m.name for m in data.materials], fields=fields,
        )  # fmt: skip
