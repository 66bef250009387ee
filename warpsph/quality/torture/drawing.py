"""What scenes are drawn from: strategies of Hypothesis, within a set of kernels that many scenes share.

Compiling takes longer than a small scene runs. So what is compiled in is chosen first, a `KernelSet`, and many scenes
are drawn that need no other kernels.
"""

import random
from dataclasses import dataclass

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from warpsph import materials
from warpsph.config import KERNELS, LIMITERS, RIEMANN_SOLVERS, STRAIN_MEASURES
from warpsph.lattices import LATTICES
from warpsph.schemes import SCHEMES, GodunovSettings, LagrangianSettings

from .drawn import DrawnBody, DrawnMaterial, DrawnScene

FASTEST = 20e3
"""Highest speed [m/s]."""

LARGEST = {1: 100.0, 2: 13.0, 3: 6.0}
"""Largest extent of a body by dimension, in spacings."""

SOLIDS = ("elastic", "dense", "loose", "glass", *(name for name in materials.names() if name != "air"))
"""Materials with strength."""

FLUIDS = ("water", "spray", "molten", "gas", "air")
"""Materials without."""

FAILING = ("aluminium-jc", "sic")
"""Materials with a damage law."""

FACTORS = (0.5, 0.7, 0.9, 1.1, 1.5, 2.0, 0.1, 10.0, 0.0)
"""What constants of laws are changed by."""

STRAYS = (
    ("cfl", 0.0), ("cfl", 1.5), ("smoothing_ratio", 0.5), ("skin", -0.1), ("limiter", "none"), ("erosion", True),
    ("hourglass", 11.0), ("viscosity_alpha", -1.0), ("inverted", "convert"), ("scheme", "sph"), ("limiter_beta", 3.0),
)  # fmt: skip
"""Options that are wrong, or wrong for most schemes."""


@dataclass(frozen=True)
class KernelSet:
    """What is compiled in, for many scenes.

    Attributes:
        scheme: Name of the scheme.
        dim: Space dimension.
        precision: Precision.
        options: Arguments of `warpsph.config.Numerics` that are compiled in.
        contact: There is contact between bodies.
        conversion: Arguments of `warpsph.config.Conversion` that are compiled in; none: no conversion.
        planes: There are symmetry planes.
        constrained: Some particles are fixed or driven.
        alone: There is one body.
    """

    scheme: str
    dim: int
    precision: str = "float64"
    options: tuple[tuple[str, object], ...] = ()
    contact: bool = False
    conversion: tuple[tuple[str, object], ...] = ()
    planes: bool = False
    constrained: bool = False
    alone: bool = False


COMMON = (
    KernelSet("sav1", 2),
    KernelSet("ts2", 2),
    KernelSet("adaptle", 2, conversion=(("measure", "logarithmic"),)),
)
"""Sets of kernels that other tests need as well."""


def kernel_set(scheme: str, seed: int) -> KernelSet:
    """Choose a set of kernels for a scheme by chance, the same one for the same seed."""
    chance, settings = random.Random(seed), SCHEMES[scheme]
    dim = chance.choice((1, 2, 2, 3))
    precision = chance.choice(("float64", "float64", "float32", "mixed"))
    options: dict[str, object] = {"kernel": chance.choice(KERNELS)}
    godunov, lagrangian = isinstance(settings, GodunovSettings), isinstance(settings, LagrangianSettings)
    coupled = lagrangian and settings.eulerian is not None
    if godunov:
        options["riemann"] = chance.choice(RIEMANN_SOLVERS)
    if godunov and settings.order == 2:
        options |= {"limiter": chance.choice(LIMITERS), "limit_jump": chance.random() < 0.3}
    if dim == 2 and not godunov and chance.random() < 0.3:
        options["plane"] = "stress"
    contact = not godunov and chance.random() < 0.4
    conversion: dict[str, object] = {}
    if lagrangian:
        options["hourglass"] = chance.choice((0.0, 0.0, 0.1, 10.0))
    if lagrangian and not coupled and chance.random() < 0.4:
        options["erosion"] = True
    if coupled:
        options["coupling"] = chance.choice(("conservative", "conservative", "printed"))
        options["interface_stress"] = chance.choice(("both", "none", "eulerian"))
        conversion["damage"] = chance.random() < 0.4
        if not conversion["damage"] or chance.random() < 0.7:
            conversion["measure"] = chance.choice(STRAIN_MEASURES)
    return KernelSet(
        scheme, dim, precision, tuple(options.items()), contact, tuple(conversion.items()),
        planes=chance.random() < 0.25, constrained=chance.random() < 0.3, alone=lagrangian and chance.random() < 0.3,
    )  # fmt: skip


WILD = (
    "fast", "fast", "fast", "inviscid", "stiff", "dense", "hot", "coarse steps", "narrow", "spinning", "changed", "changed",
    "near", "far", "wrong",
)  # fmt: skip
"""What a scene may have that no one would ask for lightly; a scene has two of these at most."""


def speeds(wild: frozenset[str]) -> st.SearchStrategy[float]:
    """Speeds [m/s]: rest, ordinary impacts, and where they may be fast up to `FASTEST`."""
    if "fast" in wild:
        return st.one_of(st.floats(2e3, FASTEST), st.just(FASTEST))
    return st.one_of(st.just(0.0), st.floats(1.0, 2e3))


@st.composite
def drawn_materials(draw: st.DrawFn, names: tuple[str, ...], wild: frozenset[str]) -> DrawnMaterial:
    """A material, with constants changed where that may be."""
    base = draw(st.sampled_from(names))
    if "changed" not in wild:
        return DrawnMaterial(base)
    letters = draw(
        st.lists(st.sampled_from(sorted(DrawnMaterial(base).constants())), max_size=3, unique=True)
    )
    factors = tuple((letter, draw(st.sampled_from(FACTORS))) for letter in letters)
    cutoff = draw(st.sampled_from((None, None, 0.0, -1e6, -1e9))) if base != "sic" else None  # it has its own
    return DrawnMaterial(base, factors, cutoff, draw(st.sampled_from((None, "all", "compression"))))


@st.composite
def drawn_bodies(
    draw: st.DrawFn,
    kernels: KernelSet,
    wild: frozenset[str],
    side: float,
    gap: float,
    before: DrawnBody | None,
) -> DrawnBody:
    """A body beside the one before, on the side of higher (1) or lower (-1) coordinates, most often on its way there."""
    dim, sampled = kernels.dim, st.sampled_from
    kind = draw(sampled(("box", "box", "ball", "ring", "points", "particle")))
    extent = st.floats(4.0 if kind == "ring" else 1.0, LARGEST[dim])
    size = (draw(extent), draw(extent), draw(extent))
    axis = draw(st.integers(0, dim - 1))
    center = [0.0, 0.0, 0.0]
    if before is not None:
        center = [a + draw(sampled((0.0, 0.0, 0.5, 3.0))) * (k < dim) for k, a in enumerate(before.center)]
        center[axis] = before.center[axis] + side * (
            gap + 0.5 * (_extent(before.kind, before.size, axis) + _extent(kind, size, axis))
        )
    coupled = kernels.scheme.startswith("adaptle")
    eulerian = draw(sampled((False, False, True, "all"))) if coupled else False
    solid = (
        (coupled and eulerian != "all")
        or kernels.scheme.startswith("tl")
        or dict(kernels.options).get("plane") == "stress"
    )
    names = SOLIDS if solid and ("wrong" not in wild or draw(st.booleans())) else (*SOLIDS, *FLUIDS)
    failing = dict(kernels.options).get("erosion") or dict(kernels.conversion).get("damage")
    if failing and before is None and "wrong" not in wild:
        names = FAILING
    material = draw(drawn_materials(names, wild))
    speed, aside = draw(speeds(wild)), draw(sampled((0.0, 0.0, 0.3, 1.0, -1.0)))
    velocity = [0.0, 0.0, 0.0]
    velocity[axis] = -side * speed * draw(sampled((1.0, 1.0, 1.0, 0.0, -1.0)))
    velocity[(axis + 1) % dim] += aside * speed
    energies = (1e5, 1e6, 2e5) if material.base in ("gas", "air") else (0.0, 0.0, 0.0, 1e5, -1e5)
    if "hot" in wild:
        energies = (1e7, 1e6, 0.0, 1e3) if material.base in ("gas", "air") else (1e7, 3e6, -1e6)
    lattices = (None, None, *(name for name, lattice in LATTICES.items() if dim in lattice.dims))
    return DrawnBody(
        kind=kind,
        size=size,
        center=tuple(center),
        material=material,
        inlay=draw(drawn_materials(names, wild)) if draw(st.integers(0, 9)) == 9 else None,
        lattice=draw(sampled(lattices)) if kind not in ("points", "particle") else None,
        angle=draw(sampled((0.0, 0.0, 45.0, 30.0))),
        noise=draw(sampled((0.0, 0.1, 0.2))) if kind == "points" else 0.0,
        velocity=tuple(velocity),
        spin=draw(speeds(wild)) if dim > 1 and "spinning" in wild else 0.0,
        swelling=draw(speeds(wild)) * draw(sampled((1.0, -1.0))) if "spinning" in wild else 0.0,
        density=draw(sampled((0.5, 0.8, 1.3, 2.0) if "dense" in wild else (1.0, 1.0, 1.0, 0.98, 1.02))),
        energy=draw(sampled(energies)),
        fixed=draw(sampled(("", "x", "xyz", "xyz"[:dim]))) if kernels.constrained else "",
        fixed_all=draw(st.booleans()) if kernels.constrained else False,
        eulerian=eulerian,
    )


@st.composite
def drawn_scenes(draw: st.DrawFn, kernels: KernelSet) -> DrawnScene:
    """A scene that a set of kernels serves, or one that is to be refused."""
    dim, sampled = kernels.dim, st.sampled_from
    wild = frozenset(draw(st.lists(sampled(WILD), max_size=2)))
    gaps = (0.5, 0.7, -1.0) if "near" in wild else (1.2, 2.0, 2.5, 3.0, 5.0, 10.0)
    side, bodies = draw(sampled((1.0, -1.0))), []
    for _ in range(1 if kernels.alone else draw(sampled((1, 2, 2, 2, 3, 4)))):
        before = bodies[-1] if bodies else None
        bodies.append(draw(drawn_bodies(kernels, wild, side, draw(sampled(gaps)), before)))
    return DrawnScene(
        dim=dim,
        precision=kernels.precision,
        spacing=draw(sampled((1e-3, 1e-3, 1e-5, 0.1))),
        bodies=tuple(bodies),
        numerics=(("scheme", kernels.scheme), *draw(_numerics(kernels, wild))),
        contact=draw(_contact("stiff" in wild)) if kernels.contact else (),
        conversion=draw(_conversion(kernels)) if kernels.conversion else (),
        planes=draw(_planes(dim, "near" in wild)) if kernels.planes else (),
        origin=tuple(draw(sampled((1e3, -1e4) if "far" in wild else (0.0,))) for _ in range(3)),
        wild=tuple(sorted(wild)),
    )


def _extent(kind: str, size: tuple[float, ...], axis: int) -> float:
    """Extent of a body along an axis."""
    if kind == "particle":
        return 1.0
    return size[axis] if kind in ("box", "points") else size[0]


@st.composite
def _numerics(draw: st.DrawFn, kernels: KernelSet, wild: frozenset[str]) -> tuple:
    """Options that nothing is compiled for, those that are, and where it may be one that is wrong."""
    sampled, settings = st.sampled_from, SCHEMES[kernels.scheme]
    wide = (2.0, 3.0) if kernels.dim < 3 else (1.6,)
    free = {
        "smoothing_ratio": sampled((0.8, 0.9, *wide) if "narrow" in wild else (1.2, 1.4, 1.0)),
        "cfl": sampled((0.8, 1.0) if "coarse steps" in wild else (0.5, 0.3, 0.1)),
        "skin": sampled((0.4, 0.1, 0.0, 2.0)),
    }
    if isinstance(settings, GodunovSettings):
        free["limiter_beta"] = sampled((1.5, 1.0, 2.0))
    else:
        free["viscosity_alpha"] = sampled((0.0, 0.1) if "inviscid" in wild else (None, None, 0.5, 5.0))
        free["viscosity_beta"] = sampled((0.0, None) if "inviscid" in wild else (None, None, 4.0))
    if isinstance(settings, LagrangianSettings) and settings.eulerian is not None:
        free["inverted"] = sampled(("stop", "convert", "convert"))
    options = {name: draw(values) for name, values in free.items()} | dict(kernels.options)
    if "wrong" in wild:
        name, value = draw(sampled(STRAYS))
        options[name] = value
    return tuple(options.items())


@st.composite
def _contact(draw: st.DrawFn, stiff: bool) -> tuple:
    if draw(st.integers(0, 4)) > 2:
        return (("modulus", draw(st.sampled_from((1e18, 1e22) if stiff else (1e10, 1e14)))),)
    return (("stiffness", draw(st.sampled_from((2.0, 10.0) if stiff else (0.25, 0.25, 0.1, 1.0)))),)


@st.composite
def _conversion(draw: st.DrawFn, kernels: KernelSet) -> tuple:
    options = dict(kernels.conversion)
    if "measure" in options:
        options["strain"] = draw(st.sampled_from((0.5, 0.1, 0.01, 1.0)))
    options["layers"] = draw(st.sampled_from((1, 0, 2, 5)))
    if draw(st.integers(0, 9)) == 9:
        options["radius"] = draw(st.sampled_from((1e-4, 1e-3, 1.0)))
    return tuple(options.items())


@st.composite
def _planes(draw: st.DrawFn, dim: int, near: bool) -> tuple:
    axes = draw(st.lists(st.sampled_from("xyz"[:dim]), min_size=1, max_size=dim, unique=True))
    distance = st.sampled_from((0.25, 0.1, -2.0) if near else (0.5, 0.5, 0.5, 1.0, 3.0))
    return tuple((axis, draw(st.sampled_from((-1, 1))), draw(distance)) for axis in axes)


def drawn(kernels: KernelSet, number: int) -> DrawnScene:
    """The scene of a number: the first one of a seed that is no simplest one."""
    found: list[DrawnScene] = []

    @seed(number)
    @settings(
        database=None, max_examples=2, phases=[Phase.generate], deadline=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(drawn_scenes(kernels))
    def collect(scene: DrawnScene) -> None:
        found.append(scene)

    collect()
    return found[-1]
