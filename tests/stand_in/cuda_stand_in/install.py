"""Put the stand-in in the place of CUDA."""

import ctypes
from collections.abc import Callable

from warp._src import context

from .calls import ANSWERS, Calls
from .kernels import load_with
from .memory import Memory
from .work import BUILTIN, Work

TOTAL = 4 * 2**30
"""Bytes of memory."""

KINDS = ("int", "uint", "float", "double", "int64", "uint64")
"""Types that Warp sorts and scans."""


def install() -> None:
    """Have Warp find the device ``cuda:0``, its default then, as soon as it looks for devices."""
    look = context.Runtime.__init__

    def look_and_add(runtime):
        look(runtime)
        if not runtime.cuda_devices:
            _add(runtime)

    context.Runtime.__init__ = look_and_add


def _add(runtime: context.Runtime) -> None:
    work = Work(Memory(TOTAL))
    substitute(runtime.core, work)
    load_with(work)
    device = context.Device(runtime, "cuda:0", ordinal=0, is_primary=True)
    runtime.cuda_devices, runtime.cuda_primary_devices = [device], [device]
    runtime.device_map["cuda:0"], runtime.cuda_custom_context_count = device, [0]
    runtime.driver_version = runtime.toolkit_version
    runtime.set_default_device("cuda:0")


def substitute(core: ctypes.CDLL, work: Work) -> None:
    """Replace every function of Warp's library that would need a GPU; what is not provided raises."""
    for name in [name for name in vars(core) if "cuda" in name or name.endswith("_device")]:
        setattr(core, name, _lacking(name))
    for name, answer in ANSWERS.items():
        setattr(core, name, lambda *_, answer=answer: answer)
    for name in KINDS:
        for kind in (f"wp_radix_sort_pairs_{name}", f"wp_array_scan_{name}"):
            if hasattr(core, f"{kind}_host"):
                setattr(core, f"{kind}_device", _queued(work, getattr(core, f"{kind}_host"), kind))
    calls = Calls(work, core)
    for name in [name for name in dir(calls) if name.startswith("wp_")]:
        setattr(core, name, getattr(calls, name))


def _queued(work: Work, host: Callable, name: str) -> Callable:
    """The host's function, done when the device comes to it."""

    def call(*given: object) -> bool:
        work.submit(lambda: host(*given), work.stream, name, BUILTIN)
        return True

    return call


def _lacking(name: str) -> Callable:
    def call(*_given: object) -> None:
        raise NotImplementedError(f"the stand-in for a GPU has no {name}")

    return call
