"""A process that ends when the one that started it is gone, however that ended; on any Unix."""

import os
import signal
import threading
import time

PARENT = "ACTUM_PARENT"
"""The variable that holds the process id of who started this process, where it is to end with them."""
LOOK_S = 0.5
"""Between two looks (s) at who the parent is."""
LEAVE_S = 5.0
"""How long leaving cleanly may take, as for any end."""


def end_with_parent() -> None:
    """End this process as SIGTERM would, once it has another parent than the one that `ACTUM_PARENT` names."""
    parent = os.environ.get(PARENT, "")
    if parent.isdecimal():
        threading.Thread(target=_watch, args=(int(parent),), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(LOOK_S)
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(LEAVE_S)
    os._exit(1)
