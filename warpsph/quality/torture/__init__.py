"""What a run survives, tried out: each file is one trial with figures for ``docs/reliability.md``.

``scripts/torture`` calls `warpsph.quality.torture.command`; the tests call the trials with ``quick``.
"""
