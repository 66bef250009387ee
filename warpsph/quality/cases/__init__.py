"""The validation cases, one file each: what is run, what comes out by the papers, and what is expected.

These files are the only place of these numbers.
"""

from .flyer_plate import flyer_plate
from .hvi_2d import hvi_2d
from .noh import noh
from .ring_collapse import ring_collapse
from .sic_impact import sic_impact
from .sod import sod
from .tables import Case
from .tensile_patch import tensile_patch

CASES: dict[str, Case] = {
    case.scene: case
    for case in (hvi_2d(), tensile_patch(), flyer_plate(), ring_collapse(), sic_impact(), noh(), sod())
}
"""Every validation case by its name."""
