"""What doctor prints that is no problem: who serves whom, and how long a hop takes."""

from actum.messages import HopTime, Status
from actum_command.doctor.diagnosis import who_serves
from actum_command.doctor.heard import Heard
from actum_command.doctor.stream_checks import hops


def test_a_line_says_who_serves_a_shared_sensor_and_who_stands_by() -> None:
    tokens, members = {"som_classifier": ["south"]}, {"som_classifier": ["south", "north"], "action_fusion": ["north"]}
    assert list(who_serves(Heard(tokens, [], {}, {}, members))) == [
        "several processes run action_fusion for this sensor, as intended: none of them yet serves the sensor; "
        "standing by: north",
        "several processes run som_classifier for this sensor, as intended: south serves the sensor; "
        "standing by: north",
    ]


def status(service: str, *hops: HopTime) -> Status:
    return Status(
        stamp_ns=1, sensor="kinect0", service=service, instance="a", uptime_s=1.0, rates={}, handled={}, drops={},
        rejects={}, last_error=None, latency_ms={}, state="running", hops=list(hops),
    )  # fmt: skip


def test_hops_are_those_of_the_last_minute_where_the_page_measures_them() -> None:
    reported = HopTime(cause="skeleton", effect="posture", count=1800, p50_ms=2.04, p99_ms=7.66)
    heard_here = HopTime(cause="skeleton", effect="posture", count=45, p50_ms=1.0, p99_ms=1.0)
    statuses = {"som_classifier": [status("som_classifier")], "web_dashboard": [status("web_dashboard", reported)]}
    assert list(hops(Heard({}, [], statuses, {}, hops=[heard_here]))) == [
        "latency from skeleton to posture: p50 2.0 ms, p99 7.7 ms (1800 messages in the last "
        "minute, measured by web_dashboard)"
    ]


def test_without_a_page_hops_are_those_that_doctor_has_heard_itself() -> None:
    heard_here = HopTime(cause="end mark", effect="event", count=3, p50_ms=61.0, p99_ms=90.4)
    assert list(hops(Heard({}, [], {"som_classifier": [status("som_classifier")]}, {}, hops=[heard_here]))) == [
        "latency from end mark to event: p50 61.0 ms, p99 90.4 ms (3 messages measured where doctor runs)"
    ]
