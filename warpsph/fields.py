"""The one table of every particle quantity: drives allocation, sorting, output, checkpoints and rendering.

``name`` is the symbol used in the kernels and on the state (launches bind by it); ``title`` is what a
user sees in snapshots, on the command line and in pictures.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Field:
    """One particle quantity.

    Attributes:
        name: Symbol in kernels and on the state.
        kind: ``int`` and ``real`` have shape [n], ``vec`` and ``point`` (a position) [n, 3], ``mat`` [n, 3, 3],
            ``parts`` [n, k], k the number of `kernels.parts.Parts` of the run; ``sym``, a symmetric tensor, [n, 6] on
            the device (`kernels.spec.Spec.sym`) and [n, 3, 3] on the state.
        unit: SI unit, ``"1"`` if dimensionless.
        title: Name in snapshots and on the command line.
        meaning: One line for people.
        output: Whether snapshots hold it (checkpoints hold every field).
        group: Which runs have it on the device, `GROUPS`; ``""`` is all of them.
    """

    name: str
    kind: Literal["int", "real", "vec", "point", "mat", "sym", "parts"]
    unit: str
    title: str
    meaning: str
    output: bool = True
    group: str = ""


GROUPS = {
    "lagrangian": "runs with Lagrangian particles",
    "contact": "runs with contact",
    "constraint": "runs with fixed or driven particles",
    "sheet": "runs in plane stress",
    "switch": "runs with a switch of the viscosity",
    "parts": "runs whose forces have parts",
}
"""Groups of fields that only some runs need."""

CONSTANT = frozenset({"constraint"})
"""Groups whose output fields stay as they are at the start in runs without them: snapshots have them all the same."""

FIELDS: tuple[Field, ...] = (
    Field("id", "int", "1", "id", "particle number, 0..n-1; never changes"),
    Field("body", "int", "1", "body", "index of the particle's body"),
    Field("mat", "int", "1", "material", "index of the particle's material"),
    Field("kernel_type", "int", "1", "kernel_type", "0 Eulerian, 1 Total Lagrangian, 2 eroded"),
    Field(
        "fixed",
        "int",
        "1",
        "fixed",
        "bits 1, 2, 4: velocity component x, y, z is prescribed",
        True,
        "constraint",
    ),
    Field("x", "point", "m", "position", "position"),
    Field("v", "vec", "m/s", "velocity", "velocity"),
    Field("m", "real", "kg", "mass", "mass (per metre of thickness in 2D, per square metre in 1D)"),
    Field("rho", "real", "kg/m^3", "density", "mass density"),
    Field("e", "real", "J/kg", "internal_energy", "specific internal energy"),
    Field("vol", "real", "m^dim", "volume", "volume of the particle in the space of the problem", False),
    Field("p", "real", "Pa", "pressure", "pressure, positive in compression"),
    Field("cs", "real", "m/s", "sound_speed", "bulk sound speed of the equation of state", False),
    Field("cl", "real", "m/s", "longitudinal_speed", "longitudinal wave speed sqrt(c^2 + 4G/(3 rho))", False),
    Field("tau", "sym", "Pa", "deviatoric_stress", "deviator of the Cauchy stress"),
    Field(
        "sig",
        "sym",
        "Pa",
        "stress",
        "Cauchy stress, tension positive (times the thickness in plane stress)",
        False,
    ),
    Field("ep", "real", "1", "plastic_strain", "equivalent plastic strain"),
    Field(
        "thickness",
        "real",
        "1",
        "thickness",
        "thickness over its initial value",
        False,
        "sheet",
    ),
    Field("p_high", "real", "Pa", "peak_pressure", "highest pressure so far"),
    Field("p_low", "real", "Pa", "lowest_pressure", "lowest pressure so far"),
    Field("clipped", "int", "1", "eos_clipped", "steps in which the equation of state left its range", False),
    Field("dvdx", "mat", "1/s", "velocity_gradient", "velocity gradient, [i, j] = dv_i/dx_j", False),
    Field("mu", "real", "m/s", "approach_speed", "largest |mu_ab| of the artificial viscosity", False),
    Field(
        "impulse",
        "vec",
        "N s",
        "constraint_impulse",
        "impulse given by constraints so far",
        False,
        "constraint",
    ),
    Field("work", "real", "J", "constraint_work", "work done by constraints so far", False, "constraint"),
    Field(
        "twist",
        "vec",
        "N m s",
        "constraint_twist",
        "angular impulse given by constraints so far",
        False,
        "constraint",
    ),
    Field(
        "av_switch", "real", "1", "viscosity_switch", "factor on the artificial viscosity", False, "switch"
    ),
    Field("dvdt", "vec", "m/s^2", "acceleration", "acceleration of the last step", False),
    Field("T", "real", "K", "temperature", "temperature, from plastic work alone"),
    Field("D", "real", "1", "damage", "damage: 0 intact, 1 failed"),
    Field("ep_rate", "real", "1/s", "plastic_strain_rate", "plastic strain rate of the last step", False),
    Field(
        "e_parts",
        "parts",
        "J/kg",
        "booked_energy",
        "turned into internal energy by viscosity, ...",
        False,
        "parts",
    ),
    Field(
        "X", "point", "m", "reference_position", "position in the reference configuration", True, "lagrangian"
    ),
    Field("vol0", "real", "m^dim", "reference_volume", "volume in it", False, "lagrangian"),
    Field("F", "mat", "1", "deformation_gradient", "deformation gradient dx/dX", True, "lagrangian"),
    Field("ripe", "int", "1", "ripe", "1: about to convert", False, "lagrangian"),
    Field("inverted", "int", "1", "inverted", "times its F was not physical, J <= 0", False, "lagrangian"),
    Field(
        "cover",
        "real",
        "1",
        "contact_cover",
        "largest share of its support in other bodies",
        False,
        "contact",
    ),
    Field("contact_rate", "real", "1/s^2", "contact_rate", "contact stiffness over mass", False, "contact"),
)
"""Every quantity. A field is never renamed or reordered silently: old snapshots stay readable."""

BY_NAME = {f.name: f for f in FIELDS}
"""The table by symbol."""


SYMMETRIC = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Where the nine components of a symmetric tensor are among its six numbers xx, yy, zz, xy, yz, xz."""


def whole(values: np.ndarray, kind: str) -> np.ndarray:
    """A device array as the state gives it: symmetric tensors [n, 6] become [n, 3, 3]."""
    return values[:, SYMMETRIC] if kind == "sym" else values


def of_groups(groups: frozenset[str]) -> tuple[Field, ...]:
    """The fields of a run with the given groups, in the order of the table."""
    return tuple(f for f in FIELDS if not f.group or f.group in groups)
