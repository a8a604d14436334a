"""Marks from ROS 2: read where they are right, counted and survived where they are not."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.bridge import Foreign
from actum.messages import Segment
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.marks import MOST_BYTES
from ros2_bridge.settings import Settings
from ros2_reading import text

BRIDGE = Ros2Bridge(Settings(sensor="lab"))


def segments(payload: bytes) -> list[Any]:
    return list(BRIDGE.receive(Foreign("mark", payload)))


def refusal(payload: bytes) -> str:
    """Why a payload is no mark, as `status` tells it."""
    before = BRIDGE.counters.rejects["bad_mark"]
    assert segments(payload) == []
    assert BRIDGE.counters.rejects["bad_mark"] == before + 1
    return BRIDGE.counters.last_error or ""


def test_a_mark_becomes_a_segment_message_of_the_sensor() -> None:
    before = BRIDGE.counters.counts["marks"]
    assert segments(text('{"kind": "start", "segment_id": "lift-1"}')) == [
        Segment(stamp_ns=None, sensor="lab", kind="start", segment_id="lift-1")
    ]
    assert BRIDGE.counters.counts["marks"] == before + 1


def test_a_mark_may_say_when_who_with_which_hand_and_what() -> None:
    fields = {"kind": "end", "segment_id": "a", "stamp_ns": 7, "agent": 2, "hand": "left", "label": "lift"}
    [segment] = segments(text(json.dumps(fields)))
    assert segment.model_dump(include=set(fields)) == fields


@pytest.mark.parametrize(
    ("payload", "complaint"),
    [
        (b"", "not a std_msgs/String"),
        (b"\x00\x01\x00\x00\xff\xff\xff\xff{}", "not a std_msgs/String"),
        (text(""), "not JSON"),
        (text("start"), "not JSON"),
        (text('{"kind": "start"'), "not JSON"),
        (text("[" * 5000), "not JSON"),
        (text("[]"), "must be a JSON object with some of the fields kind, segment_id, stamp_ns"),
        (
            text('{"kind": "start", "segment": "a"}'),
            "'segment' is not a field of a message that marks an action: use one or more of kind, segment_id",
        ),
        (text('{"kind": "start", "segment_id": "a", "origin": "auto"}'), "'origin' is not a field"),
        (text('{"kind": "stop", "segment_id": "a"}'), "kind: "),
        (text('{"kind": "start", "segment_id": ""}'), "segment_id: "),
        (text('{"kind": "start", "segment_id": "a", "stamp_ns": 1.5}'), "stamp_ns: "),
        (text('{"kind": "start", "segment_id": "a", "stamp_ns": -1}'), "stamp_ns: "),
        (text(" " * MOST_BYTES), f"at most {MOST_BYTES}"),
    ],
)
def test_what_is_no_mark_is_counted_with_the_reason(payload, complaint) -> None:
    assert complaint in refusal(payload)


@given(st.one_of(st.binary(max_size=60), st.binary(max_size=60).map(lambda b: b"\0\1\0\0" + b), st.text().map(text)))
def test_nothing_that_comes_ends_the_bridge(payload) -> None:
    assert all(isinstance(segment, Segment) for segment in segments(payload))
