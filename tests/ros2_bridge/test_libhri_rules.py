"""How libhri 2.9.0 (C++; pyhri wraps it) reads people: each rule with the source file that it was read from.

libhri itself needs ROS 2 and cannot run here.
"""

import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from humans import Room, image
from people import STANDING, skeleton

AT_NS = 7_000_000_008
LISTS = {
    "/humans/bodies/tracked": "hri_msgs::msg::dds_::IdsList_",
    "/humans/persons/tracked": "hri_msgs::msg::dds_::IdsList_",
}
"""hri/src/hri/hri.cpp, HRIListener::HRIListener: subscribed to from the root, with the default quality of service."""
OF_BODY = {"roi": "NormalizedRegionOfInterest2D_", "skeleton2d": "Skeleton2D_"}
"""hri/src/hri/body.cpp, Body::Body: below kNs_, `/humans/bodies/<id>` (hri/src/hri/feature_tracker.cpp)."""
LATCHED_OF_BODY = {"urdf": "String_"}
"""hri_fullbody 2.1.0, hri_fullbody/fullbody_detector.py: `latching_qos`; one text, when the body comes."""
LATCHED = {"body_id": "String_", "anonymous": "Bool_"}
"""hri/src/hri/person.cpp, Person::Person: subscribed to as reliable and transient local, `latched_qos`."""


@pytest.fixture
def room() -> Room:
    return Room().handle(image(), skeleton(AT_NS, STANDING))


def kind(room: Room, topic: str) -> str:
    return room.declared[topic].key.split("/")[-2].rpartition("::")[2]


def test_the_lists_are_at_the_root_with_their_types(room: Room) -> None:
    for topic, typed in LISTS.items():
        assert room.declared[topic].key.split("/")[-2] == typed
        assert room.declared[topic].key.startswith(f"0{topic}/")


def test_a_bodys_topics_are_below_its_id_with_their_types(room: Room) -> None:
    for leaf, typed in OF_BODY.items():
        assert kind(room, f"/humans/bodies/{room.bodies[0]}/{leaf}") == typed


def test_what_is_subscribed_to_as_transient_local_is_published_so(room: Room) -> None:
    """A volatile publisher and a transient local subscriber do not match in ROS 2."""
    of_person = {f"/humans/persons/{room.persons[0]}/{leaf}": typed for leaf, typed in LATCHED.items()}
    of_body = {f"/humans/bodies/{room.bodies[0]}/{leaf}": typed for leaf, typed in LATCHED_OF_BODY.items()}
    for topic, typed in (of_person | of_body).items():
        assert kind(room, topic) == typed
        assert room.declared[topic].latched
        assert "/:1:,1:" in room.declared[topic].token


def test_a_persons_body_is_one_of_the_bodies(room: Room) -> None:
    """hri/src/hri/person.cpp, Person::body: `getBodies()[*body_id_]`; an empty text would mean none."""
    assert room.of_person("body_id").data in room.bodies
    assert room.of_person("anonymous").data is True


def test_a_persons_place_counts_only_with_a_location_confidence(room: Room) -> None:
    """hri/src/hri/person.cpp, Person::transform: no transform where it is below 0.01, or was never received."""
    assert kind(room, f"/humans/persons/{room.persons[0]}/location_confidence") == "Float32_"
    assert room.of_person("location_confidence").data >= 0.01


def test_frames_are_called_by_kind_and_id(room: Room) -> None:
    """hri/src/hri/body.cpp and person.cpp: `body_` and `person_` before the id; hri/src/hri/feature_tracker.cpp."""
    assert {f"body_{room.bodies[0]}", f"person_{room.persons[0]}"} <= room.frames().keys()


def test_eighteen_points_are_taken_in_the_order_of_their_codes(room: Room) -> None:
    """hri/src/hri/body.cpp, Body::onSkeleton: point i is SkeletalKeypoint i (hri/include/hri/types.hpp), c included."""
    points = room.of_body("skeleton2d").skeleton
    assert len(points) == 18
    nose, neck, right_shoulder = points[:3]
    assert nose.y < neck.y < right_shoulder.y + 0.05
    assert right_shoulder.x < neck.x, "who faces the camera has the right shoulder on the image's left"
    assert [point.c for point in points[14:]] == [0] * 4, "eyes and ears are not known"


def test_a_region_is_two_corners_of_the_image(room: Room) -> None:
    """hri/src/hri/body.cpp, Body::onRoI: a rectangle from (xmin, ymin) to (xmax, ymax)."""
    region = room.of_body("roi")
    assert 0 <= region.xmin < region.xmax <= 1
    assert 0 <= region.ymin < region.ymax <= 1
    for point in room.of_body("skeleton2d").skeleton[:14]:
        assert region.xmin <= point.x <= region.xmax
        assert region.ymin <= point.y <= region.ymax


def test_ids_that_are_listed_no_longer_are_removed_with_their_topics(room: Room) -> None:
    """hri/src/hri/hri.cpp, onTrackedFeature: whoever is not in the newest list is invalidated."""
    body = room.bodies[0]
    room.wait(2)
    assert room.bodies == room.persons == []
    assert not any(body in topic for topic in room.declared)
