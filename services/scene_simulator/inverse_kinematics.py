"""The inverse kinematics of reaching: from a stance and the places of both palms to all joints."""

from dataclasses import dataclass, field

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX, JOINTS
from scene_simulator.actor import (
    EYE,
    FOOT_HEIGHT,
    FOREARM,
    HEAD,
    HIP_HEIGHT,
    HIP_SIDE,
    KNEE_SHARE,
    SHOULDER_DROP,
    SHOULDER_SIDE,
    SPINE,
    TRUNK,
    UPPER_ARM,
    Actor,
)

FULL_STRETCH = 0.995
"""Largest distance from shoulder to palm, as a share of the arm's length: at 1 the elbow's direction is undefined."""
COMFORTABLE_STRETCH = 0.93
"""Share of the arm's length up to which people stretch it; further away they lean instead."""
STRETCH_SOFTNESS = 0.05
"""Width of the transition to that limit, as a share of the arm's length: makes the trunk start to lean smoothly."""
LEAN_LIMIT_RAD = np.deg2rad(60.0)
"""Largest lean; a hand's goal beyond it is not reached."""
LEAST_AHEAD_M = 0.1
"""Least distance ahead of the hips at which a hand is assumed, so that the trunk never turns round."""
BISECTIONS = 30
"""Halvings of the 60° range: the lean is then exact to less than a millionth of a degree."""


@dataclass(frozen=True)
class Stance:
    """The stance over T frames.

    Attributes:
        pelvis_m: (T, 3), in the camera frame.
        heading_rad: (T,), of the hips; 0 faces the camera, positive turns to the person's right.
        lean_rad: (T,), of the trunk.
        twist_rad: (T,) or (1,), turn of the shoulders to the left, besides that towards the acting hand.
        reaching: (T,) or (1,), how far the trunk turns and leans after the acting hand, 0 to 1.
        legs_rad: (T, 2, 2) or (1, 2, 2), left and right leg: the thigh's swing forward, and the bend of the knee.
    """

    pelvis_m: Array
    heading_rad: Array
    lean_rad: Array
    twist_rad: Array = field(default_factory=lambda: np.zeros(1))
    reaching: Array = field(default_factory=lambda: np.ones(1))
    legs_rad: Array = field(default_factory=lambda: np.zeros((1, 2, 2)))

    def axes(self) -> tuple[Array, Array, Array]:
        """Return the person's left, up and forward directions, each (T, 3). Heading 0 faces the camera."""
        sin, cos, zero = np.sin(self.heading_rad), np.cos(self.heading_rad), np.zeros_like(self.heading_rad)
        left = np.stack([cos, zero, -sin], axis=-1)
        forward = np.stack([-sin, zero, -cos], axis=-1)
        return left, np.broadcast_to([0.0, -1.0, 0.0], left.shape), forward


def pose(actor: Actor, stance: Stance, hands_m: Array) -> Array:
    """Return the joints (T, 15, 3) of a person whose left and right palm are at `hands_m` (T, 2, 3).

    The trunk turns and leans towards the acting hand; the elbows point down. A hand beyond the arm's reach is moved
    back along the arm into reach.
    """
    trunk = _Trunk(actor, stance, hands_m[:, actor.column])
    joints = np.empty((len(hands_m), len(JOINTS), 3))
    joints[:, INDEX["neck"]] = trunk.along(TRUNK)
    joints[:, INDEX["torso"]] = trunk.along(SPINE)
    joints[:, INDEX["head"]] = trunk.along(TRUNK) + HEAD * actor.height_m * _unit(trunk.up + trunk.vertical)
    for column, (name, side) in enumerate((("left", 1), ("right", -1))):
        shoulder = trunk.shoulder(side)
        elbow, hand = _bend_arm(actor, trunk, side, shoulder, hands_m[:, column])
        for part, position in (("shoulder", shoulder), ("elbow", elbow), ("hand", hand)):
            joints[:, INDEX[f"{name}_{part}"]] = position
        left, up, forward = stance.axes()
        hip = stance.pelvis_m + side * HIP_SIDE * actor.height_m * left
        foot = hip - (HIP_HEIGHT - FOOT_HEIGHT) * actor.height_m * up + 0.02 * forward + 0.02 * side * left
        knee = hip + KNEE_SHARE * (foot - hip) + 0.02 * forward
        swing, bend = stance.legs_rad[:, 0 if side == 1 else 1].T
        knee_moved = _turned(knee - hip, left, swing) - (knee - hip)
        foot_moved = _turned(foot - knee, left, swing - bend) - (foot - knee)
        joints[:, INDEX[f"{name}_hip"]] = hip
        joints[:, INDEX[f"{name}_knee"]] = knee + knee_moved
        joints[:, INDEX[f"{name}_foot"]] = foot + knee_moved + foot_moved
    return joints


def fingertip(actor: Actor, joints_m: Array) -> Array:
    """Return the tip (T, 3) of the acting hand's stretched index finger, which continues the forearm."""
    hand, elbow = joints_m[:, INDEX[f"{actor.hand}_hand"]], joints_m[:, INDEX[f"{actor.hand}_elbow"]]
    return hand + actor.finger_m * _unit(hand - elbow)


def eye(actor: Actor, stance: Stance, joints_m: Array) -> Array:
    """Return the point between the eyes (T, 3)."""
    return joints_m[:, INDEX["head"]] + EYE * actor.height_m * stance.axes()[2]


class _Trunk:
    """The upper body over T frames: turned towards the acting hand, and leaning until the arm reaches it."""

    def __init__(self, actor: Actor, stance: Stance, hand_m: Array) -> None:
        self._height_m = actor.height_m
        self._pelvis = stance.pelvis_m
        self._side = actor.side
        self._reaching = stance.reaching[:, None]
        self.left, self.vertical, self.forward = stance.axes()
        aside, ahead = self._level(hand_m - self._pelvis)
        aside = self._reaching * aside
        self._towards = _unit(aside * self.left + np.maximum(ahead, LEAST_AHEAD_M) * self.forward)
        self._across = self.left
        self._lean_to(stance.lean_rad)
        aside, ahead = self._level(hand_m - self.shoulder(self._side))
        twist = actor.twist_gain * np.arctan2(aside, np.maximum(ahead, LEAST_AHEAD_M))
        twist = self._reaching * twist + stance.twist_rad[:, None]
        self._across = np.cos(twist) * self.left - np.sin(twist) * self.forward
        self._ahead = np.sin(twist) * self.left + np.cos(twist) * self.forward
        self._lean_to(stance.lean_rad)
        self._lean_to(stance.lean_rad + stance.reaching * self._needed_lean(actor, stance.lean_rad, hand_m))

    def along(self, share: float) -> Array:
        """Return the point (T, 3) of the spine at a distance from the hips, given as a share of stature."""
        return np.asarray(self._pelvis + share * self._height_m * self.up)

    def shoulder(self, side: int) -> Array:
        """Return a shoulder joint (T, 3); side +1 is the left."""
        across = side * SHOULDER_SIDE * self._height_m * self._leant_across
        return np.asarray(self.along(TRUNK - SHOULDER_DROP) + across)

    def elbow_pole(self, side: int, outward: float, along: Array) -> Array:
        """Return the direction (T, 3) in which the elbow of an arm along `along` (T, 3) points.

        While reaching for something on the table it points down, outward and a little back. Otherwise, as hands go
        anywhere, it turns with the arm: back while the arm hangs, down before the body, forward and outward above.
        """
        reaching = side * outward * self.left - self.vertical - 0.3 * self.forward
        up, ahead = ((along * axis).sum(-1, keepdims=True) for axis in (self.vertical, self._ahead))
        outwards = side * (outward + np.maximum(up, 0.0) ** 2)
        free = up * self._ahead - (ahead + 0.3) * self.vertical + outwards * self._across
        return np.asarray(self._reaching * reaching + (1 - self._reaching) * free)

    def _lean_to(self, lean_rad: Array) -> None:
        """Rotate the spine and the shoulder line from upright towards the hand by angles (T,)."""
        sin, cos = np.sin(lean_rad)[:, None], np.cos(lean_rad)[:, None]
        self.up = cos * self.vertical + sin * self._towards
        share = (self._across * self._towards).sum(-1, keepdims=True)
        self._leant_across = self._across + share * ((cos - 1) * self._towards - sin * self.vertical)

    def _level(self, offset_m: Array) -> tuple[Array, Array]:
        """Return the horizontal components of offsets (T, 3), leftward and forward, each (T, 1)."""
        return (offset_m * self.left).sum(-1, keepdims=True), (offset_m * self.forward).sum(-1, keepdims=True)

    def _distance(self, hand_m: Array) -> Array:
        return np.asarray(np.linalg.norm(hand_m - self.shoulder(self._side), axis=-1))

    def _needed_lean(self, actor: Actor, lean_rad: Array, hand_m: Array) -> Array:
        """Find by bisection the additional lean (T,; rad) with which the arm is stretched comfortably at most."""
        stretch = self._distance(hand_m) / actor.arm_m
        excess = (stretch - COMFORTABLE_STRETCH) / STRETCH_SOFTNESS
        wanted = (stretch - STRETCH_SOFTNESS * np.logaddexp(0.0, excess)) * actor.arm_m  # min(x, c), its kink softened
        low, high = np.zeros_like(lean_rad), np.full_like(lean_rad, LEAN_LIMIT_RAD)
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            self._lean_to(lean_rad + middle)
            too_far = self._distance(hand_m) > wanted
            low, high = np.where(too_far, middle, low), np.where(too_far, high, middle)
        return high


def _bend_arm(actor: Actor, trunk: _Trunk, side: int, shoulder: Array, hand: Array) -> tuple[Array, Array]:
    """Solve the inverse kinematics of the two-link arm: elbow and hand (T, 3)."""
    upper, fore = UPPER_ARM * actor.height_m, FOREARM * actor.height_m
    along = _unit(hand - shoulder)
    distance = np.minimum(np.linalg.norm(hand - shoulder, axis=-1), FULL_STRETCH * actor.arm_m)[:, None]
    pole = trunk.elbow_pole(side, actor.elbow_out, along)
    pole = _unit(pole - (pole * along).sum(-1, keepdims=True) * along)
    foot = (upper**2 - fore**2 + distance**2) / (2 * distance)
    height = np.sqrt(np.maximum(upper**2 - foot**2, 0.0))
    return shoulder + foot * along + height * pole, shoulder + distance * along


def _turned(vectors: Array, left: Array, forward_rad: Array) -> Array:
    """Turn vectors (T, 3) that hang down forward about the axis `left` (T, 3) by angles (T,) or (1,)."""
    cos, sin = np.cos(forward_rad)[:, None], np.sin(forward_rad)[:, None]
    along = (vectors * left).sum(-1, keepdims=True)
    return np.asarray(vectors * cos + np.cross(left, vectors) * sin + along * (1 - cos) * left)


def _unit(vectors: Array) -> Array:
    """Scale vectors (…, 3) to length 1."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
