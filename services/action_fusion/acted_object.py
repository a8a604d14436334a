"""An object as events describe it: its pose at the segment's end, and whether the acting hand still holds it."""

from collections.abc import Mapping, Sequence

import numpy as np

from action_fusion.choice import Choice
from action_fusion.comotion import comotion
from action_fusion.hand_tracks import HandTrack
from action_fusion.object_tracks import SETTLED_NS, ObjectTrack
from action_fusion.occlusion import SLIP_M
from action_fusion.settings import Settings
from action_fusion.stream_samples import ObjectsSample
from actum import geometry
from actum.arrays import Array
from actum.messages import ActedObject, Hand, ObjectPose

CAMERA = "camera"
"""Name of the camera frame in events."""


def acted_object(
    track: ObjectTrack,
    distance_m: float,
    choice: Choice,
    hands: Mapping[Hand, HandTrack],
    frames: Sequence[ObjectsSample],
    start_ns: int,
    settings: Settings,
) -> ActedObject:
    """Describe a chosen object or one of its rivals as events do.

    Args:
        track: the object's track.
        distance_m: the smallest distance of a hand to the object.
        choice: the hand that acted, and the object held in it.
        hands: the tracks of the actor's hands.
        frames: the samples of objects up to the segment's end.
        start_ns: the segment's start.
        settings: thresholds, and the fixed frame.
    """
    hand = None if choice.hand is None else hands.get(choice.hand)
    is_held = choice.held is not None and choice.held.id == track.id
    taken_along, in_hand_at_end = (False, False) if hand is None else _in_hand(track, hand, is_held, settings)
    pose = _end_pose(track, frames)
    world_from_camera = settings.fixed_from_camera
    return ActedObject(
        id=track.id,
        name=track.name,
        distance_m=distance_m,
        carried=track.is_occluded,
        taken_along=taken_along,
        in_hand_at_end=in_hand_at_end,
        last_seen_ns=start_ns + int(track.stamps_ns[track.seen][-1]) if track.seen.any() else None,
        pose=pose,
        fixed_pose=None
        if world_from_camera is None
        else _in_fixed_frame(pose, world_from_camera, settings.world_frame),
    )


def _in_hand(track: ObjectTrack, hand: HandTrack, is_held: bool, settings: Settings) -> tuple[bool, bool]:
    """Tell whether the hand took the object along in the segment, and whether it holds the object at the segment's end.

    The object is in the hand at the end if its offset from the hand is then the same as while it was taken along or,
    if it was held without motion, as in the whole segment.
    """
    pair = comotion(hand, track, settings.reach_m, settings.moved_m)
    taken_along = pair.transport_m(since_ns=0.0) >= settings.moved_m
    in_hand = hand.in_segment & (pair.with_hand if taken_along else is_held)
    if not in_hand.any():
        return taken_along, False
    last = hand.in_segment & (hand.stamps_ns >= hand.stamps_ns[-1] - SETTLED_NS)
    slip_m = np.median(pair.hand_to_object_m[last], axis=0) - np.median(pair.hand_to_object_m[in_hand], axis=0)
    return taken_along, float(np.linalg.norm(slip_m)) <= SLIP_M


def _end_pose(track: ObjectTrack, frames: Sequence[ObjectsSample]) -> ObjectPose:
    """Return the object's pose at the end in the camera frame, with its orientation only if it is visible then."""
    quaternions = (f.quaternions_xyzw[track.id] for f in reversed(frames) if track.id in f.quaternions_xyzw)
    quaternion = next(quaternions, None) if track.seen[-1] else None
    return ObjectPose(
        frame=CAMERA,
        position_m=(track.end_m() - track.depth_shift_m).tolist(),
        quaternion_xyzw=None if quaternion is None else quaternion.tolist(),
    )


def _in_fixed_frame(pose: ObjectPose, world_from_camera: Array, name: str) -> ObjectPose:
    """Map a pose from the camera frame to a fixed one by `world_from_camera` (4, 4)."""
    xyzw = pose.quaternion_xyzw
    return ObjectPose(
        frame=name,
        position_m=geometry.apply(world_from_camera, np.array(pose.position_m)).tolist(),
        quaternion_xyzw=None if xyzw is None else geometry.rotated_xyzw(world_from_camera, np.array(xyzw)).tolist(),
    )
