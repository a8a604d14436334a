"""An object as events describe it: its pose at the segment's end, and whether the acting hands still hold it."""

from collections.abc import Sequence

import numpy as np

from action_fusion.choice.evidence import Choice, Evidence
from action_fusion.intake.stream_samples import ObjectsSample
from action_fusion.settings import Settings
from action_fusion.tracks.comotion import comotion
from action_fusion.tracks.hand_tracks import HandTrack
from action_fusion.tracks.object_tracks import SETTLED_NS, ObjectTrack
from action_fusion.tracks.occlusion import SLIP_M
from actum import geometry
from actum.arrays import median
from actum.messages import ActedObject, ObjectPose


def acted_object(
    track: ObjectTrack, choice: Choice, evidence: Evidence, frames: Sequence[ObjectsSample]
) -> ActedObject:
    """Describe a chosen object or one of its rivals as events do; `frames` reach up to the segment's end."""
    hands = [evidence.hands.own[side] for side in choice.hands if side in evidence.hands.own]
    is_held = choice.held is not None and choice.held.id == track.id
    in_hands = [_in_hand(track, hand, is_held, evidence.settings) for hand in hands]
    pose = _end_pose(track, frames)
    return ActedObject(
        id=track.id,
        name=track.name,
        distance_m=next(one.distance_m for one in evidence.near if one.track is track),
        carried=not track.seen[track.stamps_ns >= 0].all(),
        taken_along=any(taken_along for taken_along, _ in in_hands),
        in_hand_at_end=any(in_hand_at_end for _, in_hand_at_end in in_hands),
        last_seen_ns=evidence.action.start_ns + int(track.stamps_ns[track.seen][-1]) if track.seen.any() else None,
        pose=pose,
        fixed_pose=_in_fixed_frame(pose, evidence.settings),
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
    slip_m = median(pair.hand_to_object_m[last]) - median(pair.hand_to_object_m[in_hand])
    return taken_along, float(np.linalg.norm(slip_m)) <= SLIP_M


def _end_pose(track: ObjectTrack, frames: Sequence[ObjectsSample]) -> ObjectPose:
    """Return the object's pose at the end in the camera frame, with its orientation only if it is visible then."""
    quaternions = (f.quaternions_xyzw[track.id] for f in reversed(frames) if track.id in f.quaternions_xyzw)
    quaternion = next(quaternions, None) if track.seen[-1] else None
    return ObjectPose(
        frame="camera",
        position_m=(track.end_m - track.depth_shift_m).tolist(),
        quaternion_xyzw=quaternion,
    )


def _in_fixed_frame(pose: ObjectPose, settings: Settings) -> ObjectPose | None:
    """Map a pose from the camera frame to the fixed one; None where the settings have none."""
    fixed_from_camera, xyzw = settings.fixed_from_camera, pose.quaternion_xyzw
    if fixed_from_camera is None:
        return None
    return ObjectPose(
        frame=settings.world_frame,
        position_m=geometry.apply(fixed_from_camera, np.array(pose.position_m)).tolist(),
        quaternion_xyzw=None if xyzw is None else geometry.rotated_xyzw(fixed_from_camera, np.array(xyzw)).tolist(),
    )
