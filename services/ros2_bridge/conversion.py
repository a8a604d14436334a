"""Our messages as ROS 2's: skeletons as markers and transforms, objects as detections, events, intents."""

import math
from collections.abc import Iterable, Sequence
from itertools import compress
from typing import Any

from actum.arrays import Array
from actum.messages import ActedObject, Event, Intended, Intent, Objects, Skeleton, TrackedObject
from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES
from ros2_bridge.frames import (
    LINK_FROM_OPTICAL,
    header,
    optical_from_body,
    optical_from_level,
    pose,
    ros_time,
    transform,
    vector,
)
from ros2_bridge.message_types import (
    ACTION_EVENT,
    ACTION_INTENT,
    DETECTION_3D_ARRAY,
    INTENDED_CONTACT,
    MARKER_ARRAY,
    STRING,
    TF_MESSAGE,
    made,
)

SHOWN_S = 1
"""How long a marker is shown (s) that no other replaces: a person who has left disappears."""
JOINT_M, BONE_M, TEXT_M = 0.06, 0.03, 0.15
"""Diameter of a joint's ball, width of a bone's line, height of the letters (m): as large as a hand's."""
ABOVE_HEAD_M = 0.25
"""How far above the head's joint a person's number stands (m)."""
COLOURS = ((0.9, 0.6, 0.0), (0.35, 0.7, 0.9), (0.0, 0.6, 0.5), (0.8, 0.4, 0.7))
"""Red, green, blue of people in the order of their numbers, then again: distinct also to the colour-blind."""
SPHERE_LIST, LINE_LIST, TEXT = 7, 5, 9
"""Kinds of visualization_msgs/Marker."""

People = Sequence[tuple[int, Array]]
"""Each person's number and joints, (15, 3) m, camera frame, NaN where unknown."""


def markers(message: Skeleton, people: People, frame_id: str) -> Any:
    """Return a MarkerArray: of each person the joints, the bones between known ones, and the number above the head."""
    of = header(message.stamp_ns, frame_id)
    return made(MARKER_ARRAY, markers=[marker for number, joints in people for marker in _figure(of, number, joints)])


def _figure(of: Any, person: int, joints: Array) -> list[Any]:
    """Return one person's markers; RViz refuses one that has no points, so there is none."""
    places = joints.tolist()
    known = [not math.isnan(x) for x, _, _ in places]
    ends = [places[end] for *bone, _ in BONES if all(known[end] for end in bone) for end in bone]
    figure = []
    if any(known):
        balls = _points(compress(places, known))
        figure.append(_marker(of, person, 0, SPHERE_LIST, (JOINT_M, JOINT_M, JOINT_M), points=balls))
    if ends:
        figure.append(_marker(of, person, 1, LINE_LIST, (BONE_M, 0, 0), points=_points(ends)))
    if known[INDEX["head"]]:
        x, y, z = places[INDEX["head"]]
        above = pose((x, y - ABOVE_HEAD_M, z), None)
        figure.append(_marker(of, person, 2, TEXT, (0, 0, TEXT_M), pose=above, text=str(person)))
    return figure


def _points(positions_m: Iterable[Sequence[float]]) -> list[Any]:
    return [vector(position, "Point") for position in positions_m]


def _marker(of: Any, person: int, number: int, kind: int, scale_m: Sequence[float], **fields: Any) -> Any:
    red, green, blue = COLOURS[(person - 1) % len(COLOURS)]
    return made(
        "visualization_msgs/msg/Marker",
        header=of,
        ns=f"person_{person}",
        id=number,
        type=kind,
        scale=vector(scale_m),
        color=made("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=1.0),
        lifetime=made("builtin_interfaces/msg/Duration", sec=SHOWN_S),
        **fields,
    )


def transforms(message: Skeleton, people: People, frame_id: str) -> Any:
    """Return a TFMessage: level axes, and of each person the body's frame and one at each known joint.

    A joint is a point: the axes of its frame are the camera's.
    """
    of, sensor = header(message.stamp_ns, frame_id), message.sensor
    placed = [transform(of, f"{sensor}_level", rotation=optical_from_level(message.up_in_camera))]
    for number, joints in people:
        person = f"{sensor}_person_{number}"
        body = optical_from_body(joints)
        if body is not None:
            placed.append(transform(of, person, body[:3, 3], body[:3, :3]))
        known = zip(JOINTS, joints.tolist(), strict=True)
        placed += [transform(of, f"{person}_{name}", joint) for name, joint in known if not math.isnan(joint[0])]
    return made(TF_MESSAGE, transforms=placed)


def optical_in_link(sensor: str, frame_id: str) -> Any:
    """Return a TFMessage: how the optical frame lies in `<sensor>_link`, which has x forward, y left, z up."""
    return made(TF_MESSAGE, transforms=[transform(header(0, f"{sensor}_link"), frame_id, rotation=LINK_FROM_OPTICAL)])


def detections(message: Objects, frame_id: str) -> Any:
    """Return a Detection3DArray of all objects, also those that are followed or remembered; sizes are not known."""
    of = header(message.stamp_ns, frame_id)
    return made(DETECTION_3D_ARRAY, header=of, detections=[_detection(of, item) for item in message.objects])


def _detection(of: Any, item: TrackedObject) -> Any:
    placed = pose(item.position_m, item.quaternion_xyzw)
    result = made(
        "vision_msgs/msg/ObjectHypothesisWithPose",
        hypothesis=made("vision_msgs/msg/ObjectHypothesis", class_id=item.name, score=item.confidence),
        pose=made("geometry_msgs/msg/PoseWithCovariance", pose=placed),
    )
    box = made("vision_msgs/msg/BoundingBox3D", center=placed)
    return made("vision_msgs/msg/Detection3D", header=of, results=[result], bbox=box, id=str(item.id))


def action_event(event: Event, frame_id: str) -> Any:
    """Return an ActionEvent; a text that is not known is empty."""
    texts = {name: getattr(event, name) or "" for name in ("reason", "hand", "action", "outcome", "why", "result")}
    return made(
        ACTION_EVENT,
        header=header(event.stamp_ns, frame_id),
        start=ros_time(event.start_ns),
        end=ros_time(event.end_ns),
        session_id=event.session_id,
        segment_id=event.segment_id,
        valid=event.valid,
        agent=event.agent,
        confidence=event.confidence,
        familiarity_known=event.familiarity is not None,
        familiarity=event.familiarity or 0.0,
        unknown=event.unknown,
        candidate_ids=[str(each.id) for each in event.candidates],
        held_id=str(event.held.id) if event.held else "",
        held_name=event.held.name if event.held else "",
        displacement_known=event.motion is not None,
        displacement=vector(event.motion.displacement_m if event.motion else (0, 0, 0)),
        direction=event.motion.direction or "" if event.motion else "",
        agreement_known=event.agrees is not None,
        agrees=bool(event.agrees),
        sentence=event.sentence,
        **texts,
        **(_acted_on(event.object) if event.object else {}),
    )


def _acted_on(item: ActedObject) -> dict[str, Any]:
    fields: dict[str, Any] = {
        "object_id": str(item.id),
        "object_name": item.name,
        "taken_along": item.taken_along,
        "in_hand_at_end": item.in_hand_at_end,
    }
    if item.pose is not None:
        turned = item.pose.quaternion_xyzw
        fields |= {"position_known": True, "orientation_known": turned is not None}
        fields["object_pose"] = pose(item.pose.position_m, turned)
    if item.fixed_pose is not None:
        fields["fixed_frame"] = item.fixed_pose.frame
        fields["fixed_pose"] = pose(item.fixed_pose.position_m, item.fixed_pose.quaternion_xyzw)
    return fields


def event_json(event: Event, _frame_id: str) -> Any:
    """Return a String: all fields of an event as JSON, in which frames have our names."""
    return made(STRING, data=event.model_dump_json())


def action_intent(intent: Intent, frame_id: str) -> Any:
    """Return an ActionIntent; a text that is not known is empty."""
    return made(
        ACTION_INTENT,
        header=header(intent.stamp_ns, frame_id),
        agent=intent.agent,
        intended=[_contact(each) for each in intent.intended],
        completeness_known=intent.completeness is not None,
        completeness=intent.completeness or 0.0,
        segment_id=intent.segment_id or "",
    )


def _contact(intended: Intended) -> Any:
    return made(
        INTENDED_CONTACT,
        object_id=str(intended.object_id),
        object_name=intended.object_name,
        hand=intended.hand,
        probability=intended.probability,
        soon_probability=intended.soon_probability,
        action=intended.action or "",
        action_probability=intended.action_probability or 0.0,
        contact_s=intended.contact_s,
        contact_std_s=intended.contact_std_s,
        place=vector(intended.place_m, "Point"),
    )
