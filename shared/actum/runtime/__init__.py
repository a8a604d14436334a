"""The one runtime: everything that knows Zenoh, clocks, signals and threads."""

from actum.runtime.bridging import run_bridge
from actum.runtime.client import Answer, Client, NotAnsweredError
from actum.runtime.inbox import Listening, Received
from actum.runtime.obstacles import obstacle
from actum.runtime.router import serve_router
from actum.runtime.serving import needs_extra, run, run_front, run_source
from actum.runtime.session import RouterUnreachableError
from actum.runtime.stopping import Pace, end_with_parent, stop_on_signals

__all__ = [
    "Answer",
    "Client",
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
