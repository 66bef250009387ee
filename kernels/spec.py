"""What a kernel is specialised for: the space dimension and the scalar types."""

import functools
from dataclasses import dataclass

import warp as wp

LANES = 8
"""Pairs that a loop on a CPU handles at once: single-precision numbers in 256 bits, double ones in 512. Rows of
neighbours are filled up to a multiple of it."""

COLUMNS = 32
"""Rows of neighbours that stand side by side on a GPU, one for each thread of a warp."""

LANE_FLAGS = "-mreassociate -fno-signed-zeros -mllvm=-force-target-max-vector-interleave=1"
"""CPU compiler flags of loops over lanes: sums may be taken in any order and a zero has no sign; one register at a time,
for rows are short. `Spec.lane_flags` adds how wide it is."""


@dataclass(frozen=True)
class Spec:
    """A specialisation: the space dimension of the problem and the scalar types of its arithmetic.

    Vectors and tensors always have three components (plane strain in 2D, uniaxial strain in 1D).
    Positions may be finer than the rest: their differences then keep all digits of ``real`` however far from the
    origin the particles are.

    Attributes:
        dim: Space dimension: 1, 2 or 3.
        real: ``wp.float32`` or ``wp.float64``.
        place: Scalar type of positions; that of ``real`` if not given.
        lanes: Pairs that a loop handles at once: `LANES` on a CPU, 1 on a GPU, whose threads are its lanes (see `lanes`).
    """

    dim: int
    real: type
    place: type | None = None
    lanes: int = LANES

    def __post_init__(self):
        """Give positions the type of everything else, unless they have their own."""
        object.__setattr__(self, "place", self.place or self.real)

    @functools.cached_property
    def vec(self) -> type:
        """Vector type, three components of ``real``."""
        return wp.types.vector(3, self.real)

    @functools.cached_property
    def point(self) -> type:
        """Position type, three components of ``place``; `vec` where that is ``real``."""
        return wp.types.vector(3, self.place)

    @functools.cached_property
    def mat(self) -> type:
        """Second-order tensor type, 3x3 components of ``real``."""
        return wp.types.matrix((3, 3), self.real)

    @functools.cached_property
    def sym(self) -> type:
        """Symmetric tensor as it is stored: xx, yy, zz, xy, yz, xz."""
        return wp.types.vector(6, self.real)

    @property
    def columns(self) -> int:
        """Rows of neighbours that stand side by side, entry by entry, so that threads read entries next to each other.

        1 where there are lanes: every row is in one piece.
        """
        return COLUMNS if self.lanes == 1 else 1

    @property
    def tag(self) -> str:
        """Short name: ``3d_f32``, ``3d_f64`` or ``3d_mixed``, and of those on a GPU ``3d_f32_gpu``."""
        own = "mixed" if self.place is not self.real else "f32" if self.real is wp.float32 else "f64"
        return f"{self.dim}d_{own}" + "_gpu" * (self.lanes == 1)

    @property
    def lane_flags(self) -> str:
        """CPU compiler flags of loops over lanes.

        The widest registers hold 8 double-precision numbers or 16 single ones. In 2D a row has 24 entries: of these 16
        would leave 8, which are then done one by one. Registers of 8 leave none. With positions in double precision a
        loop handles no more than 8 at once anyway.
        """
        narrow = self.place is wp.float32 and self.dim < 3
        return f"{LANE_FLAGS} -mprefer-vector-width={256 if narrow else 512}"

    def module(self, file: str, variant: str = "", lanes: bool = False, tables: str = "") -> str:
        """Name the Warp module that holds the kernels of ``file`` at this specialisation.

        Warp compiles and caches one module at a time and fixes its options at the first load, so a
        file whose kernels have compile-time options beyond the specialisation adds a ``variant``; one whose
        loops are over lanes says so. Of functions that a loop picks from a table by its index Warp does not see whether
        they have changed since it compiled them: ``tables`` tells one text of them from another.
        """
        name = ".".join(part for part in (file, self.tag, variant) if part)
        wp.get_module(name).options |= {"enable_backward": False, "default_grid_stride": False}
        if lanes and self.lanes > 1:
            flags = wp.config.cpu_compiler_flags or "-march=native"
            wp.get_module(name).options["cpu_compiler_flags"] = f"{flags} {self.lane_flags}"
        if tables:  # every option is in the hash by which Warp keeps modules
            wp.get_module(name).options["tables"] = tables
        return name
