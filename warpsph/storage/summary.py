"""The summary of a run: ``summary.json``."""

import json
from pathlib import Path
from typing import Any

from warpsph.messages import files

from . import atomic, text

NAME = "summary.json"
"""The file in the output folder."""

LONGEST = 2**24
"""Longest summary that is read [bytes]."""

DEEPEST = 50
"""How deep entries of a summary may be in each other."""


def write(out: Path, summary: dict[str, Any]) -> None:
    """Write the summary of a run in place of an older one.

    Raises:
        DiskError: If it cannot be written.
    """
    atomic.write(Path(out) / NAME, json.dumps(summary, indent=2, default=str).encode())


def read(path: Path) -> dict[str, Any]:
    """Read the summary of a run; it has a list of ``warnings``, if nothing else.

    Raises:
        InputError: If it cannot be read as one.
    """
    content = text.read(path, "summary", LONGEST)
    try:
        summary = json.loads(content)
        if _depth(summary) > DEEPEST:
            raise RecursionError
    except (ValueError, RecursionError) as error:
        reason = f"({error})" if isinstance(error, ValueError) else f"(nested more than {DEEPEST} deep)"
        raise files.no_summary(path, f"cannot be read as a summary {reason}") from None
    if not isinstance(summary, dict) or not isinstance(summary.get("warnings", []), list):
        raise files.no_summary(path, "is no summary: no JSON object with a list of warnings")
    return {"warnings": []} | summary


def _depth(value: Any) -> int:
    """How deep objects and lists are in each other."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return 1 + max(map(_depth, inner), default=0)
