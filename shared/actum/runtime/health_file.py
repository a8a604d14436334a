"""The health file of a running service or router, where one is set."""

import logging
from pathlib import Path

from actum.health import write_health

log = logging.getLogger("actum")


class HealthFile:
    """Says once that it cannot be written, and is tried again each time."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._unwritable = False

    def write(self, healthy: bool) -> None:
        """Touch the file of what works, and remove that of any other."""
        if self._path is None:
            return
        try:
            write_health(self._path, healthy)
            self._unwritable = False
        except (OSError, ValueError) as error:  # ValueError: a path that no file can have
            if not self._unwritable:
                log.warning("the health file cannot be written: %s", error)
            self._unwritable = True
