"""The machine's processor."""

import platform
from pathlib import Path


def processor() -> str:
    """Name of the processor, as its maker calls it where the system tells."""
    table = Path("/proc/cpuinfo")
    if table.is_file():
        lines = table.read_text(errors="replace").splitlines()
        models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
        if models:
            return models[0]
    return platform.processor() or platform.machine()
