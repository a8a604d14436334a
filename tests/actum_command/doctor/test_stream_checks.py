"""What `actum doctor` says of streams, clocks and access control, told from what it has heard."""

from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum import keys
from actum.keys import Topic
from actum.messages import Info, Message, Status
from actum.node import SECOND_NS
from actum.runtime import Answer
from actum_command.doctor import stream_checks
from actum_command.doctor.diagnosis import (
    clock_offset,
    clock_offsets,
    clock_remarks,
    everything_denied,
    partly_denied,
)
from actum_command.doctor.heard import Heard, Watched
from empty_messages import image
from people import STANDING, skeleton

SKELETON, POSTURES = "actum/kinect0/skeleton", ("actum/kinect0/posture/1", "actum/kinect0/posture/2")
GATEWAY, PREPROCESSOR, CLASSIFIER = "sensor_gateway", "pose_preprocessor", "som_classifier"


def statuses(service: str, rates_hz: Mapping[str, float], seconds: float = 2.0, state: str = "running") -> list[Status]:
    """Two reports of a service that has handled so many messages a second between them."""
    return [
        Status(
            stamp_ns=1, sensor="kinect0", service=service, instance="a", uptime_s=10 + after_s, rates={}, drops={},
            handled={key: 1000 + round(rate * after_s) for key, rate in rates_hz.items()}, rejects={}, last_error=None,
            latency_ms={}, state=state,
        )
        for after_s in (0.0, seconds)
    ]  # fmt: skip


def info(service: str, stamp_ns: int = 1, host: str = "lab", rate_hz: float | None = None) -> Info:
    return Info(
        stamp_ns=stamp_ns, sensor="kinect0", service=service, instance=f"{service}-1", host=host, version="1",
        schemas=[], joint_names=[], rate_hz=rate_hz,
    )  # fmt: skip


def watched(messages: Sequence[Message], apart_s: float = 1 / 30) -> Watched:
    stream = Watched()
    for number, message in enumerate(messages):
        stream.receive(message, round(number * apart_s * SECOND_NS))
    return stream


def people(count: int, rate_hz: float = 30.0, moving: bool = True) -> list[Message]:
    return [
        skeleton(round(i * SECOND_NS / rate_hz), STANDING + (0.001 * i if moving else 0.0), seq=i) for i in range(count)
    ]


def said(
    reported: Sequence[list[Status]] = (), infos: Sequence[Info] = (), streams: Mapping[Topic, Watched] | None = None
) -> list[str]:
    by_service = {each[0].service: each for each in reported}
    nothing = {topic: Watched() for topic in (keys.SKELETON, keys.COLOR, keys.POSTURE, keys.OBJECTS)}
    return list(stream_checks.problems(infos, by_service, nothing | dict(streams or {})))


def test_streams_that_flow_are_no_problem() -> None:
    flowing = [statuses(GATEWAY, {SKELETON: 30.0}), statuses(PREPROCESSOR, {SKELETON: 30.0})]
    assert said(flowing, [info(GATEWAY, rate_hz=30.0)], {keys.SKELETON: watched(people(75))}) == []


@pytest.mark.parametrize(("put_hz", "told"), [(12.0, True), (17.5, True), (18.5, False), (29.0, False), (0.0, False)])
def test_a_source_that_gives_fewer_frames_than_it_is_set_to(put_hz: float, told: bool) -> None:
    found = said([statuses(GATEWAY, {SKELETON: put_hz}, state="camera lost: x")], [info(GATEWAY, rate_hz=30.0)])
    assert [f"publishes {put_hz:.0f} frames per second, but its source is set to 30" in line for line in found] == [
        True
    ] * told


def test_skeletons_that_come_slower_than_they_are_stamped() -> None:
    [line] = said(streams={keys.SKELETON: watched(people(30), apart_s=1 / 12)})
    assert line.startswith("12 skeletons arrive per second, but their time stamps show that the sensor captured 30")


def test_images_that_have_stopped() -> None:
    image_key = "actum/kinect0/image/color"
    [line] = said([statuses(GATEWAY, {SKELETON: 30.0, image_key: 0.0})], streams={keys.SKELETON: watched(people(75))})
    assert line == "sensor_gateway stopped publishing image/color after 1000 messages: restart sensor_gateway"
    assert said([statuses(GATEWAY, {image_key: 0.0}, state="source ended")]) == []


def test_a_frozen_camera() -> None:
    assert said(streams={keys.SKELETON: watched(people(60, moving=False))})[0].startswith("all skeletons are identical")
    [line] = said(streams={keys.COLOR: watched([image(i * SECOND_NS // 30) for i in range(60)])})
    assert line.startswith("all images are identical, so the camera is frozen")


def test_stamps_that_stand_still() -> None:
    [line] = said(streams={keys.SKELETON: watched([skeleton(7, STANDING + 0.001 * i) for i in range(60)])})
    assert line.startswith("the time stamps of the skeletons do not increase")


def test_an_empty_room_is_not_frozen() -> None:
    empty = [skeleton(i * SECOND_NS // 30).model_copy(update={"agents": []}) for i in range(60)]
    assert said(streams={keys.SKELETON: watched(empty)}) == []


@pytest.mark.parametrize(
    ("got_hz", "words"),
    [(0.0, "receives none of the 30"), (12.0, "receives only 12 of the 30"), (25.0, None), (30.0, None)],
)
def test_a_reader_that_gets_fewer_than_are_put(got_hz: float, words: str | None) -> None:
    found = said([statuses(GATEWAY, {SKELETON: 30.0}), statuses(PREPROCESSOR, {SKELETON: got_hz})])
    part = f"{PREPROCESSOR} {words} messages per second on the topic skeleton"
    assert [part in line for line in found] == [True] * bool(words)


def test_people_are_counted_together() -> None:
    got = statuses(CLASSIFIER, dict.fromkeys(POSTURES, 15.0))
    assert stream_checks.handled_hz(got, keys.POSTURE) == 30.0
    assert stream_checks.handled_hz(got[:1], keys.POSTURE) is None


@given(ahead_s=st.floats(-1e4, 1e4), there_s=st.floats(0, 1), back_s=st.floats(0, 1), asked_s=st.floats(0, 1e6))
def test_a_clocks_offset_lies_within_its_uncertainty(
    ahead_s: float, there_s: float, back_s: float, asked_s: float
) -> None:
    """However long the question and the answer take."""
    wall_s = 1.7e9
    stamp_ns = round((wall_s + there_s + ahead_s) * SECOND_NS)
    answered_ns = round((asked_s + there_s + back_s) * SECOND_NS)
    came_ns = round((wall_s + there_s + back_s) * SECOND_NS)
    found = clock_offset(Answer(info("a", stamp_ns), round(asked_s * SECOND_NS), answered_ns, came_ns))
    assert abs(found.ahead_s - ahead_s) <= found.uncertainty_s + 1e-5


def answer(host: str, ahead_s: float, took_s: float) -> Answer:
    took_ns = round(took_s * SECOND_NS)
    return Answer(info(host, 10**18 + round(ahead_s * SECOND_NS), host), 0, took_ns, 10**18 + took_ns // 2)


def test_the_fastest_answer_counts_and_hosts_that_agree_share_a_line() -> None:
    found = clock_offsets(
        [answer("far", 5.3, 0.8), answer("far", 5.0, 0.002), answer("beside", 5.01, 0.002), answer("here", 0.01, 0.002)]
    )
    assert found["far"].ahead_s == pytest.approx(5.0) and found["far"].uncertainty_s == pytest.approx(0.001)
    [line] = clock_remarks(found)
    assert line.startswith("the clock of beside, far is 5.0")
    assert "s (± 0.001 s) ahead of the clock of this host. Recognition is not affected" in line


class Router:
    """What a router tells a program that asks."""

    def __init__(self, offered: bool, tells: bool) -> None:
        self._offered, self._tells = offered, tells

    def offers(self, service: str) -> bool:
        return self._offered and service == PREPROCESSOR

    def router_tells(self) -> bool:
        return self._tells


def test_where_nothing_is_heard_a_router_that_speaks_says_that_nothing_runs() -> None:
    nothing = Heard({}, [], {}, {})
    assert everything_denied(nothing, Router(offered=False, tells=True)) is None
    denied = everything_denied(nothing, Router(offered=False, tells=False))
    assert denied is not None and denied.startswith("the router lets this program connect but answers none")
    hidden = everything_denied(nothing, Router(offered=True, tells=True))
    assert hidden is not None and hidden.startswith(
        "services run, but the router's access control denies this program permission"
    )


def test_what_is_told_in_part() -> None:
    known = statuses(GATEWAY, {})
    answered = [answer(GATEWAY, 0.0, 0.001)]
    assert list(partly_denied(Heard({GATEWAY: ["a"]}, answered, {GATEWAY: known}, {}))) == []
    [line] = partly_denied(Heard({}, answered, {GATEWAY: known}, {}))
    assert line.startswith(
        "services run, but the router's access control denies this program permission to read their liveliness"
    )
    [line] = partly_denied(Heard({GATEWAY: ["a"]}, answered, {}, {}))
    assert line.startswith("services run, but none of their status messages arrives")
