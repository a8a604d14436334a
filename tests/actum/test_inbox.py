"""A node's subscriptions end quietly, whatever their threads are doing."""

import threading

import pytest
import zenoh

from actum import keys
from actum.runtime.inbox import Inbox, Reach


@pytest.fixture
def session() -> zenoh.Session:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def test_a_subscription_that_is_closed_while_its_message_is_handled_ends_without_an_error(
    session: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    errors: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", errors.append)
    inbox, handled = Inbox(session, (keys.STATUS,), "kinect0", Reach.unknown(0.0)), threading.Event()

    def close_meanwhile(_sample: zenoh.Sample) -> None:
        for subscriber in inbox._subscribers:
            subscriber.undeclare()
        handled.set()

    inbox.start(close_meanwhile)
    session.put(keys.key(keys.STATUS, "kinect0", "anybody"), b"")
    assert handled.wait(10)
    for thread in inbox._threads:
        thread.join(10)
    assert not inbox.working
    assert errors == []
    session.close()
