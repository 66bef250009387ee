"""Memory of the device: a range of the host's that can be touched only while the device is at work."""

import bisect
import contextlib
import ctypes
from collections import defaultdict
from collections.abc import Iterator

ALIGNED = 256
"""Allocations begin at multiples of so many bytes, as CUDA's do; so many lie between one and the next."""

NONSENSE = 0xFF
"""What memory is filled with that nobody has written: not a number, or -1."""

SPREAD = 8
"""Addresses that are set aside, over the bytes there are: what is given back is only used for as large an array."""

NONE, READ_WRITE = 0, 3
PRIVATE_ANONYMOUS_NORESERVE = 0x02 | 0x20 | 0x4000

_libc = ctypes.CDLL(None)
_libc.mmap.restype = ctypes.c_void_p
_libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
_libc.mprotect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]


class Memory:
    """Allocations, and how many bytes are left.

    Attributes:
        total: Bytes of the device.
        pooled: Bytes given back since the last synchronisation: the pool still has them.
    """

    def __init__(self, total: int):
        self.total, self.pooled, self._held, self._open = total, 0, 0, False
        self._first = _libc.mmap(None, SPREAD * total, NONE, PRIVATE_ANONYMOUS_NORESERVE, -1, 0)
        self._end = self._first
        self._sizes: dict[int, int] = {}
        self._starts: list[int] = []
        self._spare: dict[int, list[int]] = defaultdict(list)

    @property
    def free(self) -> int:
        """Bytes that the driver has to give."""
        return self.total - self._held - self.pooled

    def take(self, size: int) -> int | None:
        """Allocate; None if there is not so much."""
        size = -(-max(size, 1) // ALIGNED) * ALIGNED
        if size > self.total - self._held:
            return None
        start = self._spare[size].pop() if self._spare[size] else self._end
        self._end = max(self._end, start + size + ALIGNED)
        self._sizes[start] = size
        bisect.insort(self._starts, start)
        self._held += size
        self.pooled = max(self.pooled - size, 0)
        with self.at_hand():
            ctypes.memset(start, NONSENSE, size + ALIGNED)
        return start

    def give(self, start: int) -> None:
        """Give an allocation back; the device is at work."""
        size = self._sizes.pop(start)
        if ctypes.string_at(start + size, ALIGNED) != bytes([NONSENSE]) * ALIGNED:
            raise RuntimeError(f"something was written beyond the end of an array of about {size} bytes")
        ctypes.memset(start, NONSENSE, size)
        self._starts.remove(start)
        self._spare[size].append(start)
        self._held -= size
        self.pooled += size

    def holds(self, address: int) -> bool:
        """Whether an address lies in an array, or just after its end."""
        k = bisect.bisect_right(self._starts, address) - 1
        return k >= 0 and address <= self._starts[k] + self._sizes[self._starts[k]]

    @contextlib.contextmanager
    def at_hand(self) -> Iterator[None]:
        """Let the body touch the device's memory."""
        was, self._open = self._open, True
        self._protect(READ_WRITE)
        try:
            yield
        finally:
            self._open = was
            if not was:
                self._protect(NONE)

    def _protect(self, mode: int) -> None:
        _libc.mprotect(self._first, self._end - self._first, mode)
