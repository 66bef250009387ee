"""From a scene to its scheme: the family's class, and what a scheme asks of a scene."""

import math

import numpy as np

from warpsph.config import Numerics
from warpsph.errors import InputError
from warpsph.kernels.spec import Spec
from warpsph.scene import SceneData

from . import SCHEMES, EulerianSettings, GodunovSettings
from .eulerian import Eulerian
from .godunov import ParshikovMedin, TimeSplit
from .scheme import Scheme


def make_scheme(data: SceneData, spec: Spec) -> Scheme:
    """Build the scheme that a scene names.

    Raises:
        InputError: If the scheme cannot serve the scene; says what is missing.
    """
    if isinstance(SCHEMES[data.numerics.scheme], GodunovSettings):
        _check_godunov(data)
    fragile = any(material.tension_lost < math.inf for material in data.materials)
    return make_family(spec, data.numerics, bool(data.planes), fragile)


def make_family(spec: Spec, numerics: Numerics, planes: bool, fragile: bool) -> Scheme:
    """Build the scheme of some numerical settings.

    Args:
        spec: Specialisation.
        numerics: Numerical settings.
        planes: There are symmetry planes.
        fragile: Some material bears no tension, or none once it has failed.
    """
    settings = SCHEMES[numerics.scheme]
    if isinstance(settings, EulerianSettings):
        return Eulerian(settings, spec, numerics, planes)
    family = TimeSplit if settings.split else ParshikovMedin
    return family(settings, spec, numerics, planes, fragile)


def _check_godunov(data: SceneData) -> None:
    """Refuse what the Godunov schemes have no equations for."""
    name, numerics = data.numerics.scheme, data.numerics
    if numerics.plane == "stress" and data.dim == 2:
        raise InputError(
            f"plane = 'stress' does not go with scheme {name!r}: its Riemann problems know no thickness that changes; "
            "allowed: 'strain', or a scheme with artificial viscosity"
        )
    if numerics.riemann == "acoustic":
        for k, material in enumerate(data.materials):
            cold = (data.mat == k) & (data.e <= 0.0)
            if material.bulk_speed == 0.0 and np.any(cold):
                raise InputError(
                    f"material {material.name!r} does not go with riemann = 'acoustic' in scheme {name!r}: "
                    f"{np.count_nonzero(cold)} particles of it start without internal energy, so they have no sound "
                    "speed and no impedance; allowed: riemann = 'two-shock', or an internal energy above 0"
                )
