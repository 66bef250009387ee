"""What Total Lagrangian and coupled schemes ask of a scene, checked before anything is allocated."""

from warpsph.errors import InputError
from warpsph.kernels.material import DamageId, StrengthId
from warpsph.messages import values
from warpsph.scene import SceneData

from . import LagrangianSettings

UNYIELDING = (StrengthId.FLUID, StrengthId.ELASTIC)
"""Strength laws without plastic strain."""


def check_eulerian(data: SceneData) -> None:
    """Refuse options of Lagrangian particles in a scheme that has none.

    Raises:
        InputError: Names the option and the schemes it goes with.
    """
    numerics = data.numerics
    given = {
        "conversion": numerics.conversion is not None,
        "erosion": numerics.erosion,
        "hourglass": numerics.hourglass > 0.0,
        "inverted": numerics.inverted != "stop",
    }
    for option, on in given.items():
        if on:
            raise _misfit(option, numerics.scheme, "a scheme with Lagrangian particles, tl... or adaptle...")


def check_lagrangian(data: SceneData, settings: LagrangianSettings) -> None:
    """Refuse what a scheme with Lagrangian particles cannot do.

    Raises:
        InputError: Names the field, its value and what is allowed.
    """
    numerics = data.numerics
    if settings.eulerian is None:
        given = {
            "conversion": numerics.conversion is not None,
            "inverted": numerics.inverted != "stop",
            "make_eulerian": data.eulerian.any(),
        }
        for option, on in given.items():
            if on:
                raise _misfit(option, numerics.scheme, "a coupled scheme, adaptle...")
    elif numerics.erosion:
        raise _misfit("erosion", numerics.scheme, "tl... (adaptle converts failed particles instead)")
    _check_solid(data)
    _check_erosion(data)
    if numerics.conversion is not None:
        _check_conversion(data)


def _check_solid(data: SceneData) -> None:
    """A fluid has no reference configuration that it keeps to."""
    for k, material in enumerate(data.materials):
        if material.strength.id == StrengthId.FLUID and (~data.eulerian[data.mat == k]).any():
            raise values.clash(
                f"material {material.name!r}",
                f"Lagrangian particles in scheme {data.numerics.scheme!r}",
                "a solid, or make_eulerian for all of it",
                "it has no strength",
            )


def check_contact(data: SceneData) -> None:
    """Refuse contact whose stiffness would be none.

    Raises:
        InputError: Names the material without a bulk modulus.
    """
    contact = data.numerics.contact
    if contact is None or contact.stiffness is None:
        return
    for material in data.materials:
        if material.bulk_speed == 0.0:
            raise values.clash(
                f"stiffness of Contact = {contact.stiffness:g}",
                f"material {material.name!r}",
                "modulus [Pa/m^dim] instead",
                "it is a share of bulk moduli, and that one has none at rest",
            )


def _check_erosion(data: SceneData) -> None:
    if data.numerics.erosion and len(data.bodies) > 1 and data.numerics.contact is None:
        raise values.lacks(
            "erosion = True with several bodies", "contact", "contact = Contact(...), or one body"
        )
    if data.numerics.erosion and not _has_damage(data):
        raise values.lacks("erosion = True", _fails(data), "False, or a material with damage")


def _check_conversion(data: SceneData) -> None:
    """Conversion needs the state that its criteria look at."""
    conversion = data.numerics.conversion
    if conversion.damage and not _has_damage(data):
        raise values.lacks("conversion by damage", _fails(data), "damage = False, or a material with damage")
    plastic = conversion.strain is not None and conversion.measure == "plastic"
    if plastic and all(m.strength.id in UNYIELDING for m in data.materials):
        raise values.lacks(
            "conversion by plastic strain",
            f"a material that yields, and none of {_names(data)} does",
            "another measure, or a material with plasticity",
        )


def check_radius(data: SceneData, reach: float) -> None:
    """Refuse a radius of conversion beyond the reference neighbours, who are no further than ``reach`` [m].

    Raises:
        InputError: Names the radius and what is allowed.
    """
    conversion = data.numerics.conversion
    if conversion is not None and conversion.radius is not None and conversion.radius > reach:
        raise values.outside(
            "radius of Conversion",
            conversion.radius,
            f"up to the kernel's support of {reach:g} m, and more layers to go further",
        )


def _has_damage(data: SceneData) -> bool:
    return any(material.damage_id != DamageId.NONE for material in data.materials)


def _names(data: SceneData) -> str:
    return ", ".join(repr(material.name) for material in data.materials)


def _fails(data: SceneData) -> str:
    return f"a material that fails, and none of {_names(data)} has a damage law"


def _misfit(option: str, scheme: str, schemes: str) -> InputError:
    return values.clash(option, f"scheme {scheme!r}", f"the schemes {schemes}")
