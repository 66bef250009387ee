"""What a kernel is specialised for: the space dimension and the scalar types."""

import functools
from dataclasses import dataclass

import warp as wp


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
    """

    dim: int
    real: type
    place: type | None = None

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
    def tag(self) -> str:
        """Short name: ``3d_f32``, ``3d_f64`` or ``3d_mixed``."""
        own = "mixed" if self.place is not self.real else "f32" if self.real is wp.float32 else "f64"
        return f"{self.dim}d_{own}"

    def module(self, file: str, variant: str = "") -> str:
        """Name the Warp module that holds the kernels of ``file`` at this specialisation.

        Warp compiles and caches one module at a time and fixes its options at the first load, so a
        file whose kernels have compile-time options beyond the specialisation adds a ``variant``.
        """
        name = ".".join(part for part in (file, self.tag, variant) if part)
        wp.get_module(name).options |= {"enable_backward": False, "default_grid_stride": False}
        return name
