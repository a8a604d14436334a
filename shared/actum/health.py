"""A service's health as a file, for container health checks: `python -m actum.health`.

The check runs every few seconds beside each service, so it imports nothing that is slow to import.
"""

import logging
import os
import sys
import time
from pathlib import Path

log = logging.getLogger("actum")

FRESH_S = 5.0
"""How old (s) the health file of a healthy service may be: it is touched once a second."""


class HealthFile:
    """The health file of a running service or router, where one is set.

    That the file cannot be written is logged once, and writing is tried again each time.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._unwritable = False

    def write(self, healthy: bool) -> None:
        """Touch the file where this process works and has a router (`healthy`); remove it otherwise.

        Its time of modification is the monotonic clock's, which processes of one machine share: the wall clock may be
        set.
        """
        if self._path is None:
            return
        try:
            if healthy:
                self._path.open("ab").close()
                os.utime(self._path, ns=(time.monotonic_ns(), time.monotonic_ns()))
            else:
                self._path.unlink(missing_ok=True)
            self._unwritable = False
        except (OSError, ValueError) as error:  # ValueError: a path that no file can have
            if not self._unwritable:
                log.warning(
                    "the health file cannot be written (%s): set ACTUM_HEALTH_FILE to a file that this service can "
                    "write",
                    error,
                )
            self._unwritable = True


def is_healthy(path: Path) -> bool:
    """Tell whether the health file was touched within the last `FRESH_S`."""
    try:
        return 0 <= time.monotonic() - path.stat().st_mtime < FRESH_S
    except OSError:
        return False


if __name__ == "__main__":
    sys.exit(0 if is_healthy(Path(os.environ["ACTUM_HEALTH_FILE"])) else 1)
