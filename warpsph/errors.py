"""The ways a run can go wrong: bad input, a state that cannot go on, a disk that takes no more."""


class InputError(ValueError):
    """Bad input: one line that names the field, the value and what is allowed. Exit code 2."""


class RunError(RuntimeError):
    """A run that had to stop (non-finite state, collapsing time step). Exit code 3.

    The message is one line; for a particle it names id, body, material, position and cause.
    """


class DiskError(RunError):
    """Output that could not be written: a full disk or quota, a folder that has vanished. Exit code 4.

    The message names the file and the cause; everything written before stays readable.
    """


class Ended(KeyboardInterrupt):
    """What was going on has been ended in good order: by SIGINT (Ctrl-C), SIGTERM, or because the wall time was up.

    Like any `KeyboardInterrupt` it passes by ``except Exception``: whoever asked for the end meant the whole program.
    The message is one line; for a run it says what goes on from there.

    Attributes:
        code: Exit code of the command line: 130, 143 or 5.
    """

    def __init__(self, message: str, code: int):
        super().__init__(message)
        self.code = code
