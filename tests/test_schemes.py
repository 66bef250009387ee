"""From a scene to its scheme: every name makes one, and what a scheme has no equations for is refused."""

import pytest
from tools import DOUBLE, ELASTIC, FLUID, SPACING, scene

from warpsph.config import LIMITERS, RIEMANN_SOLVERS, Numerics
from warpsph.errors import InputError
from warpsph.kernels.limiters import LIMITERS as DEVICE_LIMITERS
from warpsph.kernels.riemann import SOLVERS
from warpsph.schemes import SCHEMES, EulerianSettings, GodunovSettings
from warpsph.schemes.factory import make_family, make_scheme
from warpsph.shapes import Box

GODUNOV = [name for name, settings in SCHEMES.items() if isinstance(settings, GodunovSettings)]


def bar(dim=1, material=ELASTIC, energy=0.0, **numerics):
    """A few particles of a material."""
    made = scene(dim, **numerics)
    made.add_body("bar", Box([0.0] * dim, [4 * SPACING] * dim), material, internal_energy=energy)
    return made.finalize()


@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("planes", [False, True])
def test_every_name_makes_a_scheme(name, planes):
    made = make_family(DOUBLE[2], Numerics(scheme=name), planes, False)
    assert made.support == 2.0
    assert made.gradient_ratio == SCHEMES[name].gradient_ratio


def test_con_is_another_name_of_pm():
    assert SCHEMES["con"] == SCHEMES["pm"]
    assert SCHEMES["av"] == EulerianSettings("monaghan", 1.0, 1.0)


def test_the_names_of_the_settings_are_those_of_the_kernels():
    assert set(LIMITERS) == set(DEVICE_LIMITERS) and set(RIEMANN_SOLVERS) == set(SOLVERS)


@pytest.mark.parametrize("name", GODUNOV)
def test_plane_stress_is_refused(name):
    with pytest.raises(InputError, match=rf"plane = 'stress' .*scheme '{name}'.*allowed: 'strain'"):
        make_scheme(bar(2, scheme=name, plane="stress"), DOUBLE[2])
    for dim, plane in ((1, "stress"), (2, "strain")):  # the setting matters in 2D only
        make_scheme(bar(dim, scheme=name, plane=plane), DOUBLE[dim])
    make_scheme(bar(2, scheme="av", plane="stress"), DOUBLE[2])


def test_a_cold_gas_is_refused_by_the_acoustic_solver():
    cold = {"material": "air"}
    with pytest.raises(InputError, match=r"material 'air' .*riemann = 'acoustic'.*4 particles.*'two-shock'"):
        make_scheme(bar(scheme="ts1", riemann="acoustic", **cold), DOUBLE[1])
    make_scheme(bar(scheme="ts1", riemann="two-shock", **cold), DOUBLE[1])
    make_scheme(bar(scheme="ts1", riemann="acoustic", material="air", energy=1e3), DOUBLE[1])
    make_scheme(bar(scheme="ts1", riemann="acoustic", material=FLUID), DOUBLE[1])
    make_scheme(bar(scheme="sav1", **cold), DOUBLE[1])


@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("riemann", "hllc", "acoustic, two-shock"),
        ("limiter", "koren", "superbee, minmod, sweby, mc, vanleer"),
        ("limiter_beta", 0.9, "1.0 to 2.0"),
        ("limiter_beta", 2.1, "1.0 to 2.0"),
        ("limiter_beta", float("nan"), "1.0 to 2.0"),
        ("scheme", "ts3", "ts2"),
    ],
)
def test_settings_out_of_range_are_refused(field, value, allowed):
    with pytest.raises(InputError) as caught:
        Numerics(**{field: value})
    message = str(caught.value)
    assert field in message and repr(value) in message and allowed in message
