"""What a kernel is specialised for: the space dimension and the scalar type."""

import functools
from dataclasses import dataclass

import warp as wp


@dataclass(frozen=True)
class Spec:
    """A specialisation: the space dimension of the problem and the scalar type of its arithmetic.

    Vectors and tensors always have three components (plane strain in 2D, uniaxial strain in 1D).

    Attributes:
        dim: Space dimension: 1, 2 or 3.
        real: ``wp.float32`` or ``wp.float64``.
    """

    dim: int
    real: type

    @functools.cached_property
    def vec(self) -> type:
        """Vector type, three components of ``real``."""
        return wp.types.vector(3, self.real)

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
        """Short name, for example ``3d_f32``."""
        return f"{self.dim}d_f{32 if self.real is wp.float32 else 64}"

    def module(self, file: str, variant: str = "") -> str:
        """Name the Warp module that holds the kernels of ``file`` at this specialisation.

        Warp compiles and caches one module at a time and fixes its options at the first load, so a
        file whose kernels have compile-time options beyond the specialisation adds a ``variant``.
        """
        name = ".".join(part for part in (file, self.tag, variant) if part)
        wp.get_module(name).options |= {"enable_backward": False, "default_grid_stride": False}
        return name
