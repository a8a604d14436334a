"""The one runtime: everything that knows Zenoh, clocks, signals and threads."""

from actum.runtime.bridging import run_bridge
from actum.runtime.client import Answer, Client, NotAnsweredError
from actum.runtime.extras import needs_extra
from actum.runtime.fronting import Front, run_front
from actum.runtime.listening import Listening, Received
from actum.runtime.obstacles import obstacle
from actum.runtime.parent import end_with_parent
from actum.runtime.router import serve_router
from actum.runtime.serving import run, run_source
from actum.runtime.session import RouterUnreachableError
from actum.runtime.waiting import Pace, stop_on_signals

__all__ = [
    "Answer",
    "Client",
    "Front",
    "Listening",
    "NotAnsweredError",
    "Pace",
    "Received",
    "RouterUnreachableError",
    "end_with_parent",
    "needs_extra",
    "obstacle",
    "run",
    "run_bridge",
    "run_front",
    "run_source",
    "serve_router",
    "stop_on_signals",
]
