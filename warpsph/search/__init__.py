"""Neighbour search: particles in cells, rows of those in reach, now and in the reference configuration."""
