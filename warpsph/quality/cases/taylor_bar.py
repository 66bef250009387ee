"""Copper bar on a rigid wall."""

from .tables import COST, ENERGY, MOMENTUM, Case, Figure, Row, Table

SPACING = {12: 25.4e-3 / 40, 18: 25.4e-3 / 60}
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

FREE = ("final_length",)
"""What is not expected of rows that show a fault."""

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
            Table("Schemes, 12 across", (*MEASURED, *RUN), _schemes(), others),
            Table("Conversion at a strain of 0.85", (*MEASURED, CONVERTED, *RUN), _adaptive(), others),
            Table("Resolution", (*MEASURED, *RUN), _resolutions(), others),
        ),
    )


def _row(name: str, across: int, unexpected: tuple[str, ...] = (), **parameters: str | float | bool) -> Row:
    """A run with so many particles across the diameter."""
    return Row(name, {"spacing": SPACING[across]} | parameters, unexpected=unexpected)


def _schemes() -> tuple[Row, ...]:
    """One set of parameters, then what the planes of symmetry, plain gradients and the viscosity of strong shocks do."""
    schemes = ("tl", "sav1", "sav1-mixed", "ts2", "ts2-mixed")
    return (
        *(_row(scheme, 12, scheme=scheme) for scheme in schemes),
        _row("tl, whole bar", 12, quarter=False),
        _row("tl-plain", 12, FREE, scheme="tl-plain"),
        _row("tl, α 1", 12, FREE, viscosity=1.0),
    )


def _adaptive() -> tuple[Row, ...]:
    """Eulerian particles with plain and with corrected gradients."""
    return (
        _row("adaptle", 12, scheme="adaptle"),
        _row("adaptle-mixed", 12, scheme="adaptle-mixed"),
        _row("adaptle, 18 across", 18, scheme="adaptle"),
    )


def _resolutions() -> tuple[Row, ...]:
    return (
        _row("tl, 18 across", 18),
        _row("ts2, 18 across", 18, scheme="ts2"),
    )
