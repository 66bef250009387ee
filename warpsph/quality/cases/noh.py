"""Noh's implosion."""

from warpsph.scenes import noh as scene

from .tables import COST, ENERGY, Case, Figure, Row, Table

SCHEMES = ("av", "sav1-mixed", "pm", "ts1", "ts2", "ts2-mixed")


def noh() -> Case:
    """Noh 1987, on a wall and on an axis; in the first row the exact values at the end."""
    errors = (("rho", "density"), ("v", "velocity"), ("p", "pressure"))
    figures = (
        *(Figure(f"l1_{name}", title, style=".4f") for name, title in errors),
        Figure("wall_deficit", "lack of density at the origin", "%", 100.0, ".0f"),
        Figure("plateau_density", "plateau", "kg/m^3", style=".2f"),
        Figure("shock_position", "shock", "m", style=".4f", expected=(0.19, 0.21)),
        ENERGY, *COST,
    )  # fmt: skip

    def part(title: str, dim: int, *resolutions: int) -> Table:
        rows = tuple(
            Row(f"{s}, {dim}D, {n}", {"scheme": s, "particles": n, "dim": dim})
            for s in SCHEMES
            for n in resolutions
        )
        exact = {
            "plateau_density": scene.density_behind(dim),
            "shock_position": scene.shock_speed() * scene.UNTIL,
        }
        return Table(title, figures, rows, {"exact": exact})

    return Case("noh", (part("Onto a wall", 1, 100, 200, 400), part("Onto an axis", 2, 50, 100)))
