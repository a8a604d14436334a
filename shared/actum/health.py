"""A service's health as a file, for container health checks: `python -m actum.health`.

The check runs every few seconds beside each service, so it imports nothing that is slow to import.
"""

import os
import sys
import time
from pathlib import Path

FRESH_S = 5.0
"""How old (s) the health file of a healthy service may be: it is touched once a second."""


def write_health(path: Path, healthy: bool) -> None:
    """Touch the health file of a service that works and has a router; remove that of any other.

    Its time of modification is the monotonic clock's, which processes of one machine share: the wall clock may be set.
    """
    if healthy:
        path.open("ab").close()
        os.utime(path, ns=(time.monotonic_ns(), time.monotonic_ns()))
    else:
        path.unlink(missing_ok=True)


def is_healthy(path: Path) -> bool:
    """Tell whether the health file was touched within the last `FRESH_S`."""
    try:
        return 0 <= time.monotonic() - path.stat().st_mtime < FRESH_S
    except OSError:
        return False


if __name__ == "__main__":
    sys.exit(0 if is_healthy(Path(os.environ["ACTUM_HEALTH_FILE"])) else 1)
