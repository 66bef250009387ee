"""How many cores of the machine this process may keep busy."""

import math
import os
from collections.abc import Iterator
from pathlib import Path

from warpsph.control_groups import SYSTEM, levels, text


def count_cores(root: Path = SYSTEM) -> int:
    """Give the number of cores: those that the process is bound to, or fewer where a container has less time than that.

    More threads than that would wait for each other's turn, and use up the time by waiting.
    """
    bound = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(min([bound, *map(math.ceil, _quotas(root))]), 1)


def _quotas(root: Path) -> Iterator[float]:
    """Seconds of all cores together that each control group has in a second."""
    for version, group in levels("cpu", root):
        if version == 2:
            words = text(group / "cpu.max").split()
        else:
            words = [text(group / f"cpu.cfs_{name}_us").strip() for name in ("quota", "period")]
        if len(words) == 2 and all(map(str.isdecimal, words)) and int(words[1]) > 0:
            yield int(words[0]) / int(words[1])
