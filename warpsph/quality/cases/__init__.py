"""The validation cases, one file each: what is run, what comes out by the papers, and what is expected.

These files are the only place of these numbers.
"""

from .debris_3d import debris_3d
from .flyer_plate import flyer_plate
from .hvi_2d import hvi_2d
from .noh import noh
from .oscillating_plate import oscillating_plate
from .ring_collapse import ring_collapse
from .rotating_disc import rotating_disc
from .rubber_rings import rubber_rings
from .sic_impact import sic_impact
from .sod import sod
from .tables import Case
from .taylor_bar import taylor_bar
from .tensile_patch import tensile_patch

ALL = (
    hvi_2d, tensile_patch, debris_3d, taylor_bar, oscillating_plate, rubber_rings, rotating_disc,
    flyer_plate, ring_collapse, sic_impact, noh, sod,
)  # fmt: skip
"""The cases of Young et al. and of Total Lagrangian particles first, then those of Connolly et al."""

CASES: dict[str, Case] = {case.scene: case for case in (make() for make in ALL)}
"""Every validation case by its name."""
