"""The optional dependencies of services (pip's extras), and how a process ends that lacks one."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from actum.installing import adding
from actum.runtime.serving import UNUSABLE


@contextmanager
def needs_extra(name: str) -> Iterator[None]:
    """Return a context in which to import the packages of an extra: if one is missing, say so and exit with code 2.

    Raises:
        ModuleNotFoundError: a submodule of an installed package is missing, which is a bug.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if "." in (error.name or "."):
            raise
        print(f"{error.name} is not installed: {adding(name)}", file=sys.stderr)
        sys.exit(UNUSABLE)
