"""How each hand approaches each object at an instant: the numbers by which contacts are foreseen."""

from typing import NamedTuple

import numpy as np

from action_fusion.intent.recent_paths import RecentArms, RecentObjects
from actum.arrays import Array
from actum.node import SECOND_NS

HAND_S = (0.1, 0.2, 0.4, 0.8)
"""Over how long the hand's way to an object is measured (s): from its newest turn to the whole reach."""
ELBOW_S = (0.2, 0.5)
"""The same of the elbow, which moves with the hand and is seen better."""
TURN_S = 0.5
"""Over how long the shoulders' turn is measured (s)."""
OBJECT_S = 0.3
"""Over how long an object's own speed is measured (s): what is in a hand moves."""
AHEAD_S = 0.3
"""How far ahead (s) the hand is thought to go on as it does."""
SHORT_M = 0.02
"""A hand's way (m) that is no more than noise, and has no direction."""
NEAR_M = 0.03
"""Added to a distance before its logarithm is taken (m)."""
MOVES_MPS, IN_HAND_M = 0.1, 0.17
"""An object faster than this (m/s) moves: trackers' noise is less. It moves in a hand whose joint is so near (m) to its
middle, as in the recordings learnt from."""
SMALLEST_M = 1e-9
"""A hand nearer to an object's middle (m) is in no direction from it."""
FASTEST_MPS = 1.0
"""Speed (m/s) above which an object simply is fast."""
HIDDEN = 4
"""Features of elbow and shoulders, which are 0 where these are not known."""
FEATURES = 2 + 2 * len(HAND_S) + 2 + 2 + 2 + HIDDEN
"""Numbers of a hand and an object."""
DELAYS_NS = (np.array([0.0, *HAND_S, *ELBOW_S, TURN_S]) * SECOND_NS).astype(np.int64)


class Approach(NamedTuple):
    """The approach of both hands to n objects at a stamp.

    Attributes:
        names: the objects' names by their number, in the order of the arrays.
        joints_m: (instants, joints, 3), the arms in the camera frame at `DELAYS_NS`.
        objects_m: (n, 3), the objects' middles in the camera frame.
        apart_m: (2, n, 3), from right and left hand to each object.
        distances_m: (2, n), their lengths; NaN where a hand is not known.
        speeds_mps: (n,), the objects' speeds, `FASTEST_MPS` at the most.
    """

    names: dict[int, str]
    joints_m: Array
    objects_m: Array
    apart_m: Array
    distances_m: Array
    speeds_mps: Array

    @property
    def hands_m(self) -> Array:
        """The hands in the camera frame, (2, 3)."""
        return self.joints_m[0, :2]

    @property
    def moved(self) -> list[int]:
        """The numbers of the objects that move in a hand."""
        in_hand = (self.speeds_mps > MOVES_MPS) & (np.fmin(*self.distances_m) < IN_HAND_M)
        return [number for number, is_moved in zip(self.names, in_hand.tolist(), strict=True) if is_moved]

    @property
    def features(self) -> Array:
        """What contacts are foreseen by, (2, n, `FEATURES`), of right and left hand; NaN where a hand is not known."""
        hands_m = self.joints_m[:, :2]
        ahead_m = hands_m[0] + (hands_m[0] - hands_m[2]) * (AHEAD_S / HAND_S[1])
        to_object = self.apart_m / np.maximum(self.distances_m, SMALLEST_M)[..., None]
        features = [
            self.distances_m,
            np.log(self.distances_m + NEAR_M),
            *_ways(hands_m[0], hands_m[1 : 1 + len(HAND_S)], self.objects_m),
            np.linalg.norm(self.objects_m - ahead_m[:, None], axis=2),
            np.broadcast_to(self.speeds_mps, self.distances_m.shape),
            *_of_body(self.joints_m, to_object, self.objects_m),
        ]
        return np.stack(features, axis=2)


def approach(arms: RecentArms, objects: RecentObjects, stamp_ns: int) -> Approach:
    """Measure how the hands approach the objects at the newest posture, whose stamp is given."""
    names, places_m = objects.at(stamp_ns, round(OBJECT_S * SECOND_NS))
    joints_m = arms.at(DELAYS_NS)
    now_m, before_m = places_m[:, 0], places_m[:, 1]
    apart_m = now_m - joints_m[0, :2][:, None]
    speeds_mps = np.minimum(np.linalg.norm(now_m - before_m, axis=1) / OBJECT_S, FASTEST_MPS)
    return Approach(names, joints_m, now_m, apart_m, np.linalg.norm(apart_m, axis=2), speeds_mps)


def _ways(hands_m: Array, earlier_m: Array, objects_m: Array) -> list[Array]:
    """Return the ways of the hands since earlier instants, (2, n) each: towards each object and aside of it (m).

    Of two ways also the length, and of two the share that leads to the object.

    Args:
        hands_m: (2, 3), where the hands are.
        earlier_m: (instants, 2, 3), where they were.
        objects_m: (n, 3).
    """
    to_object = objects_m - earlier_m[:, :, None]
    to_object /= np.maximum(np.linalg.norm(to_object, axis=3), SMALLEST_M)[..., None]
    way = hands_m - earlier_m
    towards = np.einsum("wsni,wsi->wsn", to_object, way)
    lengths = np.linalg.norm(way, axis=2)[..., None]
    aside = np.sqrt(np.maximum(lengths**2 - towards**2, 0.0))
    shares = towards / np.sqrt(lengths**2 + SHORT_M**2)
    shape = towards.shape[1:]
    return [*towards, *aside, *(np.broadcast_to(lengths[w], shape) for w in (1, 3)), *shares[1:3]]


def _of_body(joints_m: Array, to_object: Array, objects_m: Array) -> list[Array]:
    """Return what the body tells, (2, n) each, 0 where it is not known.

    That is the elbow's way in the object's direction over `ELBOW_S` (m), the shoulders' turn times the object's angle
    beside the others (rad²), and how far the object is from the shoulder (m).

    Args:
        joints_m: (instants, joints, 3) at `DELAYS_NS`.
        to_object: (2, n, 3), unit vectors from the hands.
        objects_m: (n, 3).
    """
    first = 1 + len(HAND_S)
    elbow_ways = joints_m[0, 2:4] - joints_m[first : first + len(ELBOW_S), 2:4]
    along = np.einsum("sni,wsi->wsn", to_object, elbow_ways)
    now, then = (_angle(shoulders[0] - shoulders[1]) for shoulders in (joints_m[0, 4:], joints_m[-1, 4:]))
    turn = (now - then + np.pi) % (2 * np.pi) - np.pi
    from_middle = objects_m - joints_m[0, 4:].mean(axis=0)
    beside = np.arctan2(from_middle[:, 0], -from_middle[:, 2])
    beside = np.broadcast_to(turn * (beside - beside.mean()) if len(beside) else beside, to_object.shape[:2])
    from_shoulder = np.linalg.norm(objects_m - joints_m[0, 4:, None], axis=2)
    return [np.nan_to_num(each, nan=0.0) for each in (*along, beside, from_shoulder)]


def _angle(direction: Array) -> float:
    """Return the angle of a direction in the level plane (rad)."""
    return float(np.arctan2(direction[2], direction[0]))
