"""A stand-in for a CUDA device, for machines without one: Warp then believes that there is a ``cuda:0``.

It is no GPU and says nothing about one's speed or arithmetic: its kernels are the CPU's. It shows whether the host's
side of a run is right, and is as strict there as CUDA is, or more so:

- What it is told to do waits until the host synchronises: who reads too early, reads what was there before.
- The host cannot touch its memory: it faults. So does a kernel beyond the end of an array, and whoever uses one that is
  gone. Fresh memory holds no zeros but nonsense.
- A graph records launches, fills and copies, and does nothing until it is launched. What CUDA refuses meanwhile is
  refused: to wait, to read, to use the default stream; and also what it is better to do without: to allocate, to load
  code.
- Threads of a kernel run in another order than on a CPU.

``PYTHONPATH=$PWD/tests/stand_in pytest -m gpu`` runs the tests that need a GPU on it.
"""

from .install import install

__all__ = ["install"]
