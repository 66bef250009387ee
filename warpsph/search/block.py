"""One piece of device memory that serves several uses in turn."""

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import warp as wp

from warpsph.memory import available
from warpsph.messages import machine

T = TypeVar("T")

LINE = wp.types.vector(16, wp.int32)
"""64 bytes, to which the start of a view is rounded. Counted in these, an array may be larger than 2^31 words."""


def borrowed(owner: wp.array, start: int, dtype: type, n: int) -> wp.array:
    """An array of n entries in another one's memory, from a byte on; it keeps that memory alive."""
    view = wp.array(ptr=owner.ptr + start, dtype=dtype, shape=n, device=owner.device)
    view._ref = owner  # as Warp's own slices do
    return view


class Block:
    """Memory of which every use takes views of its own; none of them outlives the next use.

    The entries of neighbour rows are the largest such use. While rows are rebuilt their old entries are dead, and
    sorting the particles and finding the tiles work in their place.

    Attributes:
        lines: The memory.
        generation: Changes when it has moved.
        let_go: Called before it moves: whoever keeps views of it, as bound launches do, drops them, for they would keep
            the old memory beside the new.
    """

    def __init__(self, device: wp.Device):
        """Start with next to nothing; every use makes it as large as it needs."""
        self._device, self.generation = device, 0
        self._bound: dict[Hashable, Any] = {}
        self.let_go: Callable[[], None] = lambda: None
        self.lines = wp.empty(1, dtype=LINE, device=device)

    @property
    def size(self) -> int:
        """Its length in words of four bytes."""
        return LINE._length_ * self.lines.size

    def grow(self, words: int) -> bool:
        """Make it at least so many words long; where it has to move (True) what was in it is lost.

        Raises:
            RunError: There is no memory for it; it is then as short as at the start, and what needs more fails again.
        """
        if words <= self.size:
            return False
        self.release()  # the old memory goes before the new comes
        lines = -(-words // LINE._length_)
        need = lines * wp.types.type_size_in_bytes(LINE)
        free = available.on_device(self._device)
        try:
            if free is not None and need > free and self._device.is_cpu:
                raise MemoryError  # the system would hand it out, and end the process when it is filled
            self.lines = wp.empty(lines, dtype=LINE, device=self._device)
        except (MemoryError, RuntimeError):
            raise machine.used_up("neighbour rows", need, self._device.alias, free) from None
        return True

    def release(self) -> None:
        """Give the memory back: there is no further use."""
        self._bound.clear()
        self.let_go()
        self.lines = wp.empty(1, dtype=LINE, device=self._device)
        self.generation += 1

    def bound(self, key: Hashable, bind: Callable[[], T]) -> T:
        """What ``bind`` gave for this key, launches on views of the memory: made once, and again when it has moved."""
        if key not in self._bound:
            made = bind()  # which may move it
            self._bound[key] = made
        return self._bound[key]

    def view(self, dtype: type, first: int, n: int) -> wp.array:
        """An array of n entries of one or two words, from the ``first`` on."""
        return borrowed(self.lines, first * wp.types.type_size_in_bytes(dtype), dtype, n)

    def views(self, *layout: tuple[type, int]) -> list[wp.array]:
        """Cut arrays of (type, length) from the start on, one behind the other; their contents are undefined."""
        line, starts, end = wp.types.type_size_in_bytes(LINE), [], 0
        for dtype, n in layout:
            starts.append(end)
            end += -(-n * wp.types.type_size_in_bytes(dtype) // line) * line
        self.grow(end // 4)
        cuts = zip(starts, layout, strict=True)
        return [borrowed(self.lines, start, dtype, n) for start, (dtype, n) in cuts]
