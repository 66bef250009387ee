"""Runs that cannot go on, and runs that were ended: the particle, the cause, what goes on from there."""
