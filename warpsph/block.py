"""One piece of device memory that serves several uses in turn."""

import warp as wp

ALIGNMENT = 64
"""Bytes to which the start of a view is rounded."""


class Block:
    """Memory of which every use takes views of its own; none of them outlives the next use.

    The entries of neighbour rows are the largest such use. While rows are rebuilt their old entries are dead, and
    sorting the particles and finding the tiles work in their place.

    Attributes:
        words: The memory, as int32.
        generation: Changes when it has moved.
    """

    def __init__(self, device: wp.Device):
        """Start with nothing; the first use makes it as large as it needs."""
        self._device, self.generation = device, 0
        self.words = wp.empty(1, dtype=wp.int32, device=device)

    def grow(self, words: int) -> None:
        """Make it at least so many words long; what was in it is lost where it has to move."""
        if words > self.words.size:
            self.words = None  # the old memory goes before the new comes
            self.words = wp.empty(words, dtype=wp.int32, device=self._device)
            self.generation += 1

    def views(self, *layout: tuple[type, int]) -> list[wp.array]:
        """Cut arrays of (type, length) from the start on, one behind the other; their contents are undefined."""
        starts, end = [], 0
        for dtype, n in layout:
            starts.append(end)
            end += -(-n * wp.types.type_size_in_bytes(dtype) // ALIGNMENT) * ALIGNMENT
        self.grow(end // 4)
        return [
            wp.array(ptr=self.words.ptr + start, dtype=dtype, shape=n, device=self._device)
            for start, (dtype, n) in zip(starts, layout, strict=True)
        ]
