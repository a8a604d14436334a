"""The actor of a segment: one person's postures as arrays, and the hands that may have acted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.stream_samples import PostureSample
from actum.arrays import Array, Mask
from actum.messages import Action, Hand
from actum.node import SECOND_NS
from actum.skeletons import INDEX

BOTH_HANDS: tuple[Hand, Hand] = ("right", "left")

PART_HANDS: dict[str | None, Hand] = {"right_arm": "right", "left_arm": "left"}
"""Hand of each arm, by the name of the body part that moved most."""

FACING_NS = 2 * SECOND_NS
"""Nanoseconds from the start over which the facing direction is averaged: in one posture it is degrees off."""

SMALLEST_FORWARD = 1e-3
"""Least horizontal length of a unit vector: one with less points up or down within 0.06 degrees."""


@dataclass(frozen=True)
class Actor:
    """One person's p valid postures, from some time before a segment to its end.

    `stamps_ns` (p,) count from the segment's start, `ego_from_camera` is (p, 4, 4), `joints_m` (p, 15, 3) egocentric,
    NaN where unknown. `depth_std_m` (p,), `up_in_camera` (p, 3) and `has_front` (p,) are those of `Body`.
    """

    stamps_ns: Array
    ego_from_camera: Array
    joints_m: Array
    depth_std_m: Array
    up_in_camera: Array
    has_front: Mask

    def in_segment(self) -> "Actor":
        """Return an actor with the postures of the segment itself, without the time before it."""
        inside = self.stamps_ns >= 0
        return Actor(
            self.stamps_ns[inside],
            self.ego_from_camera[inside],
            self.joints_m[inside],
            self.depth_std_m[inside],
            self.up_in_camera[inside],
            self.has_front[inside],
        )

    def joint_m(self, name: str) -> Array:
        """Return a joint's positions (p, 3), egocentric."""
        return self.joints_m[:, INDEX[name]]

    def hand_m(self, side: Hand) -> Array:
        """Return a hand's positions (p, 3), egocentric."""
        return self.joint_m(f"{side}_hand")

    def hand_in_camera_m(self, side: Hand) -> Array:
        """Return a hand's positions (p, 3) in the camera frame."""
        rotations, translations = self.ego_from_camera[:, :3, :3], self.ego_from_camera[:, :3, 3]
        positions_m: Array = np.einsum("pji,pj->pi", rotations, self.hand_m(side) - translations)
        return positions_m

    def to_ego(self, positions_m: Array) -> Array:
        """Map one camera-frame position for each posture (p, 3) to that posture's egocentric frame (p, 3)."""
        rotations, translations = self.ego_from_camera[:, :3, :3], self.ego_from_camera[:, :3, 3]
        in_ego_m: Array = np.einsum("pij,pj->pi", rotations, positions_m) + translations
        return in_ego_m

    def median_depth_std_m(self) -> float:
        """Return the median standard deviation of the body's distance from the camera; 0 if that is measured."""
        return float(np.median(self.depth_std_m)) if len(self.depth_std_m) else 0.0

    def level_from_camera(self) -> Array | None:
        """Build the actor's level frame as a rotation (3, 3): rows right, up, forward in the camera frame.

        Up is against gravity at the first posture; forward is the facing direction, averaged over `FACING_NS` and
        projected onto the horizontal; right = forward x up. None where the actor faces straight up or down.
        """
        up = self.up_in_camera[0] / np.linalg.norm(self.up_in_camera[0])
        early = self.stamps_ns <= self.stamps_ns[0] + FACING_NS
        facing = np.mean(self.ego_from_camera[early, 2, :3], axis=0)
        horizontal = facing - (facing @ up) * up
        length = float(np.linalg.norm(horizontal))
        if length < SMALLEST_FORWARD:
            return None
        forward = horizontal / length
        return np.stack([np.cross(forward, up), up, forward])


def actor_of(postures: Sequence[PostureSample], start_ns: int) -> Actor:
    """Stack a person's valid postures; there may be none (p = 0). Stamps count from `start_ns`."""
    stamped = [(sample.stamp_ns - start_ns, sample.body) for sample in postures if sample.body is not None]
    bodies = [body for _, body in stamped]
    return Actor(
        np.array([stamp for stamp, _ in stamped], dtype=np.float64),
        np.array([body.ego_from_camera for body in bodies]).reshape(-1, 4, 4),
        np.array([body.joints_m for body in bodies]).reshape(-1, len(INDEX), 3),
        np.array([body.depth_std_m for body in bodies], dtype=np.float64),
        np.array([body.up_in_camera for body in bodies]).reshape(-1, 3),
        np.array([body.has_front for body in bodies], dtype=bool),
    )


def acting_sides(action: Action) -> tuple[Hand, ...]:
    """List the hands that may have acted: the one that the mark names, else that of the moving arm, else both."""
    side = action.hand or PART_HANDS.get(action.part)
    return BOTH_HANDS if side is None else (side,)
