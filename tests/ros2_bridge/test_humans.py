"""People as ROS4HRI's bodies and persons: their ids, and their topics, which come and go with them."""

from itertools import pairwise

import numpy as np
import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.messages import MOST_AGENTS
from humans import NEAR, Room, image
from people import STANDING, lacking, skeleton, turned
from ros2_bridge.hri import types as hri
from ros2_bridge.hri_out.announcing import Announcing
from ros2_bridge.hri_out.body import LINKS, body_of
from ros2_bridge.message_types import made
from ros2_bridge.settings import Settings
from ros2_bridge.topics import PUBLISHED, RosTopic

AT_NS = 7_000_000_008
BODY_TOPICS = {"joint_states", "urdf", "posture", "roi", "skeleton2d"}
PERSON_TOPICS = {"body_id", "anonymous", "location_confidence", "action"}


def people_topics(room: Room) -> set[str]:
    """The topics beside those that stay."""
    return room.declared.keys() - {topic.name for topic in PUBLISHED}


def test_who_comes_has_topics_of_a_body_and_a_person() -> None:
    room = Room().handle(image(), skeleton(AT_NS, STANDING))
    [body], [person] = room.bodies, room.persons
    assert people_topics(room) == {f"/humans/bodies/{body}/{leaf}" for leaf in BODY_TOPICS} | {
        f"/humans/persons/{person}/{leaf}" for leaf in PERSON_TOPICS
    }


def test_ids_are_five_letters_since_topics_of_ros_begin_with_no_digit() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING, STANDING + 1))
    ids = [*room.bodies, *room.persons]
    assert len(set(ids)) == 4
    assert all(len(it) == 5 and it.isalpha() and it.islower() for it in ids)


def test_who_is_lost_for_a_moment_stays_and_who_is_gone_is_withdrawn_with_all_topics() -> None:
    room = Room().handle(image(), skeleton(AT_NS, STANDING))
    body, topics = room.bodies, people_topics(room)
    room.handle(skeleton(AT_NS + 1)).wait(1.4)
    assert room.bodies == body
    assert people_topics(room) == topics
    room.wait(0.3)
    assert room.bodies == room.persons == []
    assert people_topics(room) == set()
    assert {*room.withdrawn} == topics


def test_numbers_that_change_with_each_frame_do_not_open_topics_without_end() -> None:
    room = Room()
    for frame in range(3):
        crowd = skeleton(AT_NS + frame, *[STANDING] * 40)
        agents = [agent.model_copy(update={"agent": agent.agent + 40 * frame}) for agent in crowd.agents]
        room.handle(crowd.model_copy(update={"agents": agents}))
    assert len(room.bodies) == MOST_AGENTS
    assert room.bridge.counters.counts == {"one person too many, left out of /humans": 3 * 40 - MOST_AGENTS}
    assert room.wait(2).bodies == []


def test_what_is_withdrawn_is_put_on_no_longer() -> None:
    topic = RosTopic("/humans/persons/a/anonymous", hri.BOOL, "persons")
    announcing = Announcing(Settings())
    assert [it.name for it in announcing.announce([topic])] == [topic.name]
    assert list(announcing.announce([topic])) == []
    assert [it.topic for it in announcing.on(topic.name, made(hri.BOOL))] == [topic.name]
    assert [it.topic for it in announcing.withdraw([topic])] == [topic.name]
    assert list(announcing.on(topic.name, made(hri.BOOL))) == list(announcing.withdraw([topic])) == []


def test_people_whose_sensor_falls_silent_go_too() -> None:
    assert Room().handle(skeleton(AT_NS, STANDING)).wait(2).bodies == []


def test_ids_are_never_used_again_also_by_who_has_the_same_number() -> None:
    room, seen = Room(), []
    for visit in range(3):
        room.handle(skeleton(AT_NS + visit, STANDING))
        seen += [*room.bodies, *room.persons]
        room.wait(2)
    room.begin("another session")
    room.handle(skeleton(AT_NS + 9, STANDING))
    seen += [*room.bodies, *room.persons]
    assert len(set(seen)) == len(seen) == 8


def test_agents_of_another_run_of_the_source_are_others() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING, session_id="one"))
    before = room.bodies
    room.handle(skeleton(AT_NS, STANDING, session_id="two"))
    assert before != room.bodies
    assert not any(topic.startswith(f"/humans/bodies/{before[0]}") for topic in room.declared)


def test_two_sessions_give_different_ids() -> None:
    one, other = Room(), Room()
    other.begin("5e56")
    frame = skeleton(AT_NS, STANDING)
    assert one.handle(frame).bodies != other.handle(frame).bodies


def test_a_new_zenoh_session_has_no_topic_of_the_one_before() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING))
    room.begin("another")
    assert people_topics(room) == set()
    assert len(room.handle(skeleton(AT_NS, STANDING)).bodies) == 1


def test_the_lists_are_repeated_for_who_comes_late_and_matches_each_second() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING))
    lists, matches = (len(room.said[topic]) for topic in ("/humans/bodies/tracked", "/humans/candidate_matches"))
    room.handle(skeleton(AT_NS + 1, STANDING)).wait(1)
    assert len(room.said["/humans/bodies/tracked"]) == lists + 10
    assert len(room.said["/humans/candidate_matches"]) == matches + 1


def test_a_body_is_matched_with_its_person_surely_and_no_longer_when_they_are_gone() -> None:
    """hri_msgs/msg/IdsMatch.msg: PERSON is 1, BODY 3, and confidence 0 means that they are not associated."""
    room = Room().handle(skeleton(AT_NS, STANDING))
    [body], [person] = room.bodies, room.persons
    matches = room.wait(2).said["/humans/candidate_matches"]
    assert {(it.id1, it.id1_type, it.id2, it.id2_type) for it in matches} == {(body, 3, person, 1)}
    assert [it.confidence for it in matches] == [1, 1, 0]


def test_a_persons_frame_is_at_the_head_and_all_links_are_below_the_body() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING))
    [body], [person], frames = room.bodies, room.persons, room.frames()
    assert frames[f"body_{body}"].header.frame_id == "kinect0_optical_frame"
    for link in LINKS:
        assert frames[f"{link}_{body}"].header.frame_id == f"body_{body}"
    assert frames[f"person_{person}"].transform == frames[f"head_{body}"].transform
    headless = Room().handle(skeleton(AT_NS, lacking(STANDING, "head")))
    [body], [person], frames = headless.bodies, headless.persons, headless.frames()
    assert frames[f"person_{person}"].transform == frames[f"torso_{body}"].transform


def test_links_and_persons_are_left_out_where_they_are_not_chosen() -> None:
    room = Room(ros_topics="tf,bodies").handle(skeleton(AT_NS, STANDING))
    [body] = room.bodies
    assert {name for name in room.frames() if not name.startswith("kinect0")} == {f"body_{body}"}
    assert not any(topic.startswith("/humans/persons") for topic in room.declared)
    without_tf = Room(ros_topics="bodies,persons,body_links").handle(skeleton(AT_NS, STANDING))
    assert "/tf" not in without_tf.said


def test_joint_states_have_the_names_of_the_persons_own_model_with_the_bodys_id() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING))
    [body], state, expected = room.bodies, room.of_body("joint_states"), body_of(STANDING)
    assert expected is not None
    assert dict(zip(state.name, state.position, strict=True)) == {
        f"{joint}_{body}": position for joint, position in (expected.angles | expected.shifts_m).items()
    }
    assert (state.header.stamp.sec, state.header.stamp.nanosec) == (7, 8)


def test_of_who_is_half_seen_only_what_is_known_is_published() -> None:
    room = Room().handle(image(), skeleton(AT_NS, lacking(STANDING, "left_hip", "torso")))
    [body] = room.bodies
    assert f"/humans/bodies/{body}/joint_states" not in room.said
    assert f"body_{body}" not in room.frames()
    assert room.of_body("skeleton2d").skeleton[0].c == 1


def test_the_image_topics_come_with_the_first_image() -> None:
    room = Room().handle(skeleton(AT_NS, STANDING))
    [body] = room.bodies
    assert f"/humans/bodies/{body}/skeleton2d" not in room.declared
    room.handle(image(), skeleton(AT_NS + 1, STANDING))
    assert {f"/humans/bodies/{body}/skeleton2d", f"/humans/bodies/{body}/roi"} <= room.said.keys()


@pytest.mark.parametrize("fields", [{"K": [0.0, *NEAR[1:]]}, {"skeleton_from_image": [0.0] * 16}])
def test_a_camera_that_cannot_be_is_refused_and_the_one_before_is_kept(fields) -> None:
    room = Room().handle(image(), image(**fields), skeleton(AT_NS, STANDING))
    assert room.bridge.counters.rejects == {"unusable_camera": 1}
    assert room.of_body("skeleton2d").skeleton[0].c == 1


def test_the_lists_are_put_before_what_is_said_of_who_is_new() -> None:
    """A listener subscribes to a body's topics when the list names the body."""
    room = Room().handle(skeleton(AT_NS, STANDING))
    assert room.order.index("/humans/bodies/tracked") < room.order.index(f"/humans/bodies/{room.bodies[0]}/posture")


def test_a_body_turns_to_the_left_about_its_z_axis() -> None:
    before, after = (body_of(turned(STANDING, angle)) for angle in (0, 0.5))
    assert before is not None
    assert after is not None
    x, y = (before.optical_from_body[:3, :3].T @ after.optical_from_body[:3, 0])[:2]
    assert (x, y) == pytest.approx((0.878, 0.479), abs=0.02)


def test_each_person_has_topics_of_their_own() -> None:
    apart = np.array([1.0, 0, 0])
    room = Room().handle(skeleton(AT_NS, STANDING - apart, STANDING, STANDING + apart))
    places = [room.frames()[f"body_{body}"].transform.translation.x for body in room.bodies]
    assert [right - left for left, right in pairwise(places)] == pytest.approx([1, 1])
