"""What ROS 2 gets of skeletons, objects, events and intents, read by code that shares nothing with what wrote it."""

import json
from typing import Any

import numpy as np
import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.bridge import Foreign
from actum.messages import (
    ActedObject,
    Event,
    HeldObject,
    Image,
    Intended,
    Intent,
    Message,
    Motion,
    ObjectPose,
    Objects,
    Segment,
    Skeleton,
    TrackedObject,
)
from actum.node import SECOND_NS, Tick
from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES
from events import event
from people import STANDING, lacking, skeleton
from ros2_bridge import message_types as types
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings
from ros2_bridge.topics import PUBLISHED
from ros2_reading import read

TODAYS = "skeletons,tf,objects,event,event_json,intent,mark"
"""All topics but those of ROS4HRI, which come and go with the people."""
AT_NS = 7 * SECOND_NS + 8
TYPES = {topic.name: topic.type for topic in PUBLISHED}
CUP = TrackedObject(
    id=3, name="cup", position_m=[0.1, 0.2, 1.5], quaternion_xyzw=[0.5, -0.5, 0.5, 0.5], confidence=0.75, seen=True
)


REACHING = Intent(
    stamp_ns=AT_NS, sensor="kinect0", agent=2, completeness=0.25, segment_id="auto-1",
    intended=[
        Intended(
            action="lift", object_id=3, object_name="cup", hand="left", probability=0.75, soon_probability=0.875,
            contact_s=0.5, contact_std_s=0.125, place_m=[0.1, 0.2, 1.5],
        ),
    ],
)  # fmt: skip


def put(*messages: Message | Tick, **settings: Any) -> dict[str, Any]:
    """What a new bridge puts, as who subscribes reads it, by topic."""
    bridge = Ros2Bridge(Settings(**{"ros_topics": TODAYS, **settings}))
    foreign = [answer for message in messages for answer in bridge.handle(message) if isinstance(answer, Foreign)]
    assert not bridge.counters.rejects
    assert len({answer.topic for answer in foreign}) == len(foreign)
    return {answer.topic: read(TYPES[answer.topic], answer.payload) for answer in foreign}


def xyz(point: Any) -> list[float]:
    return [point.x, point.y, point.z]


def xyzw(quaternion: Any) -> list[float]:
    return [*xyz(quaternion), quaternion.w]


def assert_header(header: Any, frame_id: str = "kinect0_optical_frame") -> None:
    assert (header.stamp.sec, header.stamp.nanosec, header.frame_id) == (7, 8, frame_id)


def test_a_person_is_shown_as_joints_bones_and_a_number() -> None:
    joints, bones, number = put(skeleton(AT_NS, STANDING))["skeletons"].markers
    assert [xyz(point) for point in joints.points] == STANDING.tolist()
    pairs = np.array([xyz(point) for point in bones.points]).reshape(-1, 2, 3)
    assert pairs.tolist() == [[STANDING[a].tolist(), STANDING[b].tolist()] for a, b, _ in BONES]
    assert number.text == "1"
    assert number.pose.position.y < STANDING[INDEX["head"]][1], "above: y is down"
    for marker in (joints, bones, number):
        assert_header(marker.header)
        assert xyzw(marker.pose.orientation) == [0, 0, 0, 1]
        assert marker.color.a == 1
        assert marker.lifetime.sec > 0
    assert [marker.type for marker in (joints, bones, number)] == [7, 5, 9]


def test_people_are_told_apart() -> None:
    markers = put(skeleton(AT_NS, STANDING, STANDING + 1))["skeletons"].markers
    assert len({(marker.ns, marker.id) for marker in markers}) == len(markers) == 6
    assert len({(marker.ns, marker.color.r) for marker in markers}) == 2


def test_a_missing_joint_is_neither_shown_nor_placed() -> None:
    of = put(skeleton(AT_NS, lacking(STANDING, "left_elbow", "head")))
    joints, bones = of["skeletons"].markers
    assert len(joints.points) == 13
    assert len(bones.points) == 2 * (len(BONES) - 3)
    placed = {transform.child_frame_id for transform in of["/tf"].transforms}
    assert "kinect0_person_1_left_hand" in placed
    assert not {"kinect0_person_1_left_elbow", "kinect0_person_1_head"} & placed


def test_no_marker_is_without_points() -> None:
    """RViz would call it an error."""
    only_a_hand = lacking(STANDING, *(name for name in JOINTS if name != "left_hand"))
    [joints] = put(skeleton(AT_NS, only_a_hand))["skeletons"].markers
    assert [xyz(point) for point in joints.points] == [STANDING[INDEX["left_hand"]].tolist()]
    assert put(skeleton(AT_NS, np.full((15, 3), np.nan)))["skeletons"].markers == []


def test_every_joint_has_a_frame_below_the_cameras() -> None:
    transforms = {it.child_frame_id: it for it in put(skeleton(AT_NS, STANDING))["/tf"].transforms}
    assert set(transforms) == {
        "kinect0_level", "kinect0_person_1", *(f"kinect0_person_1_{name}" for name in JOINTS)
    }  # fmt: skip
    for name, joint in zip(JOINTS, STANDING, strict=True):
        transform = transforms[f"kinect0_person_1_{name}"]
        assert_header(transform.header)
        assert xyz(transform.transform.translation) == joint.tolist()
        assert xyzw(transform.transform.rotation) == [0, 0, 0, 1]


def test_a_person_facing_the_camera_is_turned_to_face_it() -> None:
    """Forward, left, up of the person are back, right, up of the camera: a half turn of the optical frame's link."""
    [person] = [
        it for it in put(skeleton(AT_NS, STANDING))["/tf"].transforms if it.child_frame_id == "kinect0_person_1"
    ]
    turned = xyzw(person.transform.rotation)
    assert np.abs(np.dot(turned, [0.5, 0.5, -0.5, 0.5])) == pytest.approx(1, abs=1e-3)


def test_the_camera_is_told_of_once_and_lies_in_its_link_as_urdfs_say_it() -> None:
    bridge = Ros2Bridge(Settings(ros_topics=TODAYS))
    [once] = bridge.handle(Tick(1))
    assert list(bridge.handle(Tick(2))) == []
    [transform] = read(types.TF_MESSAGE, once.payload).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("kinect0_link", "kinect0_optical_frame")
    assert xyzw(transform.transform.rotation) == pytest.approx([-0.5, 0.5, -0.5, 0.5])


def test_a_robot_that_has_the_cameras_frame_keeps_it() -> None:
    of = put(Tick(1), skeleton(AT_NS, STANDING), ros_frame_id="head_camera_optical_frame")
    assert set(of) == {"skeletons", "/tf"}
    assert {it.header.frame_id for it in of["/tf"].transforms} == {"head_camera_optical_frame"}


def test_nobody_is_an_empty_list() -> None:
    of = put(skeleton(AT_NS))
    assert of["skeletons"].markers == []
    assert [it.child_frame_id for it in of["/tf"].transforms] == ["kinect0_level"]


def test_an_object_is_a_detection_at_its_place() -> None:
    array = put(Objects(stamp_ns=AT_NS, sensor="kinect0", objects=[CUP]))["objects"]
    [detection] = array.detections
    [result] = detection.results
    assert_header(array.header)
    assert_header(detection.header)
    assert (detection.id, result.hypothesis.class_id, result.hypothesis.score) == ("3", "cup", 0.75)
    for pose in (result.pose.pose, detection.bbox.center):
        assert (xyz(pose.position), xyzw(pose.orientation)) == (CUP.position_m, CUP.quaternion_xyzw)


def told(**fields: Any) -> Event:
    acted = event("lift-1", "lift object 3", name="cup")
    return acted.model_copy(update={"stamp_ns": AT_NS, "start_ns": SECOND_NS, "end_ns": 2 * SECOND_NS + 1, **fields})


def with_pose(quaternion: list[float] | None) -> Event:
    acted = told().object
    assert acted is not None
    placed = ObjectPose(frame="camera", position_m=[1, 2, 3], quaternion_xyzw=quaternion)
    return told(object=acted.model_copy(update={"pose": placed}), motion=Motion(displacement_m=[0.1, 0.2, 0.3]))


def test_an_event_says_who_did_what_to_which_object_and_when() -> None:
    typed = put(told(hand="left", outcome="lifted", familiarity=0.75))["event"]
    assert_header(typed.header)
    assert (typed.start.sec, typed.start.nanosec, typed.end.sec, typed.end.nanosec) == (1, 0, 2, 1)
    assert (typed.valid, typed.agent, typed.hand, typed.action, typed.confidence) == (True, 1, "left", "push", 1.0)
    assert (typed.object_id, typed.object_name, typed.outcome) == ("1", "cup", "lifted")
    assert (typed.sentence, typed.segment_id) == ("lift object 3", "lift-1")
    assert (typed.familiarity_known, typed.familiarity) == (True, 0.75)
    assert not put(told())["event"].familiarity_known
    assert (typed.position_known, typed.displacement_known) == (False, False)


@pytest.mark.parametrize("quaternion", [None, [0.5, 0.5, -0.5, 0.5]])
def test_an_event_says_where_the_object_ended_as_far_as_that_is_known(quaternion) -> None:
    typed = put(with_pose(quaternion))["event"]
    assert (typed.position_known, typed.orientation_known) == (True, quaternion is not None)
    assert xyz(typed.object_pose.position) == [1, 2, 3]
    assert xyzw(typed.object_pose.orientation) == (quaternion or [0, 0, 0, 1])
    assert (typed.displacement_known, xyz(typed.displacement)) == (True, [0.1, 0.2, 0.3])


def test_an_event_says_what_became_of_the_object_and_of_others_that_are_as_likely() -> None:
    acted = told().object
    assert acted is not None
    fixed = ObjectPose(frame="world", position_m=[4, 5, 6], quaternion_xyzw=None)
    moved = acted.model_copy(update={"taken_along": True, "in_hand_at_end": True, "fixed_pose": fixed})
    typed = put(
        told(
            object=moved,
            held=HeldObject(id=7, name="knife"),
            candidates=[moved, moved.model_copy(update={"id": 9})],
            motion=Motion(displacement_m=[0, 0.2, 0], direction="up"),
            agrees=False,
            result="0.20 m up",
            session_id="monday",
        )
    )["event"]
    assert (typed.taken_along, typed.in_hand_at_end, typed.direction) == (True, True, "up")
    assert (typed.fixed_frame, xyz(typed.fixed_pose.position)) == ("world", [4, 5, 6])
    assert (typed.held_id, typed.held_name, typed.candidate_ids) == ("7", "knife", ["1", "9"])
    assert (typed.agreement_known, typed.agrees, typed.result, typed.session_id) == (True, False, "0.20 m up", "monday")


def test_what_is_not_known_of_an_event_is_empty() -> None:
    typed = put(told(object=None, held=None, motion=None, agrees=None, why="nothing was near"))["event"]
    assert (typed.why, typed.agreement_known, typed.direction, typed.result) == ("nothing was near", False, "", "")
    assert (typed.fixed_frame, typed.held_name, typed.candidate_ids, typed.taken_along) == ("", "", [], False)


def test_an_event_that_is_not_valid_says_why() -> None:
    typed = put(told(valid=False, reason="too few frames", object=None, action=None))["event"]
    assert (typed.valid, typed.reason, typed.action, typed.object_id) == (False, "too few frames", "", "")


def test_as_json_an_event_has_all_its_fields() -> None:
    acted = with_pose([0.0, 0.0, 0.0, 1.0])
    assert Event.model_validate_json(put(acted)["event_json"].data) == acted
    assert json.loads(put(acted)["event_json"].data)["segment_id"] == "lift-1"


def test_an_intent_says_who_is_about_to_touch_what_where_and_when() -> None:
    typed = put(REACHING)["intent"]
    [contact] = typed.intended
    assert_header(typed.header)
    assert (typed.agent, typed.segment_id, typed.completeness_known, typed.completeness) == (2, "auto-1", True, 0.25)
    assert (contact.action, contact.object_id, contact.object_name, contact.hand) == ("lift", "3", "cup", "left")
    assert (contact.probability, contact.contact_s, contact.contact_std_s) == (0.75, 0.5, 0.125)
    assert xyz(contact.place) == [0.1, 0.2, 1.5]


def test_an_intent_that_is_over_is_empty_and_what_is_not_known_of_one_is_too() -> None:
    over = put(REACHING.model_copy(update={"intended": [], "segment_id": None, "completeness": None}))["intent"]
    assert (over.intended, over.segment_id, over.completeness_known) == ([], "", False)
    unnamed = REACHING.intended[0].model_copy(update={"action": None})
    [contact] = put(REACHING.model_copy(update={"intended": [unnamed]}))["intent"].intended
    assert contact.action == ""


@pytest.mark.parametrize(
    ("chosen", "topics"),
    [("event", {"event"}), ("intent", {"intent"}), ("tf,objects", {"/tf", "/tf_static", "objects"}), ("mark", set())],
)
def test_only_what_is_chosen_is_put(chosen, topics) -> None:
    objects = Objects(stamp_ns=AT_NS, sensor="kinect0", objects=[CUP])
    assert set(put(Tick(1), skeleton(AT_NS, STANDING), objects, told(), REACHING, ros_topics=chosen)) == topics


def test_what_is_not_valid_is_left_out_and_counted() -> None:
    bridge = Ros2Bridge(Settings())
    for number, message in enumerate((skeleton(AT_NS, STANDING), REACHING), 1):
        assert list(bridge.handle(message.model_copy(update={"valid": False, "reason": "dark"}))) == []
        assert bridge.counters.counts.total() == number


@pytest.mark.parametrize(
    "message",
    [skeleton(2**61, STANDING), told(end_ns=2**31 * SECOND_NS), REACHING.model_copy(update={"stamp_ns": 2**61})],
)
def test_a_stamp_that_ros_has_no_number_for_is_refused(message) -> None:
    bridge = Ros2Bridge(Settings())
    assert list(bridge.handle(message)) == []
    assert bridge.counters.rejects == {"stamp_beyond_ros": 1}


@pytest.mark.parametrize("bad", [float("inf"), float("nan"), -1e300])
def test_a_joint_that_cannot_be_counts_as_missing(bad) -> None:
    bridge = Ros2Bridge(Settings(ros_topics=TODAYS))
    message = skeleton(AT_NS, STANDING)
    message.agents[0].joints[INDEX["left_hand"]] = [0.0, bad, 2.0]
    foreign: dict[str, Foreign] = {it.topic: it for it in bridge.handle(message) if isinstance(it, Foreign)}
    markers = read(types.MARKER_ARRAY, foreign["skeletons"].payload).markers
    assert len(markers[0].points) == 14
    assert bridge.counters.rejects == {"bad_joint": 1}


def test_what_is_put_can_be_put_by_any_sender_of_ours() -> None:
    """Objects' numbers in events have no bound, and texts any letters."""
    acted = told().object
    assert acted is not None
    typed = put(told(object=acted.model_copy(update={"id": 2**63, "name": "Tässchen ☕"})))["event"]
    assert (typed.object_id, typed.object_name) == (str(2**63), "Tässchen ☕")


def test_messages_of_other_kinds_are_nothing_to_it() -> None:
    assert {topic.message for topic in Ros2Bridge(Settings()).inputs} == {Skeleton, Objects, Event, Intent, Image}
    assert Image not in {topic.message for topic in Ros2Bridge(Settings(ros_topics=TODAYS)).inputs}
    start = Segment(sensor="kinect0", kind="start", segment_id="a")
    assert start.stamp_ns is None
    assert put(start) == {}


CARRIED = {
    "stamp_ns": {"header"},
    "sensor": {"header"},
    "start_ns": {"start"},
    "end_ns": {"end"},
    "object": {
        *("object_id", "object_name", "taken_along", "in_hand_at_end"),
        *("position_known", "orientation_known", "object_pose", "fixed_frame", "fixed_pose"),
    },
    "held": {"held_id", "held_name"},
    "motion": {"displacement_known", "displacement", "direction"},
    "candidates": {"candidate_ids"},
    "agrees": {"agreement_known", "agrees"},
    "familiarity": {"familiarity_known", "familiarity"},
    **{
        name: {name}
        for name in (
            *("segment_id", "valid", "reason", "agent", "hand", "action", "confidence", "unknown"),
            *("outcome", "sentence", "session_id", "result", "why"),
        )
    },
}
"""The fields of ActionEvent.msg in which each field of an event is carried."""
ONLY_IN_JSON = {
    *("seq", "frames", "missed", "missing_joints"),
    *("activations", "objects_present", "distances_m", "pointing"),
}
"""The fields of an event that only `event_json` carries: how it travelled, and what was weighed."""
PARTS_CARRIED = {
    ActedObject: {"id", "name", "taken_along", "in_hand_at_end", "pose", "fixed_pose"},
    HeldObject: {"id", "name"},
    Motion: {"displacement_m", "direction"},
    ObjectPose: {"frame", "position_m", "quaternion_xyzw"},
}
PARTS_ONLY_IN_JSON = {ActedObject: {"distance_m", "carried", "last_seen_ns"}, Motion: {"turn_ns"}}
"""The same of the parts of an event."""


def test_every_field_of_an_event_is_carried_or_left_to_the_json() -> None:
    assert {*CARRIED} | ONLY_IN_JSON == {*Event.model_fields}
    assert not {*CARRIED} & ONLY_IN_JSON
    for part, carried in PARTS_CARRIED.items():
        assert carried | PARTS_ONLY_IN_JSON.get(part, set()) == {*part.model_fields}


def test_every_field_of_the_message_carries_one_of_an_event() -> None:
    fields = {name for name in vars(types.made(types.ACTION_EVENT)) if not name.startswith("_")}
    assert set.union(*CARRIED.values()) == fields


CONTACT_RENAMED = {"place_m": "place"}
"""The fields of IntendedContact.msg that are called otherwise than those of a contact; units stand in ROS's types."""


def test_every_field_of_a_contact_is_carried_and_every_one_of_an_intent_but_how_it_travelled() -> None:
    contact = {name for name in vars(types.made(types.INTENDED_CONTACT)) if not name.startswith("_")}
    assert contact == {CONTACT_RENAMED.get(name, name) for name in Intended.model_fields}
    intent = {name for name in vars(types.made(types.ACTION_INTENT)) if not name.startswith("_")}
    left_out = {"stamp_ns", "sensor", "seq", "valid", "reason", "session_id"}
    assert intent == {*Intent.model_fields} - left_out | {"header", "completeness_known"}
