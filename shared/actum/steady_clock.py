"""The time of day for stamps: read from the wall clock once, and carried on by the clock that nobody sets."""

import time

_BEGAN_NS = time.time_ns() - time.monotonic_ns()
"""The wall clock's lead (ns) over the monotonic clock when this process began."""


def now_ns() -> int:
    """Return the time since 1970 (ns), which never steps: where the wall clock is set later, this goes on as before."""
    return _BEGAN_NS + time.monotonic_ns()
