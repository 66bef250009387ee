"""Flyer plate."""

from pathlib import Path

import numpy as np

from warpsph import materials
from warpsph.quality.figures import Panel, profiles
from warpsph.scenes import flyer_plate as scene
from warpsph.storage import snapshot

from .tables import COST, MOMENTUM, Case, Convergence, Figure, Row, Table

SCHEMES = ("av", "pm", "ts1", "ts2")
"""The four schemes of the paper, in its order of merit."""

RESOLUTIONS = (100, 200, 400, 800)
"""Particles in both plates."""

DRAWN = 100
"""Resolution of the picture; the paper's."""

TITLES = {
    "rho": ("density", "kg/m^3"),
    "v": ("velocity", "m/s"),
    "p": ("pressure", "Pa"),
    "tau": ("deviatoric stress τxx", "Pa"),
}
"""Name and unit of the fields of the scene."""


def flyer_plate() -> Case:
    """Connolly et al. 2013, section 4.1 and Table 2; the limits on the errors guard what is reached."""
    titles = {"l1_rho": "density", "l1_v": "velocity", "l1_p": "pressure", "l1_tau": "stress"}
    errors = tuple(Figure(name, title, style=".4f") for name, title in titles.items())
    energy = Figure("energy_error", "energy error", "%", 100.0, ".1e", (0.0, 1e-10))
    figures = (
        *errors,
        Figure("star_pressure", "P*", "GPa", 1e-9, ".3f", (8.78, 8.96)),
        Figure("star_stress", "τ*", "GPa", 1e-9, ".3f", (-1.68, -1.63)),
        Figure("overshoot_p", "overshoot P", "%", 100.0, ".2f"),
        Figure("overshoot_v", "overshoot v", "%", 100.0, ".2f"),
        energy, MOMENTUM, *COST,
    )  # fmt: skip
    names = {s: tuple(f"{s}, {n}" for n in RESOLUTIONS) for s in SCHEMES}
    rows = tuple(
        Row(f"{s}, {n}", {"scheme": s, "particles": n}) for s in SCHEMES for n in RESOLUTIONS
    )
    return Case(
        "flyer_plate",
        (Table("Schemes", figures, rows),),
        Convergence("Order of convergence: 100 to 200, 200 to 400, 400 to 800 particles", errors, names),
        draw,
    )


def draw(runs: dict[str, Path], path: Path) -> None:
    """Draw the fields of all schemes over the exact ones.

    Args:
        runs: Folders of the runs by the names of their rows.
        path: The picture.
    """
    states = {s: snapshot.read(snapshot.find(runs[f"{s}, {DRAWN}"])[-1]) for s in SCHEMES}
    time = next(iter(states.values())).time
    x = np.linspace(*scene.INSIDE, 4001)
    exact = scene.exact(materials.get(scene.MATERIALS["printed"]), x, time)
    panels = []
    for name, (title, unit) in TITLES.items():
        values = {s: (state.x[:, 0], scene.FIELDS[name](state)) for s, state in states.items()}
        panels.append(Panel(title, unit, (x, exact[name]), values))
    profiles(panels, path)
