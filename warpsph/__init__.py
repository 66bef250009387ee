"""warpsph: smoothed particle hydrodynamics of solids hitting solids fast, on NVIDIA Warp kernels.

What a scene needs can be taken from here: ``from warpsph import Box, Disc, Numerics, Scene``. A name is looked up when
it is first used, so that ``import warpsph`` loads neither NumPy nor Warp.
"""

import importlib
import importlib.util

__version__ = "0.1.0"

if importlib.util.find_spec("warpsph.kernels") is None:
    raise ImportError("warpsph.kernels is missing: install the source tree first, with `pip install -e .`")

_EXPORTS = {
    "scene": ("Scene", "SceneData", "spin"),
    "config": ("Numerics",),
    "guards": ("Guards",),
    "state": ("State",),
    "shapes": ("Box", "Cone", "Cylinder", "Disc", "HalfSpace", "Mesh", "Ring", "Shape", "Sphere"),
    "lattices": ("Cartesian", "CoreAndRings", "FaceCentredCubic", "Hexagonal", "Lattice", "Rings"),
    "materials": (
        "CubicGrueneisen", "Elastic", "Fluid", "IdealGas", "IsothermalMieGrueneisen", "JohnsonCook",
        "JohnsonCookDamage", "JohnsonHolmquist1", "LinearElastic", "LinearHardening", "Material", "PerfectlyPlastic",
        "Polynomial", "ShockMieGrueneisen", "StiffenedGas", "moduli",
    ),
    "errors": ("DiskError", "Ended", "InputError", "RunError"),
}  # fmt: skip
"""Public names by the module that defines them."""

_MODULES = ("cli", "fields", "lattices", "materials", "run", "scene", "shapes", "solver", "storage")
"""Modules that a user may want as a whole, for example ``warpsph.run.run(scene, "out")``."""

_HOME = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = ["__version__", *_MODULES, *_HOME]  # noqa: PLE0604


def __getattr__(name: str):
    if name in _HOME:
        return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    if name in _MODULES:
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
