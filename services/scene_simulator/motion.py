"""The key poses of one person, one after the other, at that person's tempo and with variation in each repetition."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Actor
from scene_simulator.key_poses import KeyPose
from scene_simulator.parameters import Parameters
from scene_simulator.random_streams import draw_normal, draw_normals, random_stream
from scene_simulator.trial import Layout

Hands = Mapping[int, Array]
"""Goals (3,) of hands, by column: 0 is the left hand, 1 the right one."""
LEFT, RIGHT = 0, 1
UP = np.array([0.0, 1.0, 0.0])
SIDES = (1, -1)
"""Side of each hand's column: +1 is the person's left."""
START_S = 0.30
"""Seconds of a hand's way besides those that its length takes: short ways are slower on average."""
HAND_M_S = 0.95
"""Mean speed of a hand besides that: 0.6 m take 0.9 s, peak 1.2 m/s, as in unhurried reaching."""
TURN_RAD_S = np.deg2rad(100.0)
"""Mean speed of turning hips, shoulders and trunk without haste."""
WALK_M_S = 0.70
"""Mean speed from standing to standing; the peak, 1.2 m/s, is ordinary walking."""
PLACE_SD = 0.008
"""Scatter of a hand's place on the body, as a share of stature: 1.4 cm."""
TIME_SD = 0.10
"""Scatter of durations, as a share."""
DRIFT_M = 0.006
"""Amplitude of the drift of hands that are held in the air."""
DRIFT_HZ = (0.2, 0.6)
"""Frequencies of that drift, those of the body's sway."""
RELEASE_S = 0.35
"""Seconds in which the trunk begins or ends to follow the acting hand; at rest it does by a few degrees only."""
PREFERENCE = 0.7
"""Share of one-handed doings that are done with the acting hand."""

HANGING = (0.135, -0.075, 0.05)
"""A hanging hand, beside and a little before the thigh, the arm not quite stretched."""


@dataclass(frozen=True)
class Manner:
    """How a person does everyday things: tempo and size of the movements, 1 is usual."""

    tempo: float
    size: float

    @classmethod
    def of(cls, actor: Actor, actor_seed: int) -> "Manner":
        """Draw a person's manner; the same person always has the same."""
        return cls(actor.tempo, draw_normal(random_stream("manner", actor_seed), (1.0, 0.12)))


class Motion:
    """Movements from the rest at the table on; `poses` grows with each of them.

    Places are leftward, up and forward from the pelvis, by the heading of the hips, in metres. Every movement begins
    where the one before has ended, and takes the time that its longest way needs.
    """

    def __init__(
        self,
        parameters: Parameters,
        actor: Actor,
        manner: Manner,
        layout: Layout,
        rng: np.random.Generator,
    ) -> None:
        self.parameters, self.actor, self.layout, self.rng = parameters, actor, layout, rng
        self._manner = manner
        self.doing: str | None = None
        self.rest = np.stack([self.from_camera(palm) for palm in layout.rest_m])
        self.poses = [KeyPose(0.0, self.rest)]

    @property
    def last(self) -> KeyPose:
        """The pose that the person has come to."""
        return self.poses[-1]

    @property
    def at_table(self) -> bool:
        """Whether the hands are at the table, where the trunk follows the acting one."""
        return self.last.reaching == 1.0

    def from_camera(self, point_m: Array) -> Array:
        """Return the place (3,) of a point (3,) of the camera frame, for a person who stands at the table."""
        sin, cos = np.sin(self.layout.heading_rad), np.cos(self.layout.heading_rad)
        offset = point_m - self.layout.pelvis_m
        return np.array([cos * offset[0] - sin * offset[2], -offset[1], -sin * offset[0] - cos * offset[2]])

    def edge_of_view(self) -> float:
        """Return the way (m) along the camera's x to the nearer edge of the view."""
        x, _, z = self.layout.pelvis_m
        half_m = self.parameters.camera.half_view * z
        return float((half_m if x >= 0 else -half_m) - x)

    def objects(self) -> Array:
        """Return the middles (n, 3) of the objects, as places."""
        depths = np.array([item.size_m[2] for item in self.parameters.objects.items])
        middles = self.layout.positions_m + depths[:, None] / 2 * np.array([0.0, 0.0, 1.0])
        return np.stack([self.from_camera(middle) for middle in middles])

    def on_body(
        self, hand: int, point: tuple[float, float, float], twist_rad: float = 0.0, lean_rad: float = 0.0
    ) -> Array:
        """Return the place (3,) of a point of the trunk, which is turned and leant, with the scatter of a repetition.

        `point` is outward to the hand's side, up from the pelvis and forward, in shares of stature.
        """
        outward, up, ahead = np.array(point) + draw_normals(self.rng, PLACE_SD, 3)
        aside, lean = SIDES[hand] * outward, self.actor.lean_rad + lean_rad
        level_ahead = ahead * np.cos(twist_rad) - aside * np.sin(twist_rad)
        level_aside = aside * np.cos(twist_rad) + ahead * np.sin(twist_rad)
        sin, cos = np.sin(lean), np.cos(lean)
        place = (level_aside, up * cos - level_ahead * sin, up * sin + level_ahead * cos)
        return np.array(place) * self.actor.height_m

    def one_hand(self) -> int:
        """Draw the column of a hand, more often that of the acting one."""
        acting = self.actor.column
        return acting if self.rng.random() < PREFERENCE else 1 - acting

    def uniform(self, low: float, high: float) -> float:
        """Draw a number."""
        return float(self.rng.uniform(low, high))

    def sized(self, low: float, high: float) -> float:
        """Draw the size of a movement, larger for a person of large movements."""
        return self._manner.size * self.uniform(low, high)

    def either_side(self, low: float, high: float) -> float:
        """Draw the size of a movement to the left (positive) or to the right."""
        return float(self.rng.choice([-1.0, 1.0])) * self.sized(low, high)

    def move(self, hands: Hands | None = None, haste: float = 1.0, **body: Array | float) -> None:
        """Move the hands to places (3,), and the body to other values of `KeyPose`; `haste` divides the time."""
        if self.at_table and body.get("reaching") is None:
            self._add(self._seconds(RELEASE_S), reaching=0.0)
        goals = self.last.hands_m.copy()
        for hand, place in (hands or {}).items():
            goals[hand] = place
        following = replace(self.last, hands_m=goals, **body)  # type: ignore[arg-type]
        self._add(self._seconds(self._least_s(following) / haste), hands_m=goals, **body)

    def straighten(self, hands: Hands) -> None:
        """Move the hands to places (3,), and the body back to how a person stands at the table."""
        self.move(hands, shift_m=np.zeros(2), turn_rad=0.0, twist_rad=0.0, lean_rad=0.0)

    def hold(self, low_s: float, high_s: float) -> None:
        """Stay in the pose for some time; hands in the air drift a little."""
        drift = np.zeros((2, 3)) if self.at_table else draw_normals(self.rng, DRIFT_M, 6).reshape(2, 3)
        self._add(self.uniform(low_s, high_s), beat_m=drift, beat_hz=self.uniform(*DRIFT_HZ))

    def beat(self, beats_m: Hands, hz: tuple[float, float], seconds: tuple[float, float]) -> None:
        """Repeat small movements of the hands by amplitudes (3,) around their places."""
        amplitudes = np.zeros((2, 3))
        for hand, amplitude in beats_m.items():
            amplitudes[hand] = self._manner.size * amplitude
        self._add(self.uniform(*seconds), beat_m=amplitudes, beat_hz=self.uniform(*hz) / self._manner.tempo)

    def to_rest(self) -> None:
        """Bring body and hands back to the rest at the table."""
        if not self.at_table:
            self.straighten({LEFT: self.rest[LEFT], RIGHT: self.rest[RIGHT]})
            self._add(RELEASE_S, reaching=1.0)
        else:
            self.move({LEFT: self.rest[LEFT], RIGHT: self.rest[RIGHT]}, reaching=1.0)

    def _least_s(self, following: KeyPose) -> float:
        """Return the time that the way to a pose needs without haste."""
        last = self.last
        way_m = np.linalg.norm(following.hands_m - last.hands_m, axis=1).max()
        angles = [getattr(following, name) - getattr(last, name) for name in ("turn_rad", "twist_rad", "lean_rad")]
        walk_m = np.linalg.norm(following.shift_m - last.shift_m)
        slowest_s = max(way_m / HAND_M_S, np.abs(angles).max() / TURN_RAD_S, walk_m / WALK_M_S)
        return float(START_S + slowest_s)

    def _seconds(self, usual_s: float) -> float:
        return usual_s * self._manner.tempo * draw_normal(self.rng, (1.0, TIME_SD))

    def _add(self, seconds: float, **changes: Array | float) -> None:
        still = {"beat_m": np.zeros((2, 3)), "beat_hz": 0.0}
        self.poses.append(replace(self.last, **(still | changes), seconds=seconds, doing=self.doing))  # type: ignore[arg-type]
