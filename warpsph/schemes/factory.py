"""From a scene to its scheme: the family's class, and what a scheme asks of a scene."""

import math

import numpy as np

from warpsph.config import Numerics
from warpsph.kernels.spec import Spec
from warpsph.messages import values
from warpsph.scene import SceneData

from . import SCHEMES, EulerianSettings, GodunovSettings, LagrangianSettings
from .adaptive import Adaptive
from .checks import check_contact, check_eulerian, check_lagrangian, check_radius
from .eulerian import Eulerian
from .godunov import ParshikovMedin, TimeSplit
from .lagrangian import TotalLagrangian
from .scheme import Scheme, Traits


def make_scheme(data: SceneData, spec: Spec) -> Scheme:
    """Build the scheme that a scene names.

    Raises:
        InputError: If the scheme cannot serve the scene; says what is missing.
    """
    settings = SCHEMES[data.numerics.scheme]
    if isinstance(settings, GodunovSettings):
        _check_godunov(data)
    check_contact(data)
    if isinstance(settings, LagrangianSettings):
        check_lagrangian(data, settings)
    else:
        check_eulerian(data)
    fragile = any(material.tension_lost < math.inf for material in data.materials)
    scheme = make_family(
        spec, data.numerics, bool(data.planes), fragile, len(data.bodies) == 1, bool(np.any(data.fixed))
    )
    check_radius(data, scheme.support * data.h)
    return scheme


def make_family(
    spec: Spec,
    numerics: Numerics,
    planes: bool,
    fragile: bool,
    alone: bool = False,
    constrained: bool = False,
) -> Scheme:
    """Build the scheme of some numerical settings.

    Args:
        spec: Specialisation.
        numerics: Numerical settings.
        planes: There are symmetry planes.
        fragile: Some material bears no tension, or none once it has failed.
        alone: There is one body.
        constrained: Some particle is fixed or driven.
    """
    settings, traits = SCHEMES[numerics.scheme], Traits(planes, fragile, alone, constrained)
    if isinstance(settings, EulerianSettings):
        return Eulerian(settings, spec, numerics, traits)
    if isinstance(settings, LagrangianSettings):
        if settings.eulerian is None and (alone or numerics.contact is not None):
            return TotalLagrangian(settings, spec, numerics, traits)
        return Adaptive(settings, spec, numerics, traits)
    family = TimeSplit if settings.split else ParshikovMedin
    return family(settings, spec, numerics, traits)


def _check_godunov(data: SceneData) -> None:
    """Refuse what the Godunov schemes have no equations for."""
    name, numerics = data.numerics.scheme, data.numerics
    if numerics.plane == "stress" and data.dim == 2:
        raise values.clash(
            "plane = 'stress'", f"scheme {name!r}", "'strain', or a scheme with artificial viscosity",
            "its Riemann problems know no thickness that changes",
        )  # fmt: skip
    for option in ("contact", "viscosity_alpha", "viscosity_beta"):
        if getattr(numerics, option) is not None:
            raise values.clash(
                option, f"scheme {name!r}, a Godunov scheme", "None, or a scheme with artificial viscosity"
            )
    if numerics.riemann == "acoustic":
        for k, material in enumerate(data.materials):
            cold = (data.mat == k) & (data.e <= 0.0)
            if material.bulk_speed == 0.0 and np.any(cold):
                raise values.clash(
                    f"material {material.name!r}", f"riemann = 'acoustic' in scheme {name!r}",
                    "riemann = 'two-shock', or an internal energy above 0",
                    f"{np.count_nonzero(cold)} particles of it start without internal energy, so they have no sound "
                    "speed and no impedance",
                )  # fmt: skip
