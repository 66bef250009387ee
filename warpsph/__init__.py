"""warpsph: smoothed particle hydrodynamics of solids hitting solids fast, on NVIDIA Warp kernels."""

import importlib.util

__version__ = "0.1.0"

if importlib.util.find_spec("warpsph.kernels") is None:
    raise ImportError("warpsph.kernels is missing: install the source tree first, with `pip install -e .`")
