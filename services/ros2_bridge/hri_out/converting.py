"""ROS4HRI's messages about bodies and persons."""

import json
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from actum.messages import Event
from ros2_bridge.frames import header, ros_time, transform, transform_xyzw
from ros2_bridge.hri import types as hri
from ros2_bridge.hri_out.body import Body
from ros2_bridge.hri_out.mapping import INDEPENDENT, LEFT, RIGHT, GestureRule, IntentRule
from ros2_bridge.hri_out.present import Human
from ros2_bridge.message_types import PERSON_ACTION, made

PERSON, BODY = 1, 3
"""The constants of hri_msgs/IdsMatch for kinds of ids."""
MOTION = "__modality_motion__"
"""The constant of hri_actions_msgs/Intent for gestures and other movements."""
USUAL_PRIORITY = 128
"""The default priority of hri_actions_msgs/Intent, of 255."""
HANDS = {"right": RIGHT, "left": LEFT, None: INDEPENDENT}
"""The constants of hri_msgs/Gesture by our words for hands."""
NEAR_THE_HEAD = ("head", "torso")
"""The links at which a person's frame lies, in this order; the body's own frame where neither is known."""


def ids_list(of: Any, ids: Iterable[str]) -> Any:
    """Return an IdsList."""
    return made(hri.IDS_LIST, header=of, ids=list(ids))


def match(human: Human, confidence: float) -> Any:
    """Return an IdsMatch of body and person; the confidence is 1, or 0 once they are gone."""
    return made(hri.IDS_MATCH, id1=human.body, id1_type=BODY, id2=human.person, id2_type=PERSON, confidence=confidence)


def joint_states(of: Any, human: Human, body: Body) -> Any:
    """Return a JointState with the joints of the person's own model that are observed, and no others."""
    names = [f"{joint}_{human.body}" for joint in (*body.angles, *body.shifts_m)]
    positions = np.array([*body.angles.values(), *body.shifts_m.values()])
    return made(hri.JOINT_STATE, header=of, name=names, position=positions)


def frames(of: Any, human: Human, body: Body, links: bool, person: bool) -> Iterator[Any]:
    """Yield the transforms of a body: its frame, the known links' in that, and the person's near the head."""
    own = f"body_{human.body}"
    yield transform(of, own, body.optical_from_body[:3, 3], body.optical_from_body[:3, :3])
    in_body = made("std_msgs/msg/Header", stamp=of.stamp, frame_id=own)
    if links:
        for link, (place, xyzw) in body.links.items():
            yield transform_xyzw(in_body, f"{link}_{human.body}", place, xyzw)
    if person:
        at = next((body.links[link] for link in NEAR_THE_HEAD if link in body.links), ((0, 0, 0), (0, 0, 0, 1)))
        yield transform_xyzw(in_body, f"person_{human.person}", *at)


def gesture(event: Event, rule: GestureRule, frame_id: str) -> Any:
    """Return a Gesture of an event that the mapping calls one."""
    hand = HANDS[rule.hand or event.hand]
    return made(hri.GESTURE, header=header(event.stamp_ns, frame_id), gesture=rule.gesture.value, handedness=hand)


def person_action(event: Event, frame_id: str) -> Any:
    """Return a PersonAction of an event whose action is known."""
    return made(
        PERSON_ACTION,
        header=header(event.stamp_ns, frame_id),
        label=event.action,
        confidence=event.confidence,
        unknown=event.unknown,
        object_id=str(event.object.id) if event.object else "",
        object_name=event.object.name if event.object else "",
        start=ros_time(event.start_ns),
        end=ros_time(event.end_ns),
        result=event.result or "",
    )


def intent(event: Event, rule: IntentRule, person: str) -> Any | None:
    """Return an Intent of an event that the mapping calls one; None where it needs an object and there is none."""
    data = rule.data(event, person)
    if data is None:
        return None
    return made(
        hri.INTENT,
        intent=rule.intent,
        data=json.dumps(data),
        source=person,
        modality=MOTION,
        priority=USUAL_PRIORITY,
        confidence=event.confidence,
    )
