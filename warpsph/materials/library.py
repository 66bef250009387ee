"""The library: the materials that the papers use."""

import functools

from warpsph.messages import values

from .damage import JohnsonCookDamage
from .eos import (
    CubicGrueneisen,
    IdealGas,
    IsothermalMieGrueneisen,
    LinearElastic,
    Polynomial,
    ShockMieGrueneisen,
    StiffenedGas,
)
from .material import Material
from .strength import (
    Elastic,
    Fluid,
    JohnsonCook,
    JohnsonHolmquist1,
    LinearHardening,
    PerfectlyPlastic,
    moduli,
)


@functools.cache
def _library() -> dict[str, Material]:
    young = "Young et al., adaptive Total Lagrangian-Eulerian SPH (AdapTLE)"
    connolly = "Connolly et al. 2013, Second order Godunov SPH for high velocity impact dynamics"
    steel_K, steel_G = moduli(E=200e9, nu=0.30)
    patch_K, patch_G = moduli(E=1.0, nu=0.3)
    _, plate_G = moduli(E=70e9, nu=0.33)
    flyer = PerfectlyPlastic(G=48.1e9, Y=2.5e9)
    beryllium = ShockMieGrueneisen(c0=12870.0, S1=1.124, Gamma0=2.0)
    entries = (
        Material(
            "aluminium", 2785.0, StiffenedGas(c0=5328.0, gamma0=2.0), PerfectlyPlastic(G=27.6e9, Y=0.3e9),
            source=f"{young}, section 3.2",
        ),
        Material(
            "steel", 7870.0, LinearElastic(K=steel_K), LinearHardening(G=steel_G, Y=315e6, H=16.2e9),
            source=f"{young}, section 3.3: E 200 GPa, nu 0.30, its plastic modulus read as dY/dεp",
        ),
        Material(
            "steel-tangent", 7870.0, LinearElastic(K=steel_K),
            LinearHardening.from_tangent_modulus(G=steel_G, Y=315e6, E=200e9, Ep=16.2e9),
            source=f"{young}, section 3.3: E 200 GPa, nu 0.30, its plastic modulus read as the tangent modulus",
        ),
        Material(
            "patch", 1.0, LinearElastic(K=patch_K), Elastic(G=patch_G),
            source=f"{young}, section 3.1: E 1 Pa, nu 0.3",
        ),
        Material(
            "flyer", 6100.0, IsothermalMieGrueneisen(c0=5077.0, S1=1.201), flyer,
            source=f"{connolly}, section 4.1",
        ),
        Material(
            "flyer-full", 6100.0, ShockMieGrueneisen(c0=5077.0, S1=1.201, Gamma0=0.0), flyer,
            source=f"{connolly}, section 4.1, with the shock form of Eq. 37 in place of the printed Eq. 36",
        ),
        Material(
            "beryllium", 1845.0, beryllium, PerfectlyPlastic(G=151e9, Y=330e6),
            source=f"{connolly}, section 4.2, with the shear modulus of the literature (printed: 15.1 GPa)",
        ),
        Material(
            "beryllium-printed", 1845.0, beryllium, PerfectlyPlastic(G=15.1e9, Y=330e6),
            source=f"{connolly}, section 4.2, shear modulus as printed (a tenth of the literature's)",
        ),
        Material(
            "aluminium-jc", 2870.0,
            CubicGrueneisen(c0=5328.0, S1=1.338, S2=0.0, S3=0.0, Gamma0=2.0, a=0.480),
            JohnsonCook(
                G=plate_G, A=479e6, B=323e6, n=0.410, C=0.101, m=1.80, rate0=1.0, T0=300.0, Tm=850.0, Cv=875.0
            ),
            pressure_cutoff=-800e6, damage=JohnsonCookDamage(D1=0.45, D2=0.0, D3=0.0, D4=0.0138, D5=0.0),
            source=f"{young}, section 3.3: E 70 GPa, nu 0.33; C as printed (0.01 is usual); χ 0.9 (not given)",
        ),
        Material(
            "steel-jc", 7903.0, ShockMieGrueneisen(c0=4552.0, S1=1.4933, Gamma0=2.2),
            JohnsonCook(
                G=74.8e9, A=300e6, B=1000e6, n=0.65, C=0.07, m=1.0, T0=298.0, Tm=1673.0, Cv=440.0, chi=0.9
            ),
            source=f"{connolly}, section 5: the projectile",
        ),
        Material(
            "sic", 3215.0, Polynomial(k1=220e9, k2=361e9, k3=0.0),
            JohnsonHolmquist1(
                G=193e9, T=-0.75e9, P1=2.5e9, s1=7.1e9, P2=10e9, s2=12.2e9, cf=0.4, sf_max=1.3e9,
                eps_f_max=0.8, P_max=99.75e9, C=0.009,
            ),
            source=f"{connolly}, section 5: silicon carbide",
        ),
        Material(
            "copper", 8960.0, ShockMieGrueneisen(c0=3940.0, S1=1.489, Gamma0=2.02),
            JohnsonCook(
                G=46e9, A=90e6, B=292e6, n=0.31, C=0.025, m=1.09, T0=298.0, Tm=1356.0, Cv=383.0, chi=0.9
            ),
            source="Johnson & Cook 1983, oxygen-free high-conductivity copper; Us = 3940 m/s + 1.489 u",
        ),
        Material(
            "air", 1.225, IdealGas(gamma=1.4), Fluid(),
            source="ISO 2533 standard atmosphere at sea level; diatomic ideal gas",
        ),
    )  # fmt: skip
    return {material.name: material for material in entries}


def names() -> tuple[str, ...]:
    """Names of the library's materials."""
    return tuple(_library())


def get(name: str) -> Material:
    """Look a material of the library up.

    Raises:
        InputError: If there is none of that name; suggests the closest and lists all.
    """
    library = _library()
    if name in library:
        return library[name]
    raise values.unknown("material", name, library)
