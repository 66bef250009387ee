"""``python -m warpsph``: the command line."""

from .cli import main

main()
