"""What people do, in the words of ROS4HRI: actions, and the gestures and intents that a mapping file names."""

import json
from pathlib import Path
from typing import Any

import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.messages import ActedObject, Event
from events import event
from humans import Room
from people import STANDING, skeleton
from ros2_bridge.hri_out.mapping import INTENT_NAMES, GestureName, Mapping, MappingError, load

MAPPING = """
gestures:
  two hand wave: {gesture: WAVING}
  raise hand: {gesture: RIGHT_HAND_RAISED, hand: right}
intents:
  two hand wave: {intent: GREET, recipient: "{person}"}
  point at: {intent: BRING_OBJECT, object: "{object}", recipient: "{person}"}
  pick up: {intent: watch the cup, agent: "{person}", object: "{object}", goal: "kitchen {label}"}
"""


def mapping_file(folder: Path, text: str = MAPPING) -> Path:
    (folder / "mapping.yaml").write_text(text, encoding="utf-8")
    return folder / "mapping.yaml"


def doing(name: str, **fields: Any) -> Event:
    return event("one", name, action=name).model_copy(update=fields)


@pytest.fixture
def room(tmp_path: Path) -> Room:
    return Room(ros_hri_mapping=mapping_file(tmp_path)).handle(skeleton(7_000_000_008, STANDING))


def test_each_action_is_published_as_the_persons(room: Room) -> None:
    room.handle(doing("push", result="0.18 m away", confidence=0.75, start_ns=3, end_ns=2_000_000_001))
    told = room.of_person("action")
    assert (told.label, told.object_id, told.object_name, told.result) == ("push", "1", "cup", "0.18 m away")
    assert (told.confidence, told.unknown) == (0.75, False)
    assert (told.start.nanosec, told.end.sec, told.end.nanosec) == (3, 2, 1)
    assert told.header.frame_id == "kinect0_optical_frame"


def test_only_actions_that_the_mapping_names_are_gestures(room: Room) -> None:
    topic = f"/humans/bodies/{room.bodies[0]}/gesture"
    room.handle(doing("push"))
    assert topic not in room.said
    room.handle(doing("two hand wave", hand="left"), doing("raise hand", hand="left"))
    assert [(it.gesture, it.handedness) for it in room.said[topic]] == [(6, 2), (4, 1)]


def test_a_gesture_of_no_known_hand_is_independent_of_hands(room: Room) -> None:
    room.handle(doing("two hand wave", hand=None))
    assert room.of_body("gesture").handedness == 0


def test_without_a_mapping_there_are_no_gestures_and_no_topic_for_them() -> None:
    room = Room().handle(skeleton(1, STANDING), doing("two hand wave"))
    assert not any(topic.endswith("/gesture") for topic in room.declared)
    assert "/intents" not in room.said
    assert room.of_person("action").label == "two hand wave"


def test_an_intent_says_who_wants_what_done_to_what(room: Room) -> None:
    room.handle(doing("point at", confidence=0.5))
    intent = room.last("/intents")
    assert intent.intent == "__intent_bring_object__"
    assert json.loads(intent.data) == {"object": "cup", "recipient": room.persons[0]}
    assert (intent.source, intent.modality) == (room.persons[0], "__modality_motion__")
    assert (intent.confidence, intent.priority) == (0.5, 128)


def test_an_intent_may_have_a_name_of_its_own_and_texts_around_what_is_filled_in(room: Room) -> None:
    room.handle(doing("pick up"))
    intent = room.last("/intents")
    assert intent.intent == "watch the cup"
    assert json.loads(intent.data) == {"agent": room.persons[0], "object": "cup", "goal": "kitchen pick up"}


def test_an_intent_whose_object_is_not_known_is_left_out_and_counted(room: Room) -> None:
    room.handle(doing("point at", object=None))
    assert "/intents" not in room.said
    assert room.bridge.counters.counts == {"intent without an object, left out": 1}


def test_an_intent_whose_object_is_one_of_several_is_left_out_and_counted(room: Room) -> None:
    cup = ActedObject(id=1, name="cup", distance_m=0.1)
    room.handle(doing("point at", candidates=[cup, cup.model_copy(update={"id": 2, "name": "box"})]))
    assert "/intents" not in room.said
    assert room.bridge.counters.counts == {"intent without an object, left out": 1}


def test_what_may_be_none_of_the_actions_is_neither_a_gesture_nor_an_intent(room: Room) -> None:
    room.handle(doing("two hand wave", unknown=True))
    assert room.of_person("action").unknown
    assert not {"/intents", f"/humans/bodies/{room.bodies[0]}/gesture"} & room.said.keys()
    assert room.bridge.counters.counts == {"unknown, no gesture or intent": 1}


@pytest.mark.parametrize(
    "fields", [{"valid": False, "reason": "too few frames", "action": None}, {"action": None}], ids=["invalid", "none"]
)
def test_an_event_without_an_action_says_nothing_of_a_person(room: Room, fields) -> None:
    room.handle(doing("push", **fields))
    assert f"/humans/persons/{room.persons[0]}/action" not in room.said


@pytest.mark.parametrize("fields", [{"agent": 0}, {"agent": 2}, {"session_id": "before"}])
def test_what_nobody_who_is_there_did_is_left_out_and_counted(room: Room, fields) -> None:
    room.handle(doing("two hand wave", **fields))
    assert not {"/intents", f"/humans/bodies/{room.bodies[0]}/gesture"} & room.said.keys()
    assert room.bridge.counters.counts == {"of nobody who is there, left out of /humans": 1}


def test_gestures_and_intents_are_those_of_the_messages() -> None:
    """hri_msgs/msg/Gesture.msg 2.3.2 and hri_actions_msgs/msg/Intent.msg 2.5.0."""
    assert [it.name for it in GestureName] == [
        "HANDS_ON_FACE", "ARMS_CROSSED", "LEFT_HAND_RAISED", "RIGHT_HAND_RAISED", "BOTH_HANDS_RAISED", "WAVING",
        "CLOSED_FIST", "OPEN_PALM", "POINTING_UP", "THUMB_DOWN", "THUMB_UP", "VICTORY", "LOVE",
    ]  # fmt: skip
    assert [it.value for it in GestureName] == [*range(1, 14)]
    assert len(INTENT_NAMES) == 14


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("gestures: {wave: {gesture: WAVE}}", "gestures.wave.gesture: 'WAVE' is not a gesture of hri_msgs: use one of"),
        ("intents: {wave: {intent: HUG}}", "intents.wave.intent: 'HUG' is not an intent of hri_actions_msgs"),
        ("intents: {wave: {intent: GREET, object: '{cup}'}}", "{cup} is not a placeholder: use {person}, {object}"),
        ("intents: {wave: {intent: GREET, object: '{'}}", "intents.wave.object: the text '{' is not a format string"),
        ("intents: {wave: {intent: GREET, whom: you}}", "intents.wave.whom: Extra inputs are not permitted"),
        ("gesture: {}", "gesture: Extra inputs are not permitted"),
        ("", "the file: Input should be a valid dictionary"),
        ("[", "is not YAML"),
    ],
)
def test_a_mapping_that_cannot_be_used_is_refused_by_file_and_field(tmp_path: Path, text, problem) -> None:
    path = mapping_file(tmp_path, text)
    with pytest.raises(MappingError) as refused:
        load(path)
    assert str(refused.value).startswith(f"ros_hri_mapping: {path}")
    assert problem in str(refused.value)


def test_a_mapping_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MappingError, match="cannot be read as text"):
        load(tmp_path / "missing.yaml")


def test_no_file_maps_nothing() -> None:
    assert load(None) == Mapping()
