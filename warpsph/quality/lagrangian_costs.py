"""What Total Lagrangian and coupled steps cost beside Eulerian ones of the same scene, and beside other codes."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import median

from warpsph import library
from warpsph.kernels.kernel_type import EULERIAN
from warpsph.messages import measuring
from warpsph.scene import Scene, SceneData
from warpsph.solver import Solver

from .peer import Peer
from .series import HEADER as SERIES_HEADER
from .series import Series, Variant, first_steps, next_steps

SCHEMES = ("sav1", "sav1-mixed", "tl-plain", "tl", "adaptle-plain", "adaptle")
"""Schemes of the plate, each without and with correction; the first is what the others are compared with."""

SPACING = 1e-3
"""Particle spacing of the plate [m], the paper's."""

LATER = 25e-6
"""A time in the middle of the perforation [s]: the coupled schemes have Eulerian particles then."""

SMOOTHING_RATIO = 1.25
"""h over the spacing beside other codes: the support of the scripts for LAMMPS."""

HEADER = (
    "scheme", "window", "threads", "ns per particle-step: median", "min", "max", "times faster than sav1",
    "Eulerian", "with rows", "steps per rebuild",
)  # fmt: skip
"""Columns of the first table."""

Tables = list[tuple[str, Sequence[str], list[list[str]]]]
"""Title, header and rows of each table."""


def lagrangian_costs(
    variants: list[Variant], peers: list[Peer], repeats: int, say: Callable[[str], None]
) -> Tables:
    """Measure the plate of debris_3d with every scheme, and what other codes measure too.

    Args:
        variants: Ways to compute it; those in double precision are taken.
        peers: Other codes; ``case`` of their facts is ``plate`` or ``taylor``.
        repeats: Repetitions; of the later window there is one, of the last variant.
        say: Where progress goes.

    Raises:
        InputError: A peer does not tell which case it solves.
    """
    double = [variant for variant in variants if variant.precision == "float64"]
    rows = []
    for variant in double:
        first = [_first(scheme, variant) for scheme in SCHEMES]
        for k in range(repeats):
            say(f"plate, {variant.threads or 1} threads: repetition {k + 1} of {repeats}")
            for row, data in first:
                first_steps(row, data)
        later = [_later(scheme, variant, say) for scheme in SCHEMES] if variant is double[-1] else []
        for found in ([(row, 0.0, _listed(data, variant)) for row, data in first], later):
            base = median(found[0][0].ns) if found else 0.0
            rows += [_cells(row, eulerian, listed, base) for row, eulerian, listed in found]
    beside = _beside(double, peers, repeats, say)
    return [("Total Lagrangian and coupled steps", HEADER, rows), *beside]


def plate(scheme: str) -> SceneData:
    """Finalise the bundled scene debris_3d with an engine's scheme in place of its own."""
    coupled = scheme.startswith("adaptle")
    scene = library.load("debris_3d").build(scheme="adaptle" if coupled else "eul", spacing=SPACING)
    scene.numerics = replace(scene.numerics, scheme=scheme)
    return scene.finalize()


def _first(scheme: str, variant: Variant) -> tuple[Series, SceneData]:
    data = plate(scheme)
    return Series(scheme, "first steps", variant, len(data.x)), data


def _later(scheme: str, variant: Variant, say: Callable[[str], None]) -> tuple[Series, float, float]:
    """Measure once in the middle; gives the shares of Eulerian particles and of those that have rows besides."""
    say(f"plate at {LATER * 1e6:g} µs, {scheme}, {variant.threads or 1} threads")
    data = plate(scheme)
    solver = variant.solver(data)
    solver.advance(LATER)
    row = Series(scheme, f"at {LATER * 1e6:g} µs", variant, len(data.x))
    next_steps(row, solver)
    return row, float((solver.particles.kernel_type.numpy() == EULERIAN).mean()), _rows(solver)


def _listed(data: SceneData, variant: Variant) -> float:
    return _rows(variant.solver(data))


def _rows(solver: Solver) -> float:
    """Share of the particles that have neighbour rows of present positions."""
    return float((solver.neighbours.n_neigh.numpy() > 0).mean())


def _cells(row: Series, eulerian: float, listed: float, base: float) -> list[str]:
    middle, rebuilds = median(row.ns), row.steps / row.builds if row.builds else float("inf")
    eulerian = 1.0 if row.case.startswith("sav1") else eulerian
    return [
        row.case, row.window, str(row.variant.threads or "-"), f"{middle:.4g}", f"{min(row.ns):.4g}",
        f"{max(row.ns):.4g}", f"{base / middle:.2f}", f"{eulerian:.1%}", f"{listed:.1%}", f"{rebuilds:.3g}",
    ]  # fmt: skip


def _plate_beside() -> Scene:
    scene = library.load("debris_3d").build(scheme="tlag", spacing=SPACING)
    scene.numerics = replace(scene.numerics, smoothing_ratio=SMOOTHING_RATIO, scheme="tl")
    return scene


def _taylor_beside() -> Scene:
    scene = library.load("taylor_bar").build(scheme="tl", spacing=0.381 * SPACING, quarter=False)
    scene.numerics = replace(scene.numerics, smoothing_ratio=SMOOTHING_RATIO)
    return scene


BESIDE = {"plate": _plate_beside, "taylor": _taylor_beside}
"""Our scene by the name that a peer gives its case; both Total Lagrangian with corrected gradients."""

PEER_HEADER = (
    "case", "code", "particles", "neighbours", "threads", "steps", "its ns per particle-step: median", "min", "max",
    "warpsph's median", "times faster", "per pair",
)  # fmt: skip
"""Columns of the comparison."""


def _beside(variants: list[Variant], peers: list[Peer], repeats: int, say: Callable[[str], None]) -> Tables:
    """Measure both cases in turn with every peer, so that all see the same machine."""
    if not peers:
        return []
    rows = []
    for case, build in BESIDE.items():
        data = build().finalize()
        rows += [Series(case, "first steps", variant, len(data.x)) for variant in variants]
        for k in range(repeats):
            say(f"{case}, {len(data.x):,} particles: repetition {k + 1} of {repeats}")
            for row in rows[-len(variants) :]:
                first_steps(row, data)
            for peer in peers:
                if not peer.facts or peer.facts.get("case") == case:
                    peer.measure()
    compared = [_compared(peer, row) for peer in peers for row in rows if _same(peer, row)]
    return [
        ("Ours beside other codes", SERIES_HEADER, [row.cells() for row in rows]),
        ("Beside other codes", PEER_HEADER, compared),
    ]


def _same(peer: Peer, row: Series) -> bool:
    """Whether a peer's figures belong beside a row.

    Raises:
        InputError: It does not tell its case.
    """
    case = peer.facts.get("case")
    if case not in BESIDE:
        raise measuring.peer_case(peer.command, case, BESIDE)
    return case == row.case and peer.facts["threads"] == row.variant.threads


def _compared(peer: Peer, row: Series) -> list[str]:
    theirs, ours = median(peer.ns), median(row.ns)
    per_pair = (theirs / float(peer.facts["neighbours"])) / (ours / row.neighbours)
    return [row.case, *peer.cells(), f"{ours:.4g}", f"{theirs / ours:.2f}", f"{per_pair:.2f}"]
