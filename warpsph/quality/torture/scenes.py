"""Scenes drawn at random: each runs, or is refused with a clear line before it starts.

``scene(number)`` gives the one of a number again.
"""

from collections import Counter, defaultdict
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from warpsph.schemes import SCHEMES, EulerianSettings, GodunovSettings

from .drawn import DrawnScene
from .judging import STEPS, Outcome, judge, kind_of
from .trial import Findings, Means

if TYPE_CHECKING:
    from .drawing import KernelSet

ROUNDS = 2
"""Sets of kernels that are drawn for each scheme, with other options, dimension and precision."""

EACH = 30
"""Scenes drawn of each set."""

QUICK_EACH = 13
"""Scenes drawn of each in the short version."""

BLOCK = 1000
"""Numbers that belong to a set of kernels."""

FOUND = (
    "Two Lagrangian particles beside a symmetry plane whose distance was the support to the last digit were neighbours on one "
    "side only: with a support of a whole number of spacings energy drifted by 1e-4. Reference neighbours now end at "
    "1 - 1e-6 of it, and so does the Gaussian, which jumps there.",
    "Bodies much faster than their sound leapt over the support in one step, into each other, through a symmetry plane, or "
    "away from it (density 1e-30). Nothing comes nearer by more than h in a step now.",
    "Plane stress of hot or torn matter, which has no thickness without stress, sought it beyond all numbers; a fluid has "
    "none at all and is refused.",
    "A body could start where its equation of state has no sound speed, and ended soon after. It is refused.",
    "The message about a stop beyond all numbers came with warnings of numpy.",
)
"""What drawing scenes has found, and how it was mended."""

HEADER = (
    "schemes", "drawn", "ran", "refused", "turned over", "beyond its laws", "failed",
    "energy error, double", "single", "momentum error, double", "single",
)  # fmt: skip
"""Columns of the table."""


def run(means: Means) -> Findings:
    """Draw scenes and judge them."""
    try:
        found = f"Hypothesis {version('hypothesis')}"
    except PackageNotFoundError:
        return Findings(HEADER, failed=["hypothesis is not installed; allowed: pip install warpsph[dev]"])
    from .drawing import COMMON

    sets = len(COMMON) + (0 if means.quick else ROUNDS * len(SCHEMES))
    numbers = [BLOCK * k + j for k in range(sets) for j in range(QUICK_EACH if means.quick else EACH)]
    findings, outcomes = Findings(HEADER), defaultdict(list)
    for done, number in enumerate(numbers):
        name, drawn = _kernels(number).scheme, scene(number)
        outcome = judge(drawn)
        outcomes[family(name)].append((drawn, outcome))
        if outcome.kind == "failed":
            findings.failed.append(
                f"scene {number} ({name}, {drawn.dim}D, {drawn.precision}): {outcome.detail}"
            )
        if number % BLOCK == 0:
            means.say(f"{done} of {len(numbers)} drawn, {len(findings.failed)} failed; next: {name}")
    findings.rows = [_row(name, results) for name, results in outcomes.items()]
    every = [outcome for results in outcomes.values() for _, outcome in results]
    findings.notes = [
        _method(found, numbers),
        _refusals(every),
        "Found so, and mended:",
        "\n".join(f"- {line}" for line in FOUND),
    ]
    return findings


def scene(number: int) -> DrawnScene:
    """Draw the scene of a number."""
    from .drawing import drawn

    return drawn(_kernels(number), number)


def family(scheme: str) -> str:
    """What kind of scheme it is."""
    settings = SCHEMES[scheme]
    if not getattr(settings, "exact_energy", True):
        return "explicit stepping"
    if isinstance(settings, EulerianSettings):
        return "artificial viscosity"
    if isinstance(settings, GodunovSettings):
        return "Godunov"
    return "Total Lagrangian" if settings.eulerian is None else "coupled"


def _kernels(number: int) -> "KernelSet":
    """The set of kernels that a scene is drawn for."""
    from .drawing import COMMON, kernel_set

    k = number // BLOCK
    if k < len(COMMON):
        return COMMON[k]
    return kernel_set(list(SCHEMES)[(k - len(COMMON)) % len(SCHEMES)], k)


def _row(name: str, results: list[tuple[DrawnScene, Outcome]]) -> list[str]:
    """A row of the table; errors are of the runs that conserve."""
    kinds = Counter(outcome.kind for _, outcome in results)
    cells = [
        name,
        str(len(results)),
        *(str(kinds[kind]) for kind in ("ran", "refused", "turned over", "beyond", "failed")),
    ]
    for error in ("energy_error", "momentum_error"):
        for double in (True, False):
            ran = [o for drawn, o in results if o.conserved and (drawn.precision == "float64") == double]
            cells.append(f"{max(getattr(o, error) for o in ran):.0e}" if ran else "-")
    return cells


def _method(hypothesis: str, numbers: list[int]) -> str:
    particles = "one to some hundreds of particles"
    return (
        f"{len(numbers)} scenes, numbers {min(numbers)} to {max(numbers)}, drawn with {hypothesis}: one to four bodies of "
        f"{particles}, 1D to 3D, in double, single and mixed precision, at 0 to 20 km/s, apart and overlapping, at most two "
        f"things about each that no one would ask for lightly. A scene has to run {STEPS} steps with a finite state, all its "
        "particles with their masses, and energy and momentum kept; or be refused before the first one, in a line that says "
        "what is allowed. A run may stop, in a line that names the particle, for two reasons: a Lagrangian particle has "
        "turned over and the scene asks for no conversion; or matter has been beyond its equation of state, where that has "
        "no sound speed or no pressure, as of solids torn apart without a law that lets them fail. Errors are over what "
        "there is of energy and momentum without regard to sign, of schemes and couplings that conserve them."
    )


def _refusals(outcomes: list[Outcome]) -> str:
    kinds = Counter(kind_of(outcome.detail) for outcome in outcomes if outcome.kind == "refused")
    most = "; ".join(f"{count}: {text}" for text, count in kinds.most_common(5))
    return f"Refused for {len(kinds)} reasons, most often {most}." if kinds else "None was refused."
