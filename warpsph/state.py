"""A picture of the particles on the host: what measures, snapshots and frames are made from."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class State:
    """All particles at one time, in id order, in SI units.

    Attributes:
        time: Time [s].
        step: Number of steps taken.
        dim: Space dimension, 1, 2 or 3.
        spacing: Initial particle spacing [m].
        h: Smoothing length [m].
        scene: Name of the scene.
        bodies: Body names; ``fields["body"]`` indexes them.
        materials: Material names; ``fields["mat"]`` indexes them.
        fields: Arrays by the symbols of `warpsph.fields`; float64 or float32 (mixed precision: both), shape [n], [n, 3] or [n, 3, 3].
    """

    time: float
    step: int
    dim: int
    spacing: float
    h: float
    scene: str
    bodies: list[str]
    materials: list[str]
    fields: dict[str, np.ndarray] = field(default_factory=dict)

    def __getattr__(self, name: str) -> np.ndarray:
        """Give a field by its symbol: ``state.x`` is ``state.fields["x"]``."""
        fields = self.__dict__.get("fields", {})
        if name in fields:
            return fields[name]
        raise AttributeError(f"no field {name!r}; this state holds {', '.join(fields)}")

    def of(self, body: str) -> np.ndarray:
        """Mask of the particles of one body, shape [n], bool."""
        return self.fields["body"] == self.bodies.index(body)
