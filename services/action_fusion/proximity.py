"""How near the hands came to an object, and how well the arm points at it (paper, section 2.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.samples import Array, PostureSample
from action_fusion.tracks import Track
from actum.messages import Hand
from actum.skeletons import INDEX

HOLDING_SHARE = 1 / 3
"""The last part of a pointing action, in which the arm is out."""

POINTING_M = 0.08
"""As long as the fingertip is this near to where it is in that part, the arm is out: a joint's noise is a third."""

FINGER_M = 0.10
"""How far the stretched index finger ends beyond the hand joint, on the line of the forearm."""

ARMS: dict[Hand, tuple[int, int]] = {
    "right": (INDEX["right_elbow"], INDEX["right_hand"]),
    "left": (INDEX["left_elbow"], INDEX["left_hand"]),
}
SHOULDERS: dict[Hand, int] = {"right": INDEX["right_shoulder"], "left": INDEX["left_shoulder"]}


_SMALLEST_M = 1e-9


@dataclass(frozen=True)
class Actor:
    """A segment's p valid postures: rotation and translation of ego_from_camera, joints (p, 15, 3) in the ego frame."""

    stamps_ns: Array
    rotations: Array
    translations: Array
    joints_m: Array

    def view(self, track: Track) -> Array:
        """Bring an object into the egocentric frame of each posture, at its capture time: (p, 3)."""
        positions = track.at(self.stamps_ns)
        moved: Array = np.einsum("pij,pj->pi", self.rotations, positions) + self.translations
        return moved

    def head(self) -> Array:
        """Return the head's path (p, 3)."""
        return self.joints_m[:, INDEX["head"]]

    def hand(self, hand: Hand) -> Array:
        """Return a hand's path (p, 3)."""
        return self.joints_m[:, ARMS[hand][1]]

    def shoulder(self, hand: Hand) -> Array:
        """Return the path (p, 3) of a hand's shoulder."""
        return self.joints_m[:, SHOULDERS[hand]]

    def fingertip(self, hand: Hand) -> Array:
        """Return where the hand's stretched index finger ends (p, 3)."""
        elbow, wrist = self.joints_m[:, ARMS[hand][0]], self.hand(hand)
        forearm = wrist - elbow
        length = np.linalg.norm(forearm, axis=1, keepdims=True)
        tip: Array = wrist + FINGER_M * forearm / np.maximum(length, _SMALLEST_M)
        return tip


def actor(postures: Sequence[PostureSample], start_ns: int) -> Actor | None:
    """Stack a segment's valid postures; None where there is none. Stamps count from `start_ns`."""
    stamped = [(sample.stamp_ns - start_ns, sample.body) for sample in postures if sample.body is not None]
    if not stamped:
        return None
    frames = np.stack([body.ego_from_camera for _, body in stamped])
    stamps_ns = np.array([stamp for stamp, _ in stamped], dtype=np.float64)
    return Actor(stamps_ns, frames[:, :3, :3], frames[:, :3, 3], np.stack([body.joints_m for _, body in stamped]))


def smallest_distance(object_ego: Array, hand_ego: Array) -> float:
    """Compute min over the segment of PM = ||O - hand||_2 in metres; infinite where the hand is never known.

    Both are (T, 3) in the actor's egocentric frame, NaN where unknown.
    """
    distances = np.linalg.norm(object_ego - hand_ego, axis=1)
    return float(np.nanmin(distances)) if np.isfinite(distances).any() else np.inf


def pointing_hand(actor: Actor, hands: Sequence[Hand]) -> Hand:
    """Name the hand whose finger is furthest from the line of hips and head, the median over the action's last part."""
    return max(hands, key=lambda hand: _outstretched_m(actor, hand))


def _outstretched_m(actor: Actor, hand: Hand) -> float:
    fingertip, head = actor.fingertip(hand), actor.head()
    known = np.flatnonzero(np.isfinite(fingertip + head).all(axis=1))
    held = known[-max(1, round(len(known) * HOLDING_SHARE)) :]
    if not len(held):
        return -np.inf
    aside = np.linalg.norm(np.cross(fingertip[held], head[held]), axis=1)
    return float(np.median(aside / np.maximum(np.linalg.norm(head[held], axis=1), _SMALLEST_M)))


def pointing_angle(object_ego: Array, tip_ego: Array, origin_ego: Array) -> float:
    """Compute the angle (rad) between origin-to-tip and origin-to-object, each the median while the arm is out.

    Infinite where origin and tip are never known together.
    """
    known = np.flatnonzero(np.isfinite(tip_ego + origin_ego).all(axis=1))
    held = known[-max(1, round(len(known) * HOLDING_SHARE)) :]
    if not len(held):
        return np.inf
    rays, sights = tip_ego[known] - origin_ego[known], object_ego[known] - origin_ego[known]
    last = np.median(rays[-len(held) :], axis=0)
    out = np.linalg.norm(rays - last, axis=1) <= POINTING_M
    ray, sight = (np.median(rays[out], axis=0), np.median(sights[out], axis=0)) if out.any() else (last, sights[-1])
    length = float(np.linalg.norm(ray) * np.linalg.norm(sight))
    return float(np.arccos(np.clip(ray @ sight / max(length, _SMALLEST_M), -1.0, 1.0)))
