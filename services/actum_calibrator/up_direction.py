"""Estimates the up direction in the camera frame from one person who stands upright."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX

SPAN_S = 2  # duration of standing still: longer than a slow sway of the body
SPAN_NS = SPAN_S * SECOND_NS
FEWEST_FRAMES = 10  # in that time: from fewer the sway cannot be estimated
LONGEST_GAP_NS = SECOND_NS // 2  # between two frames: the person may move in a longer one
MOST_SWAY_DEG = 1.5  # root mean square; people who stand still sway by less, people who shift their weight by more
MOST_BEND_DEG = 20.0  # between shins, thighs and trunk; a straight body with the noise of joints has less
STAY = f"stay like that for {SPAN_S} seconds"
_LEGS = ("left_hip", "right_hip", "left_knee", "right_knee", "left_foot", "right_foot")


@dataclass(frozen=True)
class UpDirection:
    """The up direction as a unit vector (3) in the camera frame, and the RMS sway of the body about it."""

    in_camera: tuple[float, float, float]
    sway_deg: float

    @property
    def pitch_deg(self) -> float:
        """Pitch of the camera; positive looks up."""
        return math.degrees(math.asin(self.in_camera[2]))

    @property
    def roll_deg(self) -> float:
        """Rotation of the camera about its optical axis, clockwise."""
        return math.degrees(math.atan2(-self.in_camera[0], -self.in_camera[1]))


class UpDirectionEstimator:
    """Estimates the up direction once one person has stood straight and still for `SPAN_S` by stamps, without a gap.

    Attributes:
        instruction: what the person has to do next, until the estimate is complete.
        up: the estimated up direction, None until it is complete.
    """

    def __init__(self) -> None:
        self.instruction = "stand upright, arms down, the whole body in view"
        self.up: UpDirection | None = None
        self._axes: deque[tuple[int, Array]] = deque()
        self._who: tuple[str, int] | None = None

    def offer(self, frame: Skeleton) -> None:
        """Process the next skeleton."""
        problem, axis = _axis(frame)
        if axis is None:
            self.instruction = problem
            self._axes.clear()
            return
        who = frame.session_id, frame.agents[0].agent
        if self._axes and not (who == self._who and 0 < frame.stamp_ns - self._axes[-1][0] <= LONGEST_GAP_NS):
            self._axes.clear()
        self._who = who
        self._axes.append((frame.stamp_ns, axis))
        while len(self._axes) > FEWEST_FRAMES and frame.stamp_ns - self._axes[1][0] >= SPAN_NS:
            self._axes.popleft()
        self.instruction = STAY
        if len(self._axes) >= FEWEST_FRAMES and self._axes[-1][0] - self._axes[0][0] >= SPAN_NS:
            axes = np.array([axis for _, axis in self._axes])
            mean = axes.mean(axis=0)
            up = mean / np.linalg.norm(mean)
            sway_deg = math.degrees(float(np.sqrt(np.square(axes - up).sum(axis=1).mean())))
            if sway_deg > MOST_SWAY_DEG:
                self.instruction = f"stand still: the body sways by more than {MOST_SWAY_DEG:g} degrees"
            else:
                self.up = UpDirection((float(up[0]), float(up[1]), float(up[2])), sway_deg)


def _axis(frame: Skeleton) -> tuple[str, Array | None]:
    """Return "" and the direction (3,) from the feet to the neck, or an instruction and None."""
    if not frame.valid or not frame.agents:
        return f"nobody is visible{(f': {frame.reason}' if frame.reason else '')}", None
    if len(frame.agents) > 1:
        return f"{len(frame.agents)} people are visible: only one person may be", None
    joints = frame.agents[0].joints
    named = {name: joints[INDEX[name]] for name in ("neck", *_LEGS)}
    points = {name: np.array(joint) for name, joint in named.items() if joint and all(map(math.isfinite, joint))}
    if len(points) < len(named):
        unseen = ", ".join(name for name in named if name not in points)
        return f"not visible: {unseen}; step back, or tilt the camera", None
    hips, knees, feet = ((points[f"left_{name}"] + points[f"right_{name}"]) / 2 for name in ("hip", "knee", "foot"))
    parts = [_unit(to - start) for start, to in ((feet, knees), (knees, hips), (hips, points["neck"]))]
    bend_deg = max(_angle_deg(parts[0], parts[1]), _angle_deg(parts[1], parts[2]))
    if not bend_deg <= MOST_BEND_DEG:
        return f"stand straight: the body is bent by more than {MOST_BEND_DEG:g} degrees", None
    return "", _unit(points["neck"] - feet)


def _unit(vector: Array) -> Array:
    """Return the direction (3,) of a vector (3,), NaN where it has no length."""
    length = float(np.linalg.norm(vector))
    return vector / length if length else np.full(3, math.nan)


def _angle_deg(one: Array, other: Array) -> float:
    return math.degrees(math.acos(float(np.clip(one @ other, -1.0, 1.0))))
