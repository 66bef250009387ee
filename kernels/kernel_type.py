"""What a particle's sums run over: its present neighbours, those it had at the start, or none (method section 5)."""

EULERIAN, LAGRANGIAN, ERODED = 0, 1, 2
"""Kernel in the current configuration; in the reference configuration (Total Lagrangian); in no list any more."""
