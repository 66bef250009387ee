"""What a picture can be coloured by: fields, their components, and quantities derived from them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .fields import BY_NAME, FIELDS
from .messages import values
from .state import State

AXES = ("x", "y", "z")
"""Components of a vector."""

PAIRS = (("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2))
"""Components of a symmetric tensor, with their indices."""

UNBOUNDED = 1e100
"""A deformation gradient from here on is none."""

KERNEL_TYPES = ("Eulerian", "Total Lagrangian", "eroded")
"""Names of the values of the field ``kernel_type``."""


@dataclass(frozen=True)
class Scalar:
    """One number per particle.

    Attributes:
        title: Name for people.
        unit: SI unit.
        values: Shape [n], float64.
        categories: Names of the values 0, 1, ... if they are no amounts, else None.
    """

    title: str
    unit: str
    values: np.ndarray
    categories: tuple[str, ...] | None = None


def scalar(state: State, name: str) -> Scalar:
    """Get a quantity by name.

    Args:
        state: The particles.
        name: Title or symbol of a field (a vector gives its magnitude), a component such as ``velocity_x`` or
            ``stress_xx``, ``speed``, ``von_mises`` or ``equivalent_strain``.

    Raises:
        InputError: If the state does not offer it; names what it does.
    """
    table = _table(state)
    key = BY_NAME[name].title if name in BY_NAME and name not in table else name
    if key not in table:
        raise values.unknown("field", name, table)
    title, unit, numbers = table[key]
    return Scalar(title, unit, np.asarray(numbers(), dtype=np.float64), _categories(state, key))


def names(state: State) -> list[str]:
    """Every quantity that `scalar` can give for a state."""
    return list(_table(state))


def equivalent_strain(F: np.ndarray) -> np.ndarray:
    """Equivalent logarithmic strain sqrt(2/3 eps':eps') with eps = 1/2 ln(F F^T), shape [n].

    Args:
        F: Deformation gradients, shape [n, 3, 3]; a singular one, or one without bounds, gives no finite value.
    """
    F = np.asarray(F, dtype=np.float64)
    bounded = (np.abs(F) < UNBOUNDED).all(axis=(1, 2))  # of others the decomposition fails
    principal = np.full(F.shape[:2], np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        principal[bounded] = np.log(np.linalg.svd(F[bounded], compute_uv=False))
        deviator = principal - principal.mean(axis=1, keepdims=True)
        return np.sqrt(2.0 / 3.0) * np.linalg.norm(deviator, axis=1)


def _table(state: State) -> dict[str, tuple[str, str, Callable[[], np.ndarray]]]:
    """Title, unit and values of every quantity by name."""
    table = {}
    for f in FIELDS:
        if f.name not in state.fields:
            continue
        array, words = state.fields[f.name], f.title.replace("_", " ")
        if f.kind in ("mat", "sym"):
            for pair, i, j in PAIRS:
                table[f"{f.title}_{pair}"] = (f"{words} {pair}", f.unit, lambda a=array, i=i, j=j: a[:, i, j])
        elif f.kind in ("vec", "point"):
            table[f.title] = (f"|{words}|", f.unit, lambda a=array: np.linalg.norm(a, axis=1))
            for k, axis in enumerate(AXES):
                table[f"{f.title}_{axis}"] = (f"{words} {axis}", f.unit, lambda a=array, k=k: a[:, k])
        else:
            table[f.title] = (words, f.unit, lambda a=array: a)
    return _derived(state) | table


def _derived(state: State) -> dict[str, tuple[str, str, Callable[[], np.ndarray]]]:
    """Quantities that no field holds."""
    table, fields = {}, state.fields
    if "v" in fields:
        table["speed"] = ("speed", "m/s", lambda: np.linalg.norm(state.v, axis=1))
    if "tau" in fields:
        table["von_mises"] = (
            "von Mises stress",
            "Pa",
            lambda: np.sqrt(1.5) * np.linalg.norm(state.tau, axis=(1, 2)),
        )
    if "F" in fields:
        table["equivalent_strain"] = ("equivalent strain", "1", lambda: equivalent_strain(state.F))
    if "tau" in fields and "p" in fields:
        for pair, i, j in PAIRS:
            pressure = state.p if i == j else 0.0
            table[f"stress_{pair}"] = (
                f"stress {pair}",
                "Pa",
                lambda i=i, j=j, p=pressure: state.tau[:, i, j] - p,
            )
    return table


def _categories(state: State, name: str) -> tuple[str, ...] | None:
    """Names of the values of an index."""
    if name == "fixed":
        return tuple(
            "".join(axis for k, axis in enumerate(AXES) if bits >> k & 1) or "free" for bits in range(8)
        )
    indices = {
        "body": state.bodies,
        "material": state.materials,
        "kernel_type": KERNEL_TYPES,
    }
    return tuple(indices[name]) if name in indices else None
