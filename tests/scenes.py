"""Synthetic scenes for fusion: an actor who stands anywhere and objects around them, known exactly.

Places are given as (right, up, forward) from the middle of the actor's hips, in metres.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum import geometry
from actum.messages import Action, Message, Objects, Posture, TrackedObject
from actum.node import SECOND_NS
from actum.skeletons import INDEX

Array = NDArray[np.float64]
Place = tuple[float, float, float]
Path = Callable[[float], Place]
"""A place at each time in seconds from the segment's start."""

SENSOR = "kinect0"
START_NS = 100 * SECOND_NS
FRAME_NS = 33_333_333
LATER_S = 30.0
NAMES = {1: "cup", 2: "box", 3: "book"}
HEAD: Place = (0.0, 0.75, 0.05)
REST_RIGHT: Place = (0.2, 0.1, 0.2)
REST_LEFT: Place = (-0.2, 0.1, 0.2)
SHOULDER_RIGHT: Place = (0.18, 0.5, 0.0)
SHOULDER_LEFT: Place = (-0.18, 0.5, 0.0)
ELBOW_RIGHT: Place = (0.25, 0.15, -0.05)
ELBOW_LEFT: Place = (-0.25, 0.15, -0.05)
MOVED = ("right_hand", "left_hand", "right_elbow", "left_elbow")


def at(seconds: float) -> int:
    """Give the stamp of a time from the segment's start."""
    return START_NS + round(seconds * SECOND_NS)


def still(place: Place) -> Path:
    return lambda _: place


def moving(*stops: tuple[float, Place]) -> Path:
    """Go in straight lines through (time, place), waiting at the ends."""
    times = [time for time, _ in stops]
    axes = np.array([place for _, place in stops]).T

    def path(time: float) -> Place:
        right, up, forward = (float(np.interp(time, times, axis)) for axis in axes)
        return right, up, forward

    return path


@dataclass(frozen=True)
class Stance:
    """Where the actor stands; heading 0 faces the camera, a positive one turns to the actor's own left."""

    x_m: float = 0.0
    z_m: float = 2.0
    heading_rad: float = 0.0

    @cached_property
    def camera_from_actor(self) -> Array:
        """Maps (right, up, forward) to the camera frame."""
        up = np.array([0.0, -1.0, 0.0])
        forward = np.array([np.sin(self.heading_rad), 0.0, -np.cos(self.heading_rad)])
        camera_from_actor = np.eye(4)
        camera_from_actor[:3, :3] = np.stack([np.cross(forward, up), up, forward], axis=1)
        camera_from_actor[:3, 3] = [self.x_m, 0.3, self.z_m]
        return camera_from_actor

    def camera(self, place: Place) -> list[float]:
        return geometry.apply(self.camera_from_actor, np.array(place)).tolist()


@dataclass(frozen=True)
class Scene:
    """An actor's arms, their leaning torso (rad), and the objects; `hidden` says when an object is covered.

    Where it is then `followed` to, if the tracker follows what covers it.
    """

    right_hand: Path = lambda _: REST_RIGHT
    left_hand: Path = lambda _: REST_LEFT
    right_elbow: Path = lambda _: ELBOW_RIGHT
    left_elbow: Path = lambda _: ELBOW_LEFT
    objects: Mapping[int, Path] = field(default_factory=dict)
    hidden: Callable[[int, float], bool] = lambda _id, _time: False
    followed: Mapping[int, Path] = field(default_factory=dict)
    lean: Callable[[float], float] = lambda _: 0.0
    stance: Stance = Stance()

    def posture(self, seconds: float, seq: int | None = None, agent: int = 1, **fields: Any) -> Posture:
        ego_from_actor = self._ego_from_actor(seconds)
        places = {"head": HEAD, "right_shoulder": SHOULDER_RIGHT, "left_shoulder": SHOULDER_LEFT}
        places |= {name: getattr(self, name)(seconds) for name in MOVED}
        joints: list[list[float] | None] = [[0.0, 0.0, 0.0]] * 15
        for name, joint in zip(places, geometry.apply(ego_from_actor, np.array([*places.values()])), strict=True):
            joints[INDEX[name]] = joint.tolist()
        message = {
            "stamp_ns": at(seconds),
            "seq": seq,
            "sensor": SENSOR,
            "agent": agent,
            "joints_m": joints,
            "joints": joints,
            "ego_from_camera": geometry.flat(ego_from_actor @ geometry.invert(self.stance.camera_from_actor)),
            "motion": [0.0] * 5,
        }
        return Posture.model_validate(message | fields)

    def objects_seen(self, seconds: float, **fields: Any) -> Objects:
        listed = [self._tracked(number, path, seconds) for number, path in self.objects.items()]
        return Objects.model_validate({"stamp_ns": at(seconds), "sensor": SENSOR, "objects": listed} | fields)

    def _tracked(self, number: int, path: Path, seconds: float) -> TrackedObject:
        hidden = self.hidden(number, seconds)
        followed = hidden and number in self.followed
        return TrackedObject(
            id=number,
            name=NAMES[number],
            position_m=self.stance.camera(self.followed[number](seconds) if followed else path(seconds)),
            quaternion_xyzw=[0.0, 0.0, 0.0, 1.0],
            confidence=1.0,
            seen=not hidden,
            followed=followed,
        )

    def postures(self, start_s: float = -1.0, end_s: float = 3.5) -> list[Posture]:
        return [self.posture(t, seq=i) for i, t in enumerate(_times(start_s, end_s, 0.0))]

    def sightings(self, start_s: float = -1.0, end_s: float = 3.5) -> list[Objects]:
        """Give the objects stream: at the postures' rate, between them in time."""
        return [self.objects_seen(t) for t in _times(start_s, end_s, 0.007)]

    def _ego_from_actor(self, seconds: float) -> Array:
        """Ego axes are left, up, forward; leaning turns them about the hips' line and carries them forward."""
        lean = self.lean(seconds)
        ego_from_actor = np.eye(4)
        ego_from_actor[0, 0] = -1.0
        ego_from_actor[1, 1:3] = [np.cos(lean), np.sin(lean)]
        ego_from_actor[2, 1:3] = [-np.sin(lean), np.cos(lean)]
        ego_from_actor[2, 3] = -0.1 * lean
        return ego_from_actor


def action(label: str | None, start_s: float = 0.0, end_s: float | None = 2.0, **fields: Any) -> Action:
    """Make a final action of agent 1's right arm."""
    message = {
        "stamp_ns": at(end_s if end_s is not None else start_s),
        "sensor": SENSOR,
        "agent": 1,
        "segment_id": "s1",
        "start_ns": at(start_s),
        "end_ns": None if end_s is None else at(end_s),
        "final": True,
        "action": label,
        "confidence": 0.94,
        "activations": {},
        "part": "right_arm",
        "frames": 60,
        "missed": 0,
    }
    return Action.model_validate(message | fields)


def rejected_action(reason: str, **fields: Any) -> Action:
    return action(None, **({"valid": False, "reason": reason, "part": None, "confidence": 0.0, "frames": 0} | fields))


def acting_on(
    place: Place, then: Place, hand_above_m: float = 0.08, others: Mapping[int, Place] | None = None, **fields: Any
) -> Scene:
    """Let the right hand reach for the cup in 0.8 s, carry it along until 1.6 s, and hold it there."""
    above = np.array([0.0, hand_above_m, 0.0])
    hand = [tuple((np.array(stop) + above).tolist()) for stop in (place, then)]
    return Scene(
        right_hand=moving((0.0, REST_RIGHT), (0.8, hand[0]), (1.6, hand[1])),
        objects={1: moving((0.8, place), (1.6, then))} | {k: still(v) for k, v in (others or {}).items()},
        **fields,
    )


def _times(start_s: float, end_s: float, offset_s: float) -> list[float]:
    count = round((end_s - start_s) * SECOND_NS / FRAME_NS)
    return [start_s + offset_s + i * FRAME_NS / SECOND_NS for i in range(count)]


def later(message: Message, segment_id: str = "later") -> Message:
    """The same some seconds on, as another segment."""
    shift_ns = round(LATER_S * SECOND_NS)
    stamps = {name: getattr(message, name) + shift_ns for name in ("start_ns", "end_ns") if hasattr(message, name)}
    named = {"segment_id": segment_id} if hasattr(message, "segment_id") else {}
    return message.model_copy(update=stamps | named | {"seq": None, "stamp_ns": message.stamp_ns + shift_ns})
