import math

import numpy as np
import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.errors import InputError
from warpsph.kernels.material import EosId, StrengthId, make_material
from warpsph.kernels.spec import Spec

EOS = lib.StiffenedGas(c0=5328.0, gamma0=2.0)


def subclasses(cls):
    return {s for direct in cls.__subclasses__() for s in {direct, *subclasses(direct)}}


def test_every_law_of_the_device_has_one_dataclass():
    for base, ids in ((lib.Eos, EosId), (lib.Strength, StrengthId)):
        assert sorted(law.id for law in subclasses(base)) == sorted(ids)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: lib.StiffenedGas(c0=5328.0), "StiffenedGas: gamma0 is missing; allowed: 1 or more"),
        (lambda: lib.LinearElastic(K=-1.0), "LinearElastic: K = -1.0 is out of range; allowed: positive"),
        (lambda: lib.LinearElastic(K="1e9"), "LinearElastic: K = '1e9'"),
        (lambda: lib.LinearElastic(K=math.inf), "LinearElastic: K = inf"),
        (lambda: lib.IdealGas(gamma=1.0), "IdealGas: gamma = 1.0 is out of range; allowed: more than 1"),
        (lambda: lib.LinearHardening(G=1e9, Y=1e6, H=-1.0), "LinearHardening: H = -1.0"),
        (lambda: lib.Material("a", -2.0, EOS, lib.Fluid()), "material 'a': density = -2.0"),
        (lambda: lib.Material("a", math.nan, EOS, lib.Fluid()), "material 'a': density = nan"),
        (lambda: lib.Material("a", 1.0, EOS, lib.Fluid(), pressure_cutoff=1e6), "allowed: zero or negative"),
        (lambda: lib.Material("a", 1.0, lib.Fluid(), EOS), "eos = Fluid.* allowed: LinearElastic, "),
        (lambda: lib.Material("", 1.0, EOS, lib.Fluid()), "name = ''"),
        (lambda: lib.Material("a", 1.0, lib.IdealGas(1.4), lib.Elastic(G=1.0)), "does not fit an ideal gas"),
        (lambda: lib.moduli(E=1.0, nu=0.5), "nu = 0.5"),
    ],
)
def test_a_bad_constant_is_one_clear_line(make, message):
    with pytest.raises(InputError, match=message) as error:
        make()
    assert "\n" not in str(error.value)


def test_hardening_modulus_from_the_tangent_modulus():
    _, G = lib.moduli(E=200e9, nu=0.3)
    law = lib.LinearHardening.from_tangent_modulus(G=G, Y=315e6, E=200e9, Ep=16.2e9)
    assert law.H == pytest.approx(17.628e9, rel=1e-4)
    for bad in ({"Ep": 200e9}, {"Ep": -1.0}, {"E": 300e9}):
        with pytest.raises(InputError, match=next(iter(bad))):
            lib.LinearHardening.from_tangent_modulus(**{"G": G, "Y": 315e6, "E": 200e9, "Ep": 16.2e9} | bad)


def test_moduli_of_the_papers():
    K, G = lib.moduli(E=200e9, nu=0.30)
    assert (K, G) == (pytest.approx(166.667e9, rel=1e-5), pytest.approx(76.923e9, rel=1e-5))


@pytest.mark.parametrize("name", lib.names())
def test_library_entry(name):
    material = lib.get(name)
    text = material.describe()
    assert material.source and material.name == name
    for constant in (*material.eos.constants, *material.strength.constants):
        assert f"\n  {constant} " in text
    assert material.longitudinal_speed >= material.bulk_speed


def test_wave_speeds_of_the_impact_aluminium():
    aluminium = lib.get("aluminium")
    assert aluminium.bulk_speed == 5328.0
    assert aluminium.shear_modulus == 27.6e9
    assert aluminium.longitudinal_speed == pytest.approx(math.sqrt(5328.0**2 + 4 * 27.6e9 / (3 * 2785.0)))


def test_unknown_name_lists_the_library_and_suggests():
    with pytest.raises(InputError, match="did you mean 'aluminium'") as error:
        lib.get("aluminum")
    assert all(name in str(error.value) for name in lib.names())


def test_packing_keeps_every_constant(precision, eps):
    table = [lib.get(name) for name in lib.names()]
    rows = lib.pack(table, precision, "cpu").numpy()
    for row, material in zip(rows, table, strict=True):
        assert (row["eos"], row["strength"]) == (material.eos.id, material.strength.id)
        assert row["rho0"] == pytest.approx(material.density, rel=eps)
        assert row["p_min"] == -np.inf and row["c_min"] > 0.0
        given = material.eos.constants | material.strength.constants
        for name in set(rows.dtype.names) - {"eos", "strength", "rho0", "p_min", "c_min"}:
            assert row[name] == pytest.approx(given.get(name, 0.0), rel=eps)


def test_a_material_does_not_know_the_dimension():
    assert make_material(Spec(1, wp.float64)) is make_material(Spec(3, wp.float64))
    assert make_material(Spec(3, wp.float32)) is not make_material(Spec(3, wp.float64))
