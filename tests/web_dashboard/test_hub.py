"""What waits for a browser: the newest of each stream, and all of what must not be lost, up to a bound."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed

from actum.node import Tick
from dashboards import Colleague, heard, served
from live import wait_until
from web_dashboard.hub import LONGEST_QUEUE, MOST_KEPT, MOST_STREAMS, REMEMBERED, Envelope, Hub, Mailbox


def mailbox() -> Mailbox:
    return Mailbox(lambda: None)


@given(numbers=st.lists(st.tuples(st.sampled_from("abc"), st.integers()), max_size=50))
def test_of_each_stream_the_newest_waits(numbers: list[tuple[str, int]]) -> None:
    box = mailbox()
    for stream, number in numbers:
        box.put([Envelope(stream, f"{stream}{number}")])
    assert sorted(box.empty()) == sorted(f"{stream}{number}" for stream, number in dict(numbers).items())
    assert box.empty() == []


@given(count=st.integers(0, 30))
def test_what_is_queued_comes_in_order_and_before_the_streams(count: int) -> None:
    box = mailbox()
    box.put([Envelope("skeleton", "newest")])
    box.put(Envelope("event/1", str(number), queued=True) for number in range(count))
    assert box.empty() == [*map(str, range(count)), "newest"]


def test_the_oldest_of_a_queue_that_is_too_long_are_left_out_and_counted() -> None:
    hub, box = Hub(), mailbox()
    hub.join(box)
    for number in range(LONGEST_QUEUE + 5):
        hub.publish(Envelope("event/1", str(number), queued=True))
    assert hub.left_out == 5
    assert box.empty() == [str(number) for number in range(5, LONGEST_QUEUE + 5)]
    hub.leave(box)
    assert hub.left_out == 5


def test_streams_without_end_take_no_memory_without_end() -> None:
    hub, box = Hub(), mailbox()
    hub.join(box)
    for number in range(MOST_STREAMS + 50):
        hub.publish(Envelope(f"status/{number}", str(number), kept=True))
    assert len(box.empty()) == MOST_STREAMS
    assert len(hub.silent_s()) == MOST_KEPT


def test_a_browser_is_woken_once_until_it_has_taken_what_waits() -> None:
    woken = []
    box = Mailbox(lambda: woken.append(1))
    for _ in range(3):
        box.put([Envelope("skeleton", "x")])
    assert len(woken) == 1
    box.empty()
    box.put([Envelope("skeleton", "x")])
    assert len(woken) == 2


def test_who_comes_later_gets_the_last_answers_and_each_services_status_but_no_old_frame() -> None:
    hub = Hub()
    for number in range(REMEMBERED + 3):
        hub.publish(Envelope("event/1", f"event {number}", queued=True))
    hub.publish(Envelope("status/x", "old", kept=True))
    hub.publish(Envelope("status/x", "new", kept=True))
    hub.publish(Envelope("skeleton", "frame"))
    box = mailbox()
    hub.join(box)
    assert box.empty() == [*(f"event {number}" for number in range(3, REMEMBERED + 3)), "new"]


def test_a_stalled_browser_does_not_keep_what_others_get() -> None:
    hub, stalled, reading = Hub(), mailbox(), mailbox()
    hub.join(stalled)
    hub.join(reading)
    read = []
    for number in range(10_000):
        hub.publish(Envelope("skeleton", str(number)))
        read += reading.empty()
    assert read == list(map(str, range(10_000)))
    assert stalled.empty() == ["9999"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_bug_in_what_tells_pages_how_services_are_ends_the_server(monkeypatch: pytest.MonkeyPatch) -> None:
    with served(Colleague(lambda *_: {})) as page:
        monkeypatch.setattr(page.node._hub, "silent_s", [].pop)
        wait_until(lambda: not page.node.working, "the server has ended", 5.0)
        with pytest.raises(RuntimeError, match="the web server of the page stopped unexpectedly"):
            page.node.handle(Tick(0))


def test_a_bug_in_what_sends_to_a_browser_ends_its_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    with served(Colleague(lambda *_: {})) as page, page.browser() as browser:
        heard(browser, "pulse")
        monkeypatch.setattr(Mailbox, "empty", [].pop)
        with pytest.raises(ConnectionClosed):
            heard(browser, "never", patience_s=5.0)
        assert page.node.working
