"""A node's subscriptions return what was put before, and end quietly, whatever their threads are doing."""

import threading

import pytest
import zenoh

from actum import keys
from actum.codec import decode
from actum.messages import Posture
from actum.runtime.inbox import MOST_IN_A_TURN, RESUMED_FRAMES_S, RESUMED_S, Inbox, Reach
from actum.runtime.outbox import Outbox
from actum.runtime.subscribing import ANSWER_S
from live import wait_until
from people import postures

FRAMES = postures(0.0, 10.0)
REACH = Reach(RESUMED_S, RESUMED_S, RESUMED_FRAMES_S, depth=None)
"""How far back a service reaches that goes on where another one ended."""


@pytest.fixture
def session() -> zenoh.Session:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    return zenoh.open(config)


def started(session: zenoh.Session, received: list[Posture]) -> Inbox:
    """An inbox of postures."""

    def receive(sample: zenoh.Sample) -> None:
        message = decode(str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding))
        assert isinstance(message, Posture)
        received.append(message)

    inbox = Inbox(session, (keys.POSTURE,), "kinect0", REACH)
    inbox.start(receive)
    return inbox


class CountedTurns:
    """Turns that begin once they may; counts what is received in each."""

    def __init__(self) -> None:
        self.may_begin, self.received = threading.Event(), list[int]()

    def __enter__(self) -> None:
        assert self.may_begin.wait(10)
        self.received.append(0)

    def __exit__(self, *_: object) -> None:
        pass

    def receive(self, _sample: zenoh.Sample) -> None:
        self.received[-1] += 1


def test_what_has_come_together_is_handed_on_in_one_turn_but_others_get_theirs(session: zenoh.Session) -> None:
    inbox, turns = Inbox(session, (keys.STATUS,), "kinect0", Reach.unknown(0.0)), CountedTurns()
    inbox.start(turns.receive, turns)
    for _ in range(MOST_IN_A_TURN + 3):
        session.put(keys.key(keys.STATUS, "kinect0", "anybody"), b"")
    turns.may_begin.set()
    wait_until(lambda: sum(turns.received) == MOST_IN_A_TURN + 3, "all are received")
    inbox.close()
    session.close()
    assert turns.received == [MOST_IN_A_TURN, 3]


def test_what_comes_in_the_pause_of_a_topic_is_handed_on_after_it(session: zenoh.Session) -> None:
    inbox, received = Inbox(session, (keys.STATUS,), "kinect0", Reach.unknown(0.0)), list[zenoh.Sample]()
    pausing, is_over = threading.Event(), threading.Event()

    def pause() -> None:
        pausing.set()
        assert is_over.wait(10)

    inbox.start(received.append, pauses={keys.STATUS: pause})
    session.put(keys.key(keys.STATUS, "kinect0", "anybody"), b"")
    assert pausing.wait(10)
    for _ in range(3):
        session.put(keys.key(keys.STATUS, "kinect0", "anybody"), b"")
    assert len(received) == 1
    is_over.set()
    wait_until(lambda: len(received) == 4, "those that came in the pause are received")
    inbox.close()
    session.close()


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


def test_a_subscription_that_is_closed_while_the_past_is_awaited_ends_without_an_error(
    session: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    errors: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", errors.append)
    held = list[zenoh.Query]()
    silent = session.declare_queryable(f"{keys.pattern(keys.POSTURE, 'kinect0')}/@adv/**", held.append)
    inbox = started(session, [])
    wait_until(lambda: bool(held), "the past is requested")
    for subscriber in inbox._subscribers:
        subscriber.undeclare()
    for thread in inbox._threads:
        thread.join(ANSWER_S / 2)
    assert not inbox.working, "nobody has answered, and its thread still waits"
    held.clear()
    silent.undeclare()
    session.close()
    assert errors == []


def test_a_subscription_that_is_closed_in_the_middle_of_the_past_passes_on_no_more_of_it(
    session: zenoh.Session,
) -> None:
    """The node has ended then: a process that shares its sensor may answer in its place, and its journal is closed."""
    outbox, received = Outbox(session), list[zenoh.Sample]()
    for frame in FRAMES[:5]:
        outbox.put(frame)
    inbox = Inbox(session, (keys.POSTURE,), "kinect0", REACH)

    def close_at_first(sample: zenoh.Sample) -> None:
        received.append(sample)
        for subscriber in inbox._subscribers:
            subscriber.undeclare()

    inbox.start(close_at_first)
    wait_until(lambda: not inbox.working, "its thread has ended")
    session.close()
    assert len(received) == 1


def test_what_was_put_before_is_received_though_more_is_put_while_it_is_requested(session: zenoh.Session) -> None:
    """Zenoh's own subscriber, asked for the past, would drop it: it has a reply to its second request only later."""
    first, second = list[zenoh.Query](), list[zenoh.Query]()
    key = keys.key(keys.POSTURE, "kinect0", 1)

    def reply_late(query: zenoh.Query) -> None:
        if "/pub/" in str(query.key_expr):
            second.append(query)
            first.clear()
        elif not second:
            first.append(query)

    slow = session.declare_queryable(f"{key}/@adv/**", reply_late)
    outbox, received = Outbox(session), list[Posture]()
    before, after = FRAMES[:5], iter(FRAMES[5:])
    for frame in before:
        outbox.put(frame)
    inbox = started(session, received)
    wait_until(lambda: bool(second), "Zenoh has requested the past of the publisher that it has found")

    def put_more() -> bool:
        outbox.put(next(after))
        return any(frame.stamp_ns > before[-1].stamp_ns for frame in received)

    wait_until(put_more, "a frame has come that was put after the requests")
    second.clear()
    last = next(after)
    outbox.put(last)
    wait_until(lambda: received[-1].stamp_ns == last.stamp_ns, "the last frame has come")
    inbox.close()
    slow.undeclare()
    session.close()
    assert [frame.stamp_ns for frame in received] == [frame.stamp_ns for frame in FRAMES[: len(received)]]


def test_what_is_put_while_the_past_is_requested_is_received_as_well(session: zenoh.Session) -> None:
    """Zenoh's own subscriber holds it back, and drops it once something that was put later has come."""
    of_all, of_publisher = list[zenoh.Query](), list[zenoh.Query]()
    key = keys.key(keys.POSTURE, "kinect0", 1)

    def reply_late(query: zenoh.Query) -> None:
        if "/pub/" in str(query.key_expr):
            of_publisher.append(query)
        elif str(query.key_expr) != f"{key}/@adv/**":
            of_all.append(query)

    slow = session.declare_queryable(f"{keys.pattern(keys.POSTURE, 'kinect0')}/@adv/**", reply_late)
    outbox, received, frames = Outbox(session), list[Posture](), iter(FRAMES)
    outbox.put(next(frames))
    inbox = started(session, received)
    wait_until(lambda: bool(of_publisher) and len(of_all) == 2, "Zenoh and the inbox have requested the past")
    outbox.put(next(frames))
    of_all.clear()

    def put_more() -> bool:
        outbox.put(next(frames))
        return len(received) > 1

    wait_until(put_more, "a frame has come that was put after the requests")
    of_publisher.clear()
    inbox.close()
    slow.undeclare()
    session.close()
    assert [frame.stamp_ns for frame in received] == [frame.stamp_ns for frame in FRAMES[: len(received)]]


def test_what_several_people_did_before_is_received_in_the_order_in_which_it_was_put(session: zenoh.Session) -> None:
    outbox, received = Outbox(session), list[Posture]()
    frames = [frame.model_copy(update={"agent": agent}) for frame in FRAMES[:5] for agent in (2, 1, 3)]
    for frame in frames:
        outbox.put(frame)
    inbox = started(session, received)
    wait_until(lambda: len(received) == len(frames), "all frames have come")
    inbox.close()
    session.close()
    assert [(frame.stamp_ns, frame.agent) for frame in received] == [(frame.stamp_ns, frame.agent) for frame in frames]
