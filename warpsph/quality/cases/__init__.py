"""The validation cases, one file each: what is run, what comes out by the papers, and what is expected.

These files are the only place of these numbers.
"""

from .hvi_2d import hvi_2d
from .sod import sod
from .tables import Case

CASES: dict[str, Case] = {case.scene: case for case in (hvi_2d(), sod())}
"""Every validation case by its name."""
