"""What a service needs beside the library, and what to do where it is missing."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from actum.runtime.serving import UNUSABLE


@contextmanager
def needs_extra(name: str) -> Iterator[None]:
    """Import within this what the extra `name` brings: where it is missing, the process ends with a line, code 2.

    Raises:
        ModuleNotFoundError: a part of a package that is there is not, which is a bug.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if "." in (error.name or "."):
            raise
        print(f"{error.name} is not installed: pip install 'actum[{name}]'", file=sys.stderr)
        sys.exit(UNUSABLE)
