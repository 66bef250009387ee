"""The two ways a run can go wrong: bad input, and a state that cannot go on."""


class InputError(ValueError):
    """Bad input: one line that names the field, the value and what is allowed. Exit code 2."""


class RunError(RuntimeError):
    """A run that had to stop (non-finite state, collapsing time step, full disk). Exit code 3.

    The message is one line; for a particle it names id, body, material, position and cause.
    """
