"""Runs that cannot go on, and runs that were ended: the particle, the cause, what goes on from there."""


def left_range(steps: int) -> str:
    """What may be behind a state that is not finite: the equation of state has had no answer to it before."""
    return f"; its equation of state had left its range in {steps} steps: a pressure_cutoff bounds the tension of a material"
