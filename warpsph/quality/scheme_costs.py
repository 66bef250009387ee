"""What the schemes of Connolly et al. 2013 cost: each in turn, relative to the one with artificial viscosity."""

from collections.abc import Callable
from dataclasses import replace
from statistics import median

from warpsph.scene import Scene
from warpsph.solver import Solver

from . import series
from .series import Series, Variant, first_steps

SCHEMES = (
    ("av", "acoustic"),
    ("pm", "acoustic"),
    ("ts1", "acoustic"),
    ("ts2", "acoustic"),
    ("ts2", "two-shock"),
)
"""Scheme and Riemann solver of each row; the first is what the others are compared with."""

HEADER = (
    "scheme", "Riemann solver", "precision", "threads", "ns per particle-step: median", "min", "max",
    "relative to av, per step", "step relative to av", "steps per rebuild",
)  # fmt: skip
"""Columns of the table."""


def scheme_costs(
    scene: Scene, variants: list[Variant], repeats: int, say: Callable[[str], None]
) -> tuple[tuple[str, ...], list[list[str]]]:
    """Measure the first steps of a scene with every scheme in turn.

    Args:
        scene: The scene; its scheme is changed.
        variants: Ways to compute it; those in double precision are taken.
        repeats: Repetitions.
        say: Where progress goes.

    Returns:
        Header and rows of the table.
    """
    rows = []
    for variant in (v for v in variants if v.precision == "float64"):
        cases = []
        for scheme, riemann in SCHEMES:
            scene.numerics = replace(scene.numerics, scheme=scheme, riemann=riemann)
            data = scene.finalize()
            cases.append((data, Series(scheme, "first steps", variant, len(data.x))))
        for k in range(repeats):
            say(f"schemes, {variant.threads or 1} threads: repetition {k + 1} of {repeats}")
            for data, row in cases:
                first_steps(row, data)
        steps = [_mean_step(Solver(data, device=variant.device)) for data, _ in cases]
        base = median(cases[0][1].ns)
        for (data, row), dt in zip(cases, steps, strict=True):
            middle = median(row.ns)
            rows.append([
                row.case, data.numerics.riemann if row.case != "av" else "-", variant.precision,
                str(variant.threads or "-"), f"{middle:.4g}", f"{min(row.ns):.4g}", f"{max(row.ns):.4g}",
                f"{middle / base:.2f}", f"{dt / steps[0]:.2f}", f"{row.steps / max(row.builds, 1):.1f}",
            ])  # fmt: skip
    return HEADER, rows


def _mean_step(solver: Solver) -> float:
    """Mean length of the first steps [s]."""
    solver.advance(float("inf"), lambda now: now.steps >= series.WARM_UP + series.STEPS)
    return solver.reading.time / solver.reading.steps
