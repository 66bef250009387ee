"""Copper bar on a rigid wall."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

SPACING = {across: 25.4e-3 / layers for across, layers in ((12, 40), (18, 60), (24, 80))}
"""Particle spacing [m] by the number of particles across the diameter."""

LENGTH = {"unit": "mm", "factor": 1e3}
"""How a length is shown."""

MEASURED = (
    Figure("final_length", "length", expected=(16.93, 17.63), **LENGTH),
    Figure("foot_diameter", "foot", **LENGTH),
    Figure("diameter_02", "at 0.2 L0", **LENGTH),
)
"""What is left; within 2 % of the finite elements' length."""

RUN = (ENERGY, MOMENTUM, *COST)

CONVERTED = Figure("converted_share", "converted", "%", 100.0, ".0f")


def _lengths(*values: float) -> dict[str, float]:
    """Length, foot and diameter at 0.2 L0 [mm]."""
    return {figure.name: value for figure, value in zip(MEASURED, values, strict=True)}


def taylor_bar() -> Case:
    """Judged against finite elements with the very same constants, which leave the bar longer than the measured one."""
    others = {
        "finite elements, same constants": _lengths(17.28, 14.59, 9.45),
        "measured bar": _lengths(16.21, 13.56, 10.10),
    }
    return Case(
        "taylor_bar",
        (
            Table("Schemes, 18 across", (*MEASURED, *RUN), _schemes(), others),
            Table("Conversion at a strain of 0.85", (*MEASURED, CONVERTED, *RUN), _adaptive(), others),
            Table("Resolution", (*MEASURED, *RUN), _resolutions(), others),
        ),
    )


def _row(name: str, across: int, **parameters: str | float | bool) -> Row:
    """A run with so many particles across the diameter."""
    return Row(name, {"spacing": SPACING[across]} | parameters)


def _schemes() -> tuple[Row, ...]:
    schemes = ("tl", "tl-plain", "sav1", "sav1-mixed", "ts2", "ts2-mixed")
    return (*(_row(s, 18, scheme=s) for s in schemes), _row("tl, α 1", 18, viscosity=1.0))


def _adaptive() -> tuple[Row, ...]:
    return (
        _row("adaptle", 18, scheme="adaptle"),
        _row("adaptle-mixed", 18, scheme="adaptle-mixed"),
        _row("adaptle, 12 across", 12, scheme="adaptle"),
    )


def _resolutions() -> tuple[Row, ...]:
    return (
        _row("tl, 12 across", 12),
        _row("tl, 12 across, whole bar", 12, quarter=False),
        _row("tl, 24 across", 24),
    )
