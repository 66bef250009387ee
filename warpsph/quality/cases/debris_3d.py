"""Steel sphere through an aluminium plate."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

CONSERVED = ("energy_error", "momentum_error")
"""What the coupling as printed does not conserve."""

PAPER = {"carries": "all", "coupling": "printed", "correction": False, "viscosity": 1.0}
"""Parameters of the paper's simulations."""


def _young(*values: float) -> dict[str, float]:
    """One row of Young et al.'s Table 2: v_d, v_p [m/s], d_i, w_p, h_pl [mm]."""
    names = ("debris_velocity", "plug_velocity", "impact_diameter", "plug_width", "lip_height")
    return dict(zip(names, values, strict=True))


def debris_3d() -> Case:
    """Young et al., AdapTLE, section 3.3 and Table 2: the finite elements are the reference."""
    speed, length = {"unit": "m/s", "style": ".0f"}, {"unit": "mm", "factor": 1e3}
    figures = (
        Figure("debris_velocity", "v_d", **speed),
        Figure("plug_velocity", "v_p", **speed),
        Figure("impact_diameter", "d_i", **length),
        Figure("plug_width", "w_p", **length),
        Figure("lip_height", "h_pl", **length),
        Figure("converted_share", "converted", "%", 100.0),
        Figure("failed", "failed", style=".0f"),
        Figure("spalled", "spalled", style=".0f"),
        ENERGY, MOMENTUM, *COST,
    )  # fmt: skip
    fem = {"FEM, Young et al.": _young(299, 343, 14.20, 8.75, 8.71)}
    published = {
        "eul": _young(324, 463, 13.32, 0.88, 9.76),
        "tlag": _young(270, 443, 13.92, 5.88, 5.69),
        "patch": _young(319, 449, 13.44, 0.88, 9.79),
        "adaptle": _young(257, 373, 14.08, 8.38, 10.16),
    }
    paper = tuple(
        Row(
            f"{s}, as printed",
            PAPER | {"scheme": s},
            values,
            unexpected=CONSERVED if s in ("patch", "adaptle") else (),
        )
        for s, values in published.items()
    )
    return Case(
        "debris_3d",
        (
            Table("The paper's simulations", figures, paper, fem),
            Table("With energy conserved", figures, _conservative(), fem),
            Table("Variants of adaptle, a quarter of the plate", figures, _variants(), fem),
        ),
    )


def _conservative() -> tuple[Row, ...]:
    """The defaults of every scheme, and the paper's parameters but for its coupling."""
    schemes = ("adaptle", "tlag", "patch", "eul")
    return (
        *(Row(s, {"scheme": s}) for s in schemes),
        Row("adaptle, as in the paper but for the coupling", PAPER | {"coupling": "conservative"}),
    )


def _variants() -> tuple[Row, ...]:
    """What each choice that the paper leaves open, or that departs from it, comes to."""
    variants = {
        "as it is": {},
        "plain gradients": {"correction": False},
        "α 1": {"viscosity": 1.0},
        "strength kept": {"carries": "all"},
        "no layers": {"layers": 0},
        "2 layers": {"layers": 2},
        "χ 1": {"chi": 1.0},
        "C 0.0101": {"rate_constant": 0.0101},
        "stiffer contact": {"contact_stiffness": 1.0},
        "spacing 0.75 mm": {"spacing": 7.5e-4},
    }
    return tuple(Row(name, {"quarter": True} | values) for name, values in variants.items())
