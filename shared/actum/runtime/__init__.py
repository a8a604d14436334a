"""The one runtime: everything that knows Zenoh, clocks, signals and threads."""

from actum.runtime.client import Client, Listening, Received
from actum.runtime.extras import needs_extra
from actum.runtime.parent import end_with_parent
from actum.runtime.router import serve_router
from actum.runtime.serving import Pace, run, run_source, stop_on_signals
from actum.runtime.session import RouterUnreachableError

__all__ = [
    "Client",
    "Listening",
    "Pace",
    "Received",
    "RouterUnreachableError",
    "end_with_parent",
    "needs_extra",
    "run",
    "run_source",
    "serve_router",
    "stop_on_signals",
]
