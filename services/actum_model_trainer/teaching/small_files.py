"""Reads the small files beside takes, models and jobs; anybody may have put something else in their place."""

from pathlib import Path

LARGEST_BYTES = 10_000_000
"""Largest such file (bytes): the result of a cross-validation of thousands of examples."""


def small_file(path: Path) -> bytes:
    """Return the content of a file.

    Raises:
        OSError: it is not there, is no file (reading a named pipe would never end), or cannot be read.
        ValueError: it is too large to be one of ours.
    """
    if path.exists() and not path.is_file():
        raise OSError(f"{path} is no file")
    with path.open("rb") as file:
        content = file.read(LARGEST_BYTES + 1)
    if len(content) > LARGEST_BYTES:
        raise ValueError(f"{path} has more than {LARGEST_BYTES} bytes")
    return content
