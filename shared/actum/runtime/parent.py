"""Ends this process when its parent process is gone, however that ended; on any Unix."""

import os
import signal
import threading
import time

PARENT = "ACTUM_PARENT"
"""The environment variable with the id of the parent process that this one is to end with."""
LOOK_S = 0.5
"""Interval (s) at which the parent is checked."""
LEAVE_S = 5.0
"""How long (s) a clean end may take after SIGTERM; then the process is ended at once."""


def end_with_parent() -> None:
    """Send this process SIGTERM once its parent is not the one that `ACTUM_PARENT` names, if that is set."""
    parent = os.environ.get(PARENT, "")
    if parent.isdecimal():
        threading.Thread(target=_watch, args=(int(parent),), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(LOOK_S)
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(LEAVE_S)
    os._exit(1)
