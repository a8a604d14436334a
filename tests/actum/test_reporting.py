import time

import pytest

from actum.codec import decode, encode
from actum.messages import HopTime
from actum.node import SECOND_NS, Counters
from actum.runtime.reporting import MOST_KEYS, MOST_ORIGINS, Meter, Reporter
from actum.runtime.subscribing import ANSWER_S
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings
from people import STANDING, skeleton
from scenes import action


def meter() -> Meter:
    return Meter("pose_preprocessor", Counters(), ServiceSettings())


def test_missing_numbers_are_drops_and_falling_ones_a_restart() -> None:
    watched = meter()
    for seq in (0, 1, 5, 6, 0, 1):
        watched.received("actum/kinect0/skeleton", skeleton(seq, STANDING, seq=seq))
    status = watched.status()
    assert status.handled == {"actum/kinect0/skeleton": 6}
    assert status.drops == {"actum/kinect0/skeleton": 3}


def test_several_who_put_on_one_key_number_their_own() -> None:
    watched = meter()
    for origin, seq in (("a", 900), ("b", 0), ("a", 901), ("b", 1), ("a", 903), ("b", 2)):
        watched.received("actum/kinect0/skeleton", skeleton(seq, STANDING, seq=seq), origin)
    assert watched.status().drops == {"actum/kinect0/skeleton": 1}


def test_of_origins_without_end_only_the_last_are_remembered() -> None:
    watched = meter()
    key, many = "actum/kinect0/skeleton", range(3 * MOST_ORIGINS)
    for origin in many:
        watched.received(key, skeleton(1, STANDING, seq=0), f"{origin}")
    for origin in (many[0], many[-1]):
        watched.received(key, skeleton(1, STANDING, seq=5), f"{origin}")
    assert watched.status().drops == {key: 4}


def test_agents_without_end_do_not_fill_the_status() -> None:
    watched = meter()
    for agent in range(3 * MOST_KEYS):
        watched.received("actum/kinect0/skeleton", skeleton(agent, STANDING, seq=agent))
        watched.count(f"actum/kinect0/posture/{agent}")
    status = watched.status()
    assert len(status.handled) == MOST_KEYS
    assert status.handled["actum/kinect0/skeleton"] == 3 * MOST_KEYS, "what goes on is kept"


def test_latencies_are_reported_as_percentiles() -> None:
    watched = meter()
    for milliseconds in range(101):
        watched.took(float(milliseconds))
    assert watched.status().latency_ms == {"p50": 50.0, "p99": 99.0}


def test_the_times_between_messages_that_a_node_measures_are_in_its_status() -> None:
    counters = Counters(hops=[HopTime(cause="skeleton", effect="posture", count=1, p50_ms=2.0, p99_ms=2.0)])
    frame = encode(Meter("web_dashboard", counters, ServiceSettings()).status())
    assert decode(frame.key, frame.payload, frame.encoding).hops == counters.hops


@pytest.mark.parametrize("late_s", [0.0, 2 * ANSWER_S], ids=["at once", "after a publisher that does not answer"])
def test_gaps_between_final_actions_of_before_are_no_losses(late_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Publishers keep the final ones alone, and partial ones have numbers between them.

    A service that goes on where another ended asks twice: for what is answered, and for what is not.
    """
    watched = meter()
    key = "actum/kinect0/action/1"
    watched.await_history()
    came_ns = time.monotonic_ns() + round(late_s * SECOND_NS)
    monkeypatch.setattr(time, "monotonic_ns", lambda: came_ns)
    for seq in (10, 70, 130):
        watched.received(key, action("push", seq=seq), "one")
    assert watched.status().drops == {}


def test_a_state_that_quotes_what_somebody_wrote_leaves_the_status_readable(caplog: pytest.LogCaptureFixture) -> None:
    counters = Counters(state="settings name actions that the model does not know: " + "x" * 300_000)
    quoting = Meter("som_classifier", counters, ServiceSettings())
    status = encode(quoting.status())
    assert decode(status.key, status.payload, status.encoding)
    Reporter(quoting, counters, ServiceSettings(), Turns()).log_state()
    assert len(caplog.text) < 1000
