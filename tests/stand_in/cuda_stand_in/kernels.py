"""Kernels of the device: the CPU's code of the same kernel, whose threads come in another order."""

import ctypes
import itertools
from collections.abc import Callable, Iterator

import warp as wp
from warp._src import context
from warp._src.codegen import Struct, cuda_kernel_forward_name
from warp._src.types import array_t, is_array, launch_bounds_t, type_is_composite

from .work import KERNEL, Work

MOST_THREADS = 1024
"""Threads of a block at most."""

PARTS = 5
"""A launch is run in so many parts, the last threads first: nobody may count on their order."""


class Kernel:
    """What a launch gets hold of as the function of a kernel."""

    def __init__(self, kernel: wp.Kernel, forward: Callable, name: str):
        self.name, self._forward, self.loaded = name, forward, True
        args = kernel.adj.args
        self._bounds = type(launch_bounds_t((0,) * kernel.adj.kernel_dim))
        self._types = [_ctype(kernel, arg) for arg in args]
        fields = [(arg.label, kind) for arg, kind in zip(args, self._types, strict=True)]
        self._args = type("Args", (ctypes.Structure,), {"_fields_": fields})
        self._cut = kernel.adj.kernel_dim == 1 and bool(args) and args[0].label == "offset"

    def read(self, addresses: ctypes.Array) -> tuple[ctypes.Structure, ctypes.Structure]:
        """Take bounds and arguments of a launch as they are now: CUDA does not look at them later."""
        bounds, args = self._bounds.from_address(addresses[0]), self._args()
        for (name, kind), address in zip(self._args._fields_, addresses[1:], strict=True):
            offset = getattr(self._args, name).offset
            ctypes.memmove(ctypes.addressof(args) + offset, address, ctypes.sizeof(kind))
        return self._bounds.from_buffer_copy(bounds), args

    def arrays(self, args: ctypes.Structure) -> Iterator[tuple[str, int]]:
        """Name and address of each array among the arguments, within structs too."""
        for name, kind in self._args._fields_:
            yield from _arrays(name, kind, getattr(args, name))

    def run(self, bounds: ctypes.Structure, args: ctypes.Structure) -> None:
        """Run all threads."""
        if not self.loaded:
            raise RuntimeError(f"kernel {self.name} has been unloaded")
        if not self._cut:
            self._forward(ctypes.byref(bounds), ctypes.byref(args))
            return
        first = args.offset
        edges = sorted({bounds.size * k // PARTS for k in range(PARTS + 1)})
        for low, high in reversed(list(itertools.pairwise(edges))):
            args.offset = first + low
            self._forward(ctypes.byref(launch_bounds_t((high - low,))), ctypes.byref(args))
        args.offset = first


def launcher(work: Work) -> Callable:
    """Make the function that launches a kernel."""

    def launch(_context, kernel, size, _most, block, _stride, _cluster, _shared, addresses, stream, _apic):
        if not 1 <= block <= MOST_THREADS:
            raise RuntimeError(f"{kernel.name}: blocks of {block} threads")
        bounds, args = kernel.read(addresses)
        for name, address in kernel.arrays(args):
            if address and not work.memory.holds(address):
                raise RuntimeError(f"{kernel.name}: array {name!r} is not in the device's memory")
        if size:
            work.submit(lambda: kernel.run(bounds, args), stream, kernel.name, KERNEL)
        return 0

    return launch


def load_with(work: Work) -> None:
    """Have modules for the device loaded as the CPU's, and launches find their kernels."""
    load, hooks = context.Module.load, context.ModuleExec.get_kernel_hooks

    def load_either(self, device, block_dim=None, *args, **named):
        device = context.runtime.get_device(device)
        if device.is_cpu:
            return load(self, device, block_dim, *args, **named)
        key = (device.context, block_dim or self.options["block_dim"])
        loaded = self.execs.get(key)
        if loaded is None or loaded.module_hash != self.get_module_hash(1):
            work.refuse(f"loading module {self.name}")
            cpu = load(self, "cpu", 1)
            loaded = context.ModuleExec(cpu, cpu.module_hash, device, cpu.meta, key[1])
            self.execs[key] = loaded
        return loaded

    def hooks_of_either(self, kernel):
        if self.device.is_cpu:
            return hooks(self, kernel)
        found = hooks(self.handle, kernel)
        name = self.handle.get_kernel_mangled_name(kernel)
        if name not in self.kernel_hooks:
            function = Kernel(kernel, found.forward, cuda_kernel_forward_name(kernel, name))
            self.kernel_hooks[name] = context.KernelHooks(function, None)
        return self.kernel_hooks[name]

    context.Module.load, context.ModuleExec.get_kernel_hooks = load_either, hooks_of_either


def _ctype(kernel: wp.Kernel, arg) -> type:
    """Type by which an argument is passed."""
    if is_array(arg.type):
        return type(arg.type.__ctype__())
    if isinstance(arg.type, Struct):
        return arg.type.ctype
    if type_is_composite(arg.type):
        return arg.type
    return type(context.pack_arg(kernel, arg.type, arg.label, 0, "cpu"))


def _arrays(name: str, kind: type, value) -> Iterator[tuple[str, int]]:
    if kind is array_t:
        yield name, value.data
    elif issubclass(kind, ctypes.Structure):
        for field, inner, *_ in kind._fields_:
            if issubclass(inner, ctypes.Structure):
                yield from _arrays(f"{name}.{field}", inner, getattr(value, field))
