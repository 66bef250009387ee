"""Files of text that somebody else may have written: read whole, if they are plain files of a sensible length."""

from pathlib import Path

from warpsph.messages import files


def read(path: Path, form: str, most: int) -> str:
    """Read a file.

    Args:
        path: The file.
        form: What it should be, for the message.
        most: Longest length [bytes].

    Raises:
        InputError: If it is missing, a folder, a pipe or the like, too long, or not UTF-8.
    """
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise ValueError("it is no plain file")
        if size > most:
            raise ValueError(f"it has {size} bytes; allowed: {most}")
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise files.unreadable(path, form, error) from error
