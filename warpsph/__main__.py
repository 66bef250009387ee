"""``python -m warpsph``, and the command ``warpsph``: the command line, which takes signals before it is loaded."""

import sys

from .errors import Ended
from .running import streams
from .running.signals import listening


def main() -> None:
    """Run the command line."""
    streams.fill()  # before any file is opened
    try:
        with listening(final=True):
            from .cli import main

            main()
    except Ended as ended:  # while it was being loaded
        print(f"warpsph: {ended}", file=sys.stderr)
        sys.exit(ended.code)


if __name__ == "__main__":
    main()
