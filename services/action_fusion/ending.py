"""How an object ended: where it is as the segment ends, and whether the hand that had it has it still."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from action_fusion.carrying import SLIPS_M
from action_fusion.choosing import Choice, Evidence
from action_fusion.comotion import comotion
from action_fusion.hands import HandPath
from action_fusion.samples import Array, ObjectsSample
from action_fusion.settings import Settings
from action_fusion.tracks import SETTLED_NS, Track
from actum import geometry
from actum.messages import ActedObject, Hand, ObjectPose

CAMERA = "camera"


def acted_object(
    found: Evidence,
    choice: Choice,
    paths: Mapping[Hand, HandPath],
    frames: Sequence[ObjectsSample],
    start_ns: int,
    settings: Settings,
) -> ActedObject | None:
    """Describe a chosen object, or a rival of it, as events do; None where no hand is known.

    Args:
        found: the object.
        choice: whose hand and held object it may be in.
        paths: the actor's hands.
        frames: the objects' up to the segment's end.
        start_ns: the segment's start.
        settings: thresholds, and the fixed frame.
    """
    if not math.isfinite(found.distance_m):
        return None
    track, path = found.track, None if choice.hand is None else paths.get(choice.hand)
    held = choice.held is not None and choice.held.id == track.id
    taken_along, in_hand_at_end = (False, False) if path is None else in_hand(track, path, held, settings)
    pose = end_pose(track, frames)
    world = settings.fixed_from_camera
    return ActedObject(
        id=track.id,
        name=track.name,
        distance_m=found.distance_m,
        carried=track.carried,
        taken_along=taken_along,
        in_hand_at_end=in_hand_at_end,
        last_seen_ns=start_ns + int(track.stamps_ns[track.seen][-1]) if track.seen.any() else None,
        pose=pose,
        fixed_pose=None if world is None else in_fixed_frame(pose, world, settings.world_frame),
    )


def in_hand(track: Track, path: HandPath, held: bool, settings: Settings) -> tuple[bool, bool]:
    """Tell whether the hand took the object along in the segment, and whether it is in the hand as that ends.

    That is where its place in the hand is then what it was while it was taken along or, for one that was `held`
    still, all the time.
    """
    pair = comotion(path, track, settings.reach_m, settings.moved_m)
    inside = path.stamps_ns >= 0
    taken_along = pair.moved_by_hand_m(since_ns=0.0) >= settings.moved_m
    had = inside & pair.with_hand if taken_along else inside & held
    if not had.any():
        return taken_along, False
    last = inside & (path.stamps_ns >= path.stamps_ns[-1] - SETTLED_NS)
    slipped = np.median(pair.relative_m[last], axis=0) - np.median(pair.relative_m[had], axis=0)
    return taken_along, float(np.linalg.norm(slipped)) <= SLIPS_M


def end_pose(track: Track, frames: Sequence[ObjectsSample]) -> ObjectPose:
    """Give the object's pose at the end in the camera frame; its orientation if no hand moved it unseen since."""
    seen = (f.quaternions_xyzw[track.id] for f in reversed(frames) if track.id in f.quaternions_xyzw)
    turned = next(seen, None) if track.seen[-1] else None
    return ObjectPose(
        frame=CAMERA,
        position_m=(track.end() - track.brought_m).tolist(),
        quaternion_xyzw=None if turned is None else turned.tolist(),
    )


def in_fixed_frame(pose: ObjectPose, world_from_camera: Array, name: str) -> ObjectPose:
    """Bring a pose from the camera frame into a fixed one (world_from_camera (4, 4))."""
    turned = pose.quaternion_xyzw
    return ObjectPose(
        frame=name,
        position_m=geometry.apply(world_from_camera, np.array(pose.position_m)).tolist(),
        quaternion_xyzw=None if turned is None else geometry.rotated_xyzw(world_from_camera, np.array(turned)).tolist(),
    )
