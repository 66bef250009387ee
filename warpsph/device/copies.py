"""Between device and host: copies of arrays, in memory that can be filled again, and the way back."""

from collections.abc import Mapping

import numpy as np
import warp as wp


def make_room(arrays: Mapping[str, wp.array]) -> dict[str, wp.array]:
    """Memory of the host for a copy of each array, by name; page-locked where a GPU fills it."""
    return {
        name: wp.empty_like(array, device="cpu", pinned=array.device.is_cuda)
        for name, array in arrays.items()
    }


def to_host(
    arrays: Mapping[str, wp.array], into: Mapping[str, wp.array] | None = None
) -> dict[str, np.ndarray]:
    """Copy each array to the host.

    Args:
        arrays: Arrays of one device by name.
        into: What `make_room` gave, to be filled (again: memory the system has just handed out is slow to fill).
    """
    into = make_room(arrays) if into is None else into
    for name, array in arrays.items():
        wp.copy(into[name], array)
    wp.synchronize_device(next(iter(arrays.values())).device)
    return {name: into[name].numpy() for name in arrays}


def to_device(array: wp.array, values: np.ndarray) -> None:
    """Fill an array with what `to_host` gave, perhaps in another precision."""
    scalar = wp.dtype_to_numpy(getattr(array.dtype, "_wp_scalar_type_", array.dtype))
    array.assign(values.astype(scalar, copy=False))


def host_shape(array: wp.array) -> tuple[int, ...]:
    """Shape of what `to_host` gives of an array."""
    return (*array.shape, *getattr(array.dtype, "_shape_", ()))


def fits(array: wp.array, values: np.ndarray) -> bool:
    """Whether an array can be filled with what was read, perhaps in another precision."""
    scalar = wp.dtype_to_numpy(getattr(array.dtype, "_wp_scalar_type_", array.dtype))
    return values.shape == host_shape(array) and values.dtype.kind == np.dtype(scalar).kind
