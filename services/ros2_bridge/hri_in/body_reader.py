"""Reads what other ROS 2 nodes publish about bodies, counts what cannot be used, and reports what is missing."""

import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from actum.bridge import Foreign
from actum.messages import Skeleton
from actum.node import SECOND_NS, Counters, Tick
from actum.states import State
from ros2_bridge import topics
from ros2_bridge.hri.placements import placement
from ros2_bridge.hri_in.description import BadDescriptionError, links_of
from ros2_bridge.hri_in.skeleton_assembler import SkeletonAssembler
from ros2_bridge.hri_in.transform_tree import Edge
from ros2_bridge.message_types import NotThatTypeError, from_cdr
from ros2_bridge.topics import RosTopic

MOST_BYTES = 250_000
"""A longer payload is not read (bytes): two thousand transforms."""
FURTHEST_M = 1e6
"""Largest coordinate of a frame in its parent (m): maps of cities are larger than rooms, and nothing is further."""
LONGEST_NAME = 256
"""Most characters of a frame's name: thousands of names are kept."""
BODY_ID = re.compile(r"[A-Za-z0-9_]{1,64}")
"""The id of a body: it is part of the names of topics."""
REVIEW_NS = 2 * SECOND_NS
"""How often what is missing is reported (ns), of the time since the last report."""
REMEDY_2D = (
    "have only points in the image (skeleton2d) and no depth, so that no skeletons are made of them: have the body "
    "detector use a depth camera and publish joint_states or frames of the joints on /tf, such as hri_fullbody with "
    "use_depth"
)
"""Why bodies without depth are left out, and what to do."""


class BodyReader:
    """Makes skeletons of the topics of bodies.

    Args:
        sensor: the sensor that the skeletons are of.
        optical_frame: the frame of the camera in which they are expressed.
        counters: of the bridge.
    """

    def __init__(self, sensor: str, optical_frame: str, counters: Counters) -> None:
        self._counters, self._optical_frame = counters, _frame(optical_frame)
        self._assembler = SkeletonAssembler(sensor, self._optical_frame, counters)
        self._tree = self._assembler.tree
        self._was_told_ids = self._heard = False
        self._reviewed_ns: int | None = None
        counters.details["source"] = f"ROS 2, bodies of ROS4HRI in the frame {optical_frame}"
        self._readers: dict[RosTopic, Callable[[Any, Foreign], Iterable[Skeleton]]] = {
            topics.OTHERS_TRACKED: self._ids,
            topics.OTHERS_TF: self._transforms,
            topics.OTHERS_TF_STATIC: self._fixed_transforms,
            topics.OTHERS_JOINT_STATES: self._joint_states,
            topics.OTHERS_SKELETON_2D: self._points,
            topics.OTHERS_URDF: self._description,
        }
        self._by_name = {topic.name: topic for topic in self._readers}

    def begin(self, session: str) -> None:
        """Name the run of the source, in which bodies are numbered from 1."""
        self._assembler.session = session

    def receive(self, foreign: Foreign) -> Iterable[Skeleton]:
        """Take one payload, and return the skeletons that are complete by it."""
        topic, size = self._by_name[foreign.topic], len(foreign.payload)
        if size > MOST_BYTES:
            detail = f"a message on {topic.name} has {size} bytes; at most {MOST_BYTES} bytes are allowed"
            self._counters.reject("bad_body_message", detail)
            return []
        try:
            message = from_cdr(foreign.payload, topic.type)
        except NotThatTypeError as error:
            self._counters.reject("bad_body_message", f"a message on {topic.name} is not a valid {topic.type}: {error}")
            return []
        skeletons = list(self._readers[topic](message, foreign))
        self._counters.counts["skeletons"] += len(skeletons)
        return skeletons

    def tick(self, tick: Tick) -> None:
        """Report now and then, in the bridge's state, what keeps bodies from becoming skeletons."""
        if self._reviewed_ns is None:
            self._reviewed_ns = tick.monotonic_ns
        elif tick.monotonic_ns - self._reviewed_ns >= REVIEW_NS:
            self._reviewed_ns = tick.monotonic_ns
            remark = self._remark()
            self._counters.state = State.RUNNING.noting(remark) if remark else State.RUNNING

    def _remark(self) -> str | None:
        """Return what has been missing since the last time; None where nothing was."""
        heard, self._heard = self._heard, False
        flat: list[str] = []
        hidden: list[str] = []
        for body_id, body in self._assembler.bodies.items():
            if not body.has_3d:
                (flat if body.has_2d else hidden).append(body_id)
            body.has_3d = body.has_2d = False
        if not self._was_told_ids:
            return "nobody publishes /humans/bodies/tracked: start a body detector of ROS4HRI, such as hri_fullbody"
        if flat:
            return f"the bodies {', '.join(flat)} {REMEDY_2D}"
        if hidden and not heard:
            return f"nothing is published any more about the bodies {', '.join(hidden)}: check that their detector runs"
        if hidden:
            return (
                f"no transforms lead from the joints of the bodies {', '.join(hidden)} to the frame "
                f"{self._optical_frame}: set --ros-frame-id to the optical frame of the camera that sees them, as /tf "
                "names it, and have their detector publish frames of the joints on /tf, or joint_states and the frame "
                "body_<id>"
            )
        return None

    def _ids(self, message: Any, _foreign: Foreign) -> Iterator[Skeleton]:
        self._was_told_ids = self._heard = True
        for bad in (each for each in message.ids if not BODY_ID.fullmatch(each)):
            self._counters.reject("bad_body_id", f"{bad!r}: letters, digits and '_' are allowed, 64 at most")
        ids = list(dict.fromkeys(each for each in message.ids if BODY_ID.fullmatch(each)))
        yield from self._assembler.track(self._stamp_ns(message.header), ids)

    def _transforms(self, message: Any, _foreign: Foreign) -> Iterator[Skeleton]:
        touched: dict[int, dict[str, None]] = {}
        for each in message.transforms:
            stamp_ns, edge, child = self._stamp_ns(each.header), self._edge(each), _frame(each.child_frame_id)
            if stamp_ns is None or edge is None:
                continue
            self._tree.put(child, stamp_ns, edge)
            body_id = self._assembler.owner(child)
            if body_id is not None:
                touched.setdefault(stamp_ns, {})[body_id] = None
                self._heard = True
        for stamp_ns, ids in sorted(touched.items()):
            yield from self._assembler.advance(stamp_ns, list(ids))

    def _fixed_transforms(self, message: Any, _foreign: Foreign) -> Iterable[Skeleton]:
        for each in message.transforms:
            edge = self._edge(each)
            if edge is not None:
                self._tree.put_fixed(_frame(each.child_frame_id), edge)
        return []

    def _joint_states(self, message: Any, foreign: Foreign) -> Iterator[Skeleton]:
        body_id, stamp_ns = _body_id(foreign), self._stamp_ns(message.header)
        body = self._assembler.bodies.get(body_id)
        if body is not None and stamp_ns is not None:
            self._heard = True
            body.take_positions(stamp_ns, message.name, [float(each) for each in message.position])
            yield from self._assembler.advance(stamp_ns, [body_id])

    def _points(self, _message: Any, foreign: Foreign) -> Iterable[Skeleton]:
        body = self._assembler.bodies.get(_body_id(foreign))
        if body is not None:
            body.has_2d = True
        return []

    def _description(self, message: Any, foreign: Foreign) -> Iterable[Skeleton]:
        body_id = _body_id(foreign)
        try:
            self._assembler.describe(body_id, links_of(message.data, body_id))
        except BadDescriptionError as error:
            self._counters.reject("bad_body_description", f"body {body_id}: {error}")
        return []

    def _stamp_ns(self, header: Any) -> int | None:
        """Return a header's stamp (ns); None, and count it, where it is not set."""
        stamp_ns: int = header.stamp.sec * SECOND_NS + header.stamp.nanosec
        if stamp_ns > 0:
            return stamp_ns
        self._counters.reject("bad_body_stamp", f"{stamp_ns} ns in the frame {header.frame_id!r}: set header.stamp")
        return None

    def _edge(self, transform: Any) -> Edge | None:
        """Return a transform; None, and count it, where it is no rigid one or the frames' names are too long."""
        lengths = len(transform.child_frame_id), len(transform.header.frame_id)
        if max(lengths) > LONGEST_NAME:
            detail = f"the names of the frame and its parent have {lengths[0]} and {lengths[1]} characters"
            self._counters.reject("bad_transform", f"{detail}; at most {LONGEST_NAME} are allowed")
            return None
        at, turn = transform.transform.translation, transform.transform.rotation
        placed = placement((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w), FURTHEST_M)
        if placed is None:
            detail = f"{transform.child_frame_id!r} in {transform.header.frame_id!r}"
            self._counters.reject("bad_transform", f"{detail}: {at.x, at.y, at.z} m, {turn.x, turn.y, turn.z, turn.w}")
            return None
        return Edge(_frame(transform.header.frame_id), placed)


def _frame(name: str) -> str:
    """Return a frame's name as tf2 has it."""
    return name.removeprefix("/")


def _body_id(foreign: Foreign) -> str:
    """Return the id of the body whose topic it is: `<domain>/humans/bodies/<id>/…`."""
    return foreign.key.split("/")[3]
