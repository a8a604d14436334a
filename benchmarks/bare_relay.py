"""A bare Zenoh hop: takes whatever comes on one key and puts as many bytes as told on the next.

    python benchmarks/bare_relay.py IN OUT BYTES

The yardstick for a service: the same transport, ring, thread and quality of service, and nothing done in between.
"""

import sys
import threading

import zenoh

from actum.runtime.session import open_session
from actum.runtime.stopping import stop_on_signals, wait_for
from actum.settings import ServiceSettings


def main() -> None:
    """Relay until SIGTERM."""
    incoming, outgoing, size = sys.argv[1], sys.argv[2], int(sys.argv[3])
    stop = stop_on_signals()
    session = open_session(ServiceSettings(), stop)
    assert session is not None
    payload = bytes(size)
    publisher = session.declare_publisher(outgoing, priority=zenoh.Priority.DATA_HIGH, express=True)
    subscriber = session.declare_subscriber(incoming, zenoh.handlers.RingChannel(256))

    def relay() -> None:
        for sample in subscriber:
            publisher.put(payload, attachment=sample.attachment)

    threading.Thread(target=relay, daemon=True).start()
    wait_for(stop)
    session.close()


if __name__ == "__main__":
    main()
