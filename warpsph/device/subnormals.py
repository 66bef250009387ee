"""Numbers too small to be normal count as zero while kernels run on a CPU.

Ahead of a front, numbers fall to nothing from particle to particle, and their squares sooner: in single precision below
1e-38, in double precision below 1e-308. There they are subnormal, have few digits left, and each operation with one
takes a processor a hundred cycles. Nothing of physics is that small.
"""

import ctypes
import platform
import struct

MODES = {"x86_64": struct.pack("<HHI", 0x37F, 0, 0x9FC0), "aarch64": struct.pack("<I", 1 << 24)}
"""C's ``femode_t`` by processor: everything as it is by default, but that subnormal numbers are read and written as zero."""


def _functions() -> tuple | None:
    """``fegetmode`` and ``fesetmode``, called with the interpreter lock held; None where the C library has neither."""
    library = ctypes.PyDLL(None)
    if platform.machine() not in MODES or not hasattr(library, "fesetmode"):
        return None
    for function in (library.fegetmode, library.fesetmode):
        function.argtypes, function.restype = (ctypes.c_void_p,), None
    return library.fegetmode, library.fesetmode


_FUNCTIONS = _functions()
_FLUSHED = ctypes.create_string_buffer(MODES.get(platform.machine(), b""))
_FLUSHED_AT = ctypes.addressof(_FLUSHED)  # a plain number goes into a call in half the time


class Flushing:
    """``with`` it, the calling thread takes subnormal numbers for zero; nothing changes where that is not to be had.

    Within itself it costs nothing: many launches in a row enter it once.
    """

    def __init__(self):
        """Make room for the mode that is to come back."""
        self._before = ctypes.create_string_buffer(len(_FLUSHED))
        self._at = ctypes.addressof(self._before)
        self._depth = 0

    def __enter__(self) -> None:
        """Keep the thread's mode and set the other."""
        if self._depth == 0 and _FUNCTIONS is not None:
            _FUNCTIONS[0](self._at)
            _FUNCTIONS[1](_FLUSHED_AT)
        self._depth += 1

    def __exit__(self, *_failure: object) -> None:
        """Bring back the thread's own mode."""
        self._depth -= 1
        if self._depth == 0 and _FUNCTIONS is not None:
            _FUNCTIONS[1](self._at)


def flush() -> None:
    """Have the calling thread take subnormal numbers for zero from now on."""
    if _FUNCTIONS is not None:
        _FUNCTIONS[1](_FLUSHED_AT)


def can_flush() -> bool:
    """Whether this machine and its C library offer it."""
    return _FUNCTIONS is not None
