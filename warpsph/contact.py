"""Stiffness of contact between bodies, as its kernel reads it (method section 6)."""

from .scene import SceneData


def contact_constants(data: SceneData) -> tuple[list[float], float]:
    """Give the moduli of the materials and the scale by which the smaller one of a pair becomes Kc [Pa/m^dim].

    Without contact all are 0.

    Returns:
        Modulus of each material, and the scale: bulk moduli [Pa] and k/dx^dim; or Kc and 1 where it is given itself.
    """
    contact, count = data.numerics.contact, len(data.materials)
    if contact is None:
        return [0.0] * count, 0.0
    if contact.modulus is not None:
        return [contact.modulus] * count, 1.0
    bulk = [material.density * material.bulk_speed**2 for material in data.materials]
    return bulk, contact.stiffness / data.spacing**data.dim
