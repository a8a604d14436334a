"""A body that moves freely: poses, the ways between them, and where a hand may go."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from actum.arrays import Array
from scene_simulator import hand_doings
from scene_simulator.actor import SHOULDER_DROP, SHOULDER_SIDE, TRUNK, Actor
from scene_simulator.motion import HANGING, LEFT, RIGHT, SIDES
from scene_simulator.random_streams import draw_normals
from scene_simulator.trajectories import minimum_jerk

RATE_HZ = 30
"""Frames a second."""
BOTH = (LEFT, RIGHT)
ON_BODY = (
    hand_doings.CROWN,
    hand_doings.EAR,
    hand_doings.NOSE,
    hand_doings.MOUTH,
    hand_doings.COLLAR,
    hand_doings.HEM,
    hand_doings.HIP,
    hand_doings.BELLY,
    hand_doings.OTHER_ELBOW,
    hand_doings.OTHER_UPPER_ARM,
    hand_doings.HELD_FOREARM,
    hand_doings.POCKET,
)
"""Where a hand touches the body."""
PLACE_SD = 0.01
"""Scatter of these places, as a share of stature."""
STRETCH = (0.35, 0.98)
"""Distances of a hand from its shoulder, as shares of the arm's length."""
BEHIND_M = 0.15
"""How far behind the body a hand goes at most."""
ACROSS_M = 0.30
"""How far a hand goes to the other side at most."""
LEAST_S = 0.15
"""Seconds of the shortest way."""
RAMP_S = 0.3
"""Seconds in which a repeated movement sets in and fades."""
DRIFT_SD_M = 0.004
"""Drift of hands that are held."""
DRIFT_HZ = (0.2, 0.6)
"""Frequencies of that drift."""


@dataclass(frozen=True)
class FreePose:
    """A pose of the body.

    Attributes:
        hands_m: (2, 3), palms of left and right hand; leftward, up and forward from the pelvis, by the hips' heading.
        turn_rad: turn of the hips to the left.
        twist_rad: turn of the shoulders against the hips to the left.
        lean_rad: forward lean of the trunk.
        legs_rad: (2, 2), left and right leg: the thigh's swing forward, and the bend of the knee.
    """

    hands_m: Array
    turn_rad: float = 0.0
    twist_rad: float = 0.0
    lean_rad: float = 0.0
    legs_rad: Array = field(default_factory=lambda: np.zeros((2, 2)))

    def values(self) -> Array:
        """Return all numbers: hands (6), turn, twist, lean, legs (4)."""
        return np.concatenate(
            [self.hands_m.ravel(), [self.turn_rad, self.twist_rad, self.lean_rad], self.legs_rad.ravel()]
        )

    def with_hands(self, places_m: Mapping[int, Array]) -> "FreePose":
        """Return the pose with hands at other places (3,), by column."""
        hands_m = self.hands_m.copy()
        for hand, place_m in places_m.items():
            hands_m[hand] = place_m
        return replace(self, hands_m=hands_m)


class FreeBody:
    """The frames of one body, which grow with each movement.

    Attributes:
        actor: the person.
        rng: draws everything.
        pose: the one that the body has come to.
        frames: arrays (T, 13) of the values of `FreePose`, movement after movement.
    """

    def __init__(self, actor: Actor, rng: np.random.Generator) -> None:
        self.actor, self.rng = actor, rng
        self.pose = FreePose(self.hanging())
        self.frames: list[Array] = []

    @property
    def seconds(self) -> float:
        """How long the body has moved."""
        return sum(map(len, self.frames)) / RATE_HZ

    def hanging(self) -> Array:
        """Return the places (2, 3) of hanging hands."""
        return np.array([self._on_side(hand, HANGING) for hand in BOTH]) * self.actor.height_m

    def move(self, goal: FreePose, seconds: float) -> None:
        """Move to a pose at minimum jerk."""
        count = max(round(seconds * self.actor.tempo * RATE_HZ), 2)
        share = minimum_jerk(np.arange(1, count + 1) / count)[:, None]
        start = self.pose.values()
        self.frames.append(start + share * (goal.values() - start))
        self.pose = goal

    def reach(self, goal: FreePose, speed_m_s: float) -> None:
        """Move to a pose as fast as the hand that has the longer way moves at a mean speed."""
        way_m = np.linalg.norm(goal.hands_m - self.pose.hands_m, axis=1).max()
        self.move(goal, LEAST_S + way_m / speed_m_s)

    def hold(self, seconds: float) -> None:
        """Stay; the hands drift a little."""
        drift = np.zeros(13)
        drift[:6] = draw_normals(self.rng, DRIFT_SD_M, 6)
        self.repeat(FreePose(drift[:6].reshape(2, 3)), np.zeros(13), self.uniform(*DRIFT_HZ), seconds)

    def repeat(self, sine: FreePose, cosine: Array, rate_hz: float, seconds: float) -> None:
        """Move about the pose and back to it: by amplitudes of a sine and (13,) of a cosine, together an ellipse."""
        time_s = np.arange(1, max(round(seconds * RATE_HZ), 2) + 1) / RATE_HZ
        ramp_s = min(RAMP_S, time_s[-1] / 2)
        strength = np.clip(np.minimum(time_s, time_s[-1] - time_s) / ramp_s, 0, 1)[:, None]
        phase = 2 * np.pi * rate_hz / self.actor.tempo * time_s[:, None]
        ellipse = np.sin(phase) * sine.values() + (np.cos(phase) - 1) * cosine
        self.frames.append(self.pose.values() + strength * ellipse)

    def anywhere(self, hand: int) -> Array:
        """Draw a place (3,) within a hand's reach, seldom behind the body or across it, never in it."""
        shoulder_m = self._on_side(hand, (SHOULDER_SIDE, TRUNK - SHOULDER_DROP, 0.0)) * self.actor.height_m
        while True:
            direction = self.rng.normal(size=3)
            way_m = self.uniform(*STRETCH) * self.actor.arm_m
            place_m: Array = shoulder_m + way_m * direction / np.linalg.norm(direction)
            aside, up, ahead = place_m
            in_trunk = ahead < 0.12 and abs(aside) < 0.15 and up < 0.5
            if ahead > -BEHIND_M and SIDES[hand] * aside > -ACROSS_M and not in_trunk:
                return place_m

    def on_body(self, hand: int) -> Array:
        """Draw a place (3,) on the body that a hand touches."""
        share = np.array(ON_BODY[self.rng.integers(len(ON_BODY))]) + draw_normals(self.rng, PLACE_SD, 3)
        return self._on_side(hand, share) * self.actor.height_m

    def uniform(self, low: float, high: float) -> float:
        """Draw a number."""
        return float(self.rng.uniform(low, high))

    def log_uniform(self, low: float, high: float) -> float:
        """Draw a number; as often between 1 and 2 as between 2 and 4."""
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def chance(self, share: float) -> bool:
        """Draw whether something happens that does in a share of cases."""
        return bool(self.rng.random() < share)

    def _on_side(self, hand: int, outward_up_forward: Iterable[float]) -> Array:
        outward, up, forward = outward_up_forward
        return np.array([SIDES[hand] * outward, up, forward])
