"""Values from a user that are not allowed: the field, the value, what is allowed."""

from collections.abc import Iterable

from warpsph.errors import InputError

LONGEST = 80
"""Characters of a value that are shown."""


def refuse(name: str, value: object, allowed: str) -> InputError:
    """A value is not allowed: names it, shows it, says what is allowed."""
    return InputError(f"{name} = {shown(value)} is not allowed; allowed: {allowed}")


def unknown(name: str, value: object, allowed: Iterable[object]) -> InputError:
    """A name is none of those that there are."""
    return InputError(f"{name} {shown(value)} is unknown; allowed: {', '.join(map(str, allowed))}")


def shown(value: object) -> str:
    """A value as it is shown: as Python writes it, cut where it is long."""
    text = repr(value.tolist() if hasattr(value, "tolist") else value)  # numpy's as plain numbers
    return text if len(text) < LONGEST else text[: LONGEST - 4] + " ..."


def printable(text: str) -> str:
    """A text from a file as it may be printed: what would move the cursor or hide something is written out."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
