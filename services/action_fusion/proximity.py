"""How near the hands came to an object, and how well the arm points at it (paper, section 2.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.samples import Array, Body, PostureSample
from action_fusion.tracks import Track
from actum.messages import Hand

HOLDING_SHARE = 1 / 3
"""The last part of a pointing action, in which the arm is out."""


@dataclass(frozen=True)
class Actor:
    """A segment's valid postures as arrays: rotation and translation of ego_from_camera, joints in the ego frame."""

    stamps_ns: Array
    rotations: Array
    translations: Array
    head: Array
    hands: dict[Hand, Array]

    def view(self, track: Track) -> Array:
        """Bring an object into the actor's egocentric frame of each posture, at its capture time: (p, 3)."""
        positions = track.at(self.stamps_ns)
        moved: Array = np.einsum("pij,pj->pi", self.rotations, positions) + self.translations
        return moved


def actor(postures: Sequence[PostureSample], start_ns: int, hands: Sequence[Hand]) -> Actor | None:
    """Stack a segment's valid postures; None where there is none. Stamps count from `start_ns`."""
    stamped = [(sample.stamp_ns - start_ns, sample.body) for sample in postures if sample.body is not None]
    if not stamped:
        return None
    bodies = [body for _, body in stamped]
    return Actor(
        np.array([stamp for stamp, _ in stamped], dtype=np.float64),
        np.stack([body.ego_from_camera[:3, :3] for body in bodies]),
        np.stack([body.ego_from_camera[:3, 3] for body in bodies]),
        np.stack([body.head for body in bodies]),
        {hand: np.stack([_hand(body, hand) for body in bodies]) for hand in hands},
    )


def smallest_distance(object_ego: Array, hand_ego: Array) -> float:
    """Compute min over the segment of PM = ||O - hand||_2 in metres; infinite where the hand is never known."""
    distances = np.linalg.norm(object_ego - hand_ego, axis=1)
    return float(np.nanmin(distances)) if np.isfinite(distances).any() else np.inf


def pointing_angle(object_ego: Array, hand_ego: Array, head_ego: Array) -> float:
    """Compute the median angle (rad) between head-to-hand and head-to-object over the segment's last part.

    Infinite where head and hand are never known together.
    """
    known = np.isfinite(hand_ego).all(axis=1) & np.isfinite(head_ego).all(axis=1)
    held = np.flatnonzero(known)
    held = held[-max(1, round(len(held) * HOLDING_SHARE)) :]
    if not len(held):
        return np.inf
    ray, sight = hand_ego[held] - head_ego[held], object_ego[held] - head_ego[held]
    lengths = np.linalg.norm(ray, axis=1) * np.linalg.norm(sight, axis=1)
    cosines = np.einsum("ij,ij->i", ray, sight) / np.maximum(lengths, 1e-9)
    return float(np.median(np.arccos(np.clip(cosines, -1.0, 1.0))))


def _hand(body: Body, hand: Hand) -> Array:
    return body.left_hand if hand == "left" else body.right_hand
