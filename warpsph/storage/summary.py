"""The summary of a run: ``summary.json``."""

import json
from pathlib import Path
from typing import Any

from . import atomic

NAME = "summary.json"
"""The file in the output folder."""


def write(out: Path, summary: dict[str, Any]) -> None:
    """Write the summary of a run in place of an older one.

    Raises:
        RunError: If it cannot be written.
    """
    atomic.write(Path(out) / NAME, json.dumps(summary, indent=2, default=str).encode())
