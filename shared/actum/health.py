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
    """Touch the health file of a service that works and has a router; remove that of any other."""
    if healthy:
        path.touch()
    else:
        path.unlink(missing_ok=True)


def is_healthy(path: Path) -> bool:
    """Tell whether the health file was touched within the last `FRESH_S`."""
    try:
        return time.time() - path.stat().st_mtime < FRESH_S
    except OSError:
        return False


if __name__ == "__main__":
    sys.exit(0 if is_healthy(Path(os.environ["ACTUM_HEALTH_FILE"])) else 1)
