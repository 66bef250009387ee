"""What a trial is given, and what it finds."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Means:
    """What a trial may use.

    Attributes:
        scratch: An empty folder of its own.
        quick: A short version, for the tests: seconds instead of minutes, the same checks.
        say: Takes a line about how far it is.
    """

    scratch: Path
    quick: bool
    say: Callable[[str], None]


@dataclass
class Findings:
    """A table of figures, remarks, and what did not hold.

    Attributes:
        header: Columns of the table.
        rows: Its rows, as text.
        notes: Markdown in front of it: what was done, how often, with which seed.
        failed: What did not hold, one line each; empty if all is well.
    """

    header: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
