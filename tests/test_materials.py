import math

import pytest
import warp as wp

from warpsph import materials as lib
from warpsph.errors import InputError
from warpsph.kernels.material import DamageId, EosId, StrengthId, make_material
from warpsph.kernels.spec import Spec

JC = {"G": 1e9, "A": 1e6, "B": 1e6, "n": 0.5, "C": 0.01, "m": 1.0, "T0": 300.0, "Tm": 900.0, "Cv": 400.0}
JH = lib.get("sic").strength.constants
EOS = lib.StiffenedGas(c0=5328.0, gamma0=2.0)


def subclasses(cls):
    return {s for direct in cls.__subclasses__() for s in {direct, *subclasses(direct)}}


def test_every_law_of_the_device_has_one_dataclass():
    for base, ids in ((lib.Eos, EosId), (lib.Strength, StrengthId)):
        assert sorted(law.id for law in subclasses(base)) == sorted(ids)
    assert {law.id for law in subclasses(lib.Damage)} == {
        DamageId.JOHNSON_COOK
    }  # the ceramic's comes with its strength


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
        (
            lambda: lib.Material("a", 1.0, lib.IdealGas(1.4), lib.Elastic(G=1.0)),
            "does not go with an ideal gas",
        ),
        (lambda: lib.moduli(E=1.0, nu=0.5), "nu = 0.5"),
        (
            lambda: lib.JohnsonCook(**JC | {"n": 0.0}),
            "JohnsonCook: n = 0.0 is out of range; allowed: positive",
        ),
        (lambda: lib.JohnsonCook(**JC | {"Tm": 300.0}), "JohnsonCook: Tm = 300 does not go with T0 = 300"),
        (
            lambda: lib.JohnsonCook(**JC | {"chi": 1.5}),
            "JohnsonCook: chi = 1.5 is out of range; allowed: 0 to 1",
        ),
        (lambda: lib.JohnsonCook(**{k: v for k, v in JC.items() if k != "Cv"}), "JohnsonCook: Cv is missing"),
        (
            lambda: lib.JohnsonCookDamage(D1=-0.1, D2=0.1),
            "D1 = -0.1 does not go with D2 = 0.1; allowed: D1 . D2 above",
        ),
        (lambda: lib.JohnsonCookDamage(D1="x"), "JohnsonCookDamage: D1 = 'x'"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"T": 0.0}), "JohnsonHolmquist1: T = 0.0 .* allowed: negative"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"P1": -1e9}), "P1 = -1e.09 does not go with T = -7.5e.08"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"P2": 1e9}), "P2 = 1e.09 does not go with P1 = 2.5e.09"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"s2": 1e9}), "s2 = 1e.09 does not go with s1 = 7.1e.09"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"P_max": -1.0}), "JohnsonHolmquist1: P_max = -1.0"),
        (lambda: lib.JohnsonHolmquist1(**JH | {"cf": -1.0}), "JohnsonHolmquist1: cf = -1.0"),
        (
            lambda: lib.Material(
                "a", 1.0, EOS, lib.PerfectlyPlastic(G=1.0, Y=1.0), damage=lib.JohnsonCookDamage(D1=1.0)
            ),
            "damage = JohnsonCookDamage does not go with strength = PerfectlyPlastic; allowed: JohnsonCook",
        ),
        (
            lambda: lib.Material("a", 1.0, EOS, lib.JohnsonCook(**JC), damage="JC"),
            "damage = 'JC' is not allowed",
        ),
        (
            lambda: lib.Material(
                "a", 1.0, EOS, lib.get("sic").strength, damage=lib.JohnsonCookDamage(D1=1.0)
            ),
            "does not go with JohnsonHolmquist1; allowed: None",
        ),
        (
            lambda: lib.Material("a", 1.0, EOS, lib.get("sic").strength, pressure_cutoff=-1e9),
            "pressure_cutoff = -1e.09 does not go with JohnsonHolmquist1",
        ),
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
    laws = [law for law in (material.eos, material.strength, material.damage) if law is not None]
    for constant in (name for law in laws for name in law.constants):
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
        assert row["damage"] == material.damage_id
        assert row["rho0"] == pytest.approx(material.density, rel=eps)
        assert row["A_shock"] == pytest.approx(material.eos.shock_slope(material.density), rel=eps)
        gas = isinstance(material.eos, lib.IdealGas)
        assert row["p_min"] == (0.0 if gas else pytest.approx(material.pressure_cutoff, rel=eps))
        ceramic = isinstance(material.strength, lib.JohnsonHolmquist1)
        assert row["D_tension"] == (0.0 if gas else 1.0 if ceramic else math.inf)
        assert row["D_shear"] == math.inf
        assert row["c_min"] > 0.0
        given = material.eos.constants | material.strength.constants
        given |= {} if material.damage is None else material.damage.constants
        given["P_T"] = given.pop("T", 0.0)  # T is a temperature on the device
        own = {"eos", "strength", "damage", "rho0", "p_min", "c_min", "A_shock", "D_tension", "D_shear"}
        for name in set(rows.dtype.names) - own:
            assert row[name] == pytest.approx(given.pop(name, 0.0), rel=eps)
        assert not given


def test_initial_temperature():
    assert lib.get("steel-jc").initial_temperature == 298.0
    assert lib.get("aluminium").initial_temperature == lib.ROOM_TEMPERATURE == 293.15


def test_a_material_does_not_know_the_dimension():
    assert make_material(Spec(1, wp.float64)) is make_material(Spec(3, wp.float64))
    assert make_material(Spec(3, wp.float32)) is not make_material(Spec(3, wp.float64))
