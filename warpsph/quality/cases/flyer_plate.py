"""Flyer plate."""

from pathlib import Path

import numpy as np

from warpsph import materials
from warpsph.quality.figures import Panel, profiles
from warpsph.scenes import flyer_plate as scene
from warpsph.storage import snapshot

from .tables import COST, MOMENTUM, Case, Convergence, Figure, Picture, Row, Table

SCHEMES = ("av", "pm", "ts1", "ts2")
"""The four schemes of the paper."""

CONVERGING = (*SCHEMES, "ts2-mixed")
"""Those that are run at every resolution."""

RESOLUTIONS = (100, 200, 400, 800)
"""Particles in both plates; the paper's are 100."""

TITLES = {
    "rho": ("density", "kg/m^3"),
    "v": ("velocity", "m/s"),
    "p": ("pressure", "Pa"),
    "tau": ("deviatoric stress τxx", "Pa"),
}
"""Name and unit of the fields of the scene."""

ERRORS = tuple(
    Figure(f"l1_{name}", title, style=".4f")
    for name, title in (("rho", "density"), ("v", "velocity"), ("p", "pressure"), ("tau", "stress"))
)
PLATEAUS = (
    Figure("star_pressure", "P*", "GPa", 1e-9, ".3f", (8.78, 8.96)),
    Figure("star_stress", "τ*", "GPa", 1e-9, ".3f", (-1.70, -1.63)),
    Figure("overshoot_p", "overshoot", "%", 100.0, ".1f"),
    Figure("overshoot_front", "at the front", "%", 100.0, ".1f"),
)
ENERGY = Figure("energy_error", "energy error", "%", 100.0, ".2g", (0.0, 1e-10))
"""In per cent, as the paper has it."""

VARIANTS = {
    "superbee": {"limiter": "superbee"},
    "superbee, limit_jump": {"limiter": "superbee", "limit_jump": True},
    "minmod, limit_jump": {"limit_jump": True},
    "mc": {"limiter": "mc"},
    "vanleer": {"limiter": "vanleer"},
    "sweby 1.5": {"limiter": "sweby"},
    "sweby 1.1": {"limiter": "sweby", "limiter_beta": 1.1},
    "two-shock": {"riemann": "two-shock"},
}
"""Parameters of the variants of ts2."""


def flyer_plate() -> Case:
    """Connolly et al. 2013, section 4.1 and Table 2."""
    _, star = scene.fronts(materials.get("flyer"))
    exact = {"exact": {"star_pressure": 1e-9 * star.p, "star_stress": 1e-9 * star.tau}}
    paper = {scheme: {"energy_error": 1.48e-8} for scheme in ("ts1", "ts2")}
    schemes = tuple(
        Row(f"{s}, {n}", {"scheme": s, "particles": n}, paper.get(s, {}) if n == 100 else {})
        for s in CONVERGING
        for n in RESOLUTIONS
    )
    explicit = tuple(
        Row(f"{s}, {n}", {"scheme": s, "particles": n}, {"energy_error": error} if n == 100 else {}, unexpected=("energy_error",))
        for s, error in (("av-explicit", 1.51), ("pm-explicit", 2.34))
        for n in (100, 400)
    )  # fmt: skip
    variants = tuple(
        Row(f"ts2, {name}, {n}", {"scheme": "ts2", "particles": n} | parameters)
        for name, parameters in VARIANTS.items()
        for n in (100, 400)
    )
    full = tuple(
        Row(f"{s}, full, {n}", {"scheme": s, "particles": n, "eos": "full"})
        for s in SCHEMES
        for n in (100, 400)
    )
    _, star = scene.fronts(materials.get("flyer-full"))
    exact_full = {"exact, full": {"star_pressure": 1e-9 * star.p, "star_stress": 1e-9 * star.tau}}
    pressure = Figure("star_pressure", "P*", "GPa", 1e-9, ".3f", (9.07, 9.25))
    return Case(
        "flyer_plate",
        (
            Table("Schemes", (*ERRORS, *PLATEAUS, ENERGY, MOMENTUM, *COST), schemes, exact),
            Table("Energy stepped as in the paper", (*ERRORS, *PLATEAUS[:2], ENERGY, MOMENTUM), explicit),
            Table("Variants of ts2", (*ERRORS, *PLATEAUS, ENERGY), variants, exact),
            Table("Full equation of state", (*ERRORS, pressure, *PLATEAUS[1:], ENERGY), full, exact_full),
        ),
        (Picture("flyer_plate.png", draw),),
        Convergence(
            "Order of convergence from 100 to 200, to 400, to 800 particles",
            ERRORS,
            {s: tuple(f"{s}, {n}" for n in RESOLUTIONS) for s in CONVERGING},
        ),
    )


def draw(runs: dict[str, Path], path: Path) -> None:
    """Draw the fields of the four schemes at the paper's resolution over the exact ones.

    Args:
        runs: Folders of the runs by the names of their rows.
        path: The picture.

    Raises:
        DiskError: If the picture cannot be written.
    """
    states = {s: snapshot.read(snapshot.find(runs[f"{s}, {RESOLUTIONS[0]}"])[-1]) for s in SCHEMES}
    time = next(iter(states.values())).time
    x = np.linspace(*scene.INSIDE, 4001)
    exact = scene.exact(materials.get("flyer"), x, time)
    panels = [
        Panel(*TITLES[name], (x, exact[name]), {s: (q.x[:, 0], values(q)) for s, q in states.items()})
        for name, values in scene.FIELDS.items()
    ]
    profiles(panels, path)
