"""The functions of Warp's library that have to do with CUDA, by their names there."""

import ctypes
import itertools
from typing import Any

from .kernels import launcher
from .memory import NONSENSE
from .work import BUILTIN, COPY, FILL, GRAPH, Capture, Event, Work

CONTEXT, CURRENT = 1, ctypes.c_void_p(-1).value

NAME = b"stand-in for a GPU: host memory, CPU kernels"

ANSWERS = {
    "wp_is_cuda_enabled": 1,
    "wp_cuda_driver_is_initialized": 1,
    "wp_cuda_device_get_count": 1,
    "wp_cuda_device_get_name": NAME,
    "wp_cuda_device_get_arch": 90,
    "wp_cuda_device_get_sm_count": 1,
    "wp_cuda_device_get_max_shared_memory": 232448,
    "wp_cuda_device_is_uva": 1,
    "wp_cuda_device_get_pageable_memory_access": 0,
    "wp_cuda_device_get_direct_managed_mem_access_from_host": 0,
    "wp_cuda_device_get_host_native_atomic_supported": 0,
    "wp_cuda_device_get_managed_memory_supported": 0,
    "wp_cuda_device_get_concurrent_managed_access_supported": 0,
    "wp_cuda_device_is_mempool_supported": 1,
    "wp_cuda_device_is_ipc_supported": 0,
    "wp_cuda_device_get_uuid": None,
    "wp_cuda_device_get_pci_domain_id": 0,
    "wp_cuda_device_get_pci_bus_id": 0,
    "wp_cuda_device_get_pci_device_id": 0,
    "wp_cuda_device_get_primary_context": CONTEXT,
    "wp_cuda_context_get_current": CONTEXT,
    "wp_cuda_context_set_current": None,
    "wp_cuda_context_push_current": None,
    "wp_cuda_context_pop_current": None,
    "wp_cuda_stream_register": None,
    "wp_cuda_stream_unregister": None,
    "wp_cuda_stream_destroy": None,
    "wp_cuda_event_destroy": None,
}
"""Functions that always answer the same."""


def bytes_of(source: Any, size: int) -> bytes:
    """What lies behind a pointer now."""
    return ctypes.string_at(source, size)


def kept(pointer: Any) -> Any:
    """Pointer to a copy of what one points to; None stays None."""
    if pointer is None:
        return None
    content = pointer._obj if hasattr(pointer, "_obj") else pointer.contents
    return ctypes.byref(type(content).from_buffer_copy(content))


class Calls:
    """Each method takes the place of the library's function of the same name, with its arguments."""

    def __init__(self, work: Work, core: ctypes.CDLL):
        self._work, self._memory, self._core = work, work.memory, core
        self._pinned: dict[int, int] = {}
        self._graphs: dict[int, list] = {}
        self._names = itertools.count(1)
        self.wp_cuda_launch_kernel = launcher(work)

    # -----------------------------------------------------------------------------------------------------------------
    # memory

    def wp_alloc_device_async(self, _context, size, _stream, _tag):
        self._work.refuse("allocating")
        return self._memory.take(size)

    def wp_alloc_device_default(self, context, size, tag):
        return self.wp_alloc_device_async(context, size, None, tag)

    def wp_free_device_async(self, _context, address, _stream):
        self._work.release(lambda: self._memory.give(address))

    def wp_free_device_default(self, context, address):
        self.wp_free_device_async(context, address, None)

    def wp_alloc_pinned(self, size, _tag):
        self._work.refuse("allocating page-locked memory")
        address = self._core.wp_alloc_host(size, None)
        ctypes.memset(address, NONSENSE, size)
        self._pinned[address] = size
        return address

    def wp_free_pinned(self, address):
        self._work.finish()
        del self._pinned[address]
        self._core.wp_free_host(address)

    def wp_cuda_device_get_memory_info(self, _ordinal, free, total):
        for reference, value in ((free, self._memory.free), (total, self._memory.total)):
            if reference is not None:
                reference._obj.value = value

    def wp_memset_device(self, _context, address, value, size, stream):
        self._submit(lambda: ctypes.memset(address, value, size), stream, "memset", FILL)
        return True

    def wp_memtile_device(self, _context, address, source, size, count):
        value, host = bytes_of(source, size), self._core.wp_memtile_host
        self._submit(lambda: host(address, value, size, count), CURRENT, "memtile", BUILTIN)

    def wp_memcpy_h2d(self, _context, target, source, size, stream):
        waiting = source if self._is_pinned(source) else bytes_of(source, size)
        self._submit(lambda: ctypes.memmove(target, waiting, size), stream, "memcpy HtoD", COPY)
        return True

    def wp_memcpy_d2h(self, _context, target, source, size, stream):
        pinned = self._is_pinned(target)
        if not pinned:
            self._work.refuse("copying to memory that is not page-locked")
        self._submit(lambda: ctypes.memmove(target, source, size), stream, "memcpy DtoH", COPY)
        return pinned or self._work.finish()

    def wp_memcpy_d2d(self, _context, target, source, size, stream):
        self._submit(lambda: ctypes.memmove(target, source, size), stream, "memcpy DtoD", COPY)
        return True

    def wp_array_copy_device(self, _context, target, source, *kinds):
        host, target, source = self._core.wp_array_copy_host, kept(target), kept(source)
        self._submit(lambda: host(target, source, *kinds), CURRENT, "copy", BUILTIN)
        return True

    def wp_array_fill_device(self, _context, target, kind, value, size):
        host, target, value = self._core.wp_array_fill_host, kept(target), bytes_of(value, size)
        self._submit(lambda: host(target, kind, value, size), CURRENT, "fill", BUILTIN)

    def _is_pinned(self, address: int) -> bool:
        return any(start <= address < start + size for start, size in self._pinned.items())

    def _submit(self, do, stream, name="", kind=0) -> None:
        number = getattr(stream, "value", stream)
        self._work.submit(do, self._work.stream if number == CURRENT else stream, name, kind)

    # -----------------------------------------------------------------------------------------------------------------
    # hash grids

    def wp_hash_grid_create_device(self, _context, *sizes):
        return self._core.wp_hash_grid_create_host(*sizes)

    def wp_hash_grid_reserve_device(self, *given):
        self._core.wp_hash_grid_reserve_host(*given)

    def wp_hash_grid_update_device(self, grid, kind, radius, points, groups):
        host, points, groups = self._core.wp_hash_grid_update_host, kept(points), kept(groups)
        self._submit(lambda: host(grid, kind, radius, points, groups), CURRENT, "hash grid", BUILTIN)

    def wp_hash_grid_destroy_device(self, *given):
        self._work.release(lambda: self._core.wp_hash_grid_destroy_host(*given))

    # -----------------------------------------------------------------------------------------------------------------
    # streams, events and synchronisation

    def wp_cuda_context_synchronize(self, _context):
        self._work.finish()
        self._memory.pooled = 0
        return True

    def wp_cuda_context_set_stream(self, _context, stream, _sync):
        self._work.stream = stream

    def wp_cuda_stream_create(self, _context, _priority):
        return next(self._names)

    def wp_cuda_stream_synchronize(self, _stream):
        return self._work.finish()

    def wp_cuda_stream_wait_event(self, *_given):
        """All streams are one."""

    def wp_cuda_stream_wait_stream(self, *_given):
        """All streams are one."""

    def wp_cuda_event_create(self, _context, flags):
        return Event(timed=not flags & 2)

    def wp_cuda_event_record(self, event, stream, _external):
        event.when = None
        self._submit(event.mark, stream)

    def wp_cuda_event_synchronize(self, _event):
        return self._work.finish()

    def wp_cuda_event_query(self, event):
        self._work.refuse("asking for an event")
        return 0 if event.when is not None else 600

    def wp_cuda_event_elapsed_time(self, start, end):
        if not (start.timed and end.timed):
            raise RuntimeError("CUDA error 400: an event without time")
        if start.when is None or end.when is None:
            raise RuntimeError("CUDA error 600: the device has not come to the event yet")
        return 1e3 * (end.when - start.when)

    # -----------------------------------------------------------------------------------------------------------------
    # graphs

    def wp_cuda_stream_is_capturing(self, stream):
        return int(self._work.capture is not None and self._work.capture.stream == stream)

    def wp_cuda_stream_get_capture_id(self, stream):
        return id(self._work.capture) if self.wp_cuda_stream_is_capturing(stream) else 0

    def wp_cuda_graph_begin_capture(self, _context, stream, _external, _mode):
        self._work.refuse("another capture")
        if stream is None:
            raise RuntimeError("CUDA error 900: the default stream cannot be captured")
        self._work.capture = Capture(stream)
        return True

    def wp_cuda_graph_end_capture(self, _context, _stream, graph):
        capture, self._work.capture = self._work.capture, None
        if capture.spoilt:
            return False
        graph._obj.value = next(self._names)
        self._graphs[graph._obj.value] = capture.jobs
        return True

    def wp_cuda_graph_create_exec(self, _context, _stream, graph, executable):
        self._work.refuse("making a graph executable")
        executable._obj.value = next(self._names)
        self._graphs[executable._obj.value] = self._graphs[graph.value]
        return True

    def wp_cuda_graph_launch(self, executable, stream):
        jobs = self._graphs[executable.value]
        self._submit(lambda: [job.do() for job in jobs], stream, "graph", GRAPH)
        return True

    def wp_cuda_graph_destroy(self, _context, graph):
        return self._graphs.pop(graph.value) is not None

    def wp_cuda_graph_exec_destroy(self, context, executable):
        return self.wp_cuda_graph_destroy(context, executable)

    # -----------------------------------------------------------------------------------------------------------------
    # modules and timing

    def wp_cuda_unload_module(self, _context, module):
        for hooks in module.kernel_hooks.values():
            hooks.forward.loaded = False

    def wp_cuda_timing_begin(self, kinds):
        self._work.timings, self._timed = [], kinds

    def wp_cuda_timing_get_result_count(self):
        return len(self._wanted())

    def wp_cuda_timing_end(self, results, _count):
        for place, (name, kind, spent) in zip(results or (), self._wanted(), strict=False):
            place.context, place.name, place.flag, place.elapsed = CONTEXT, name.encode(), kind, spent
        self._work.timings = None

    def _wanted(self) -> list[tuple[str, int, float]]:
        return [entry for entry in self._work.timings or () if entry[1] & self._timed]
