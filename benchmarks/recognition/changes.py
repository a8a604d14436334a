"""Recordings as other bodies or another camera would have given them: calculated, before the preprocessor."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import cached_property
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from actum import keys
from actum.messages import Joint, Message, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES

from .splits import SEED

Array = NDArray[np.float64]
Stamps = NDArray[np.int64]
Joints = Callable[[Array, np.random.Generator], Array]

LONGEST_GAP_NS = SECOND_NS // 2
"""Between frames of a recording that are further apart nothing is interpolated."""

SMOOTHED_FRAMES = 15
"""Over how many frames to either side the direction is averaged in which a seated person's knees point."""

LEFT_OF_ACTOR, TORSO = (INDEX["left_hip"], INDEX["right_hip"]), INDEX["torso"]
KNEES, FEET = ("left_knee", "right_knee"), ("left_foot", "right_foot")
CHILDS_BONES = {"head": 0.85, "elbow": 0.6, "hand": 0.6, "knee": 0.55, "foot": 0.55}
"""How long a child's bone that leads to such a joint is, as a share of the adult's."""

CHILDS_TRUNK = 0.65
"""The same of the bones that lead to the other joints."""


@dataclass(frozen=True)
class Change:
    """What is done to a recording: to the joints (frames, 15, 3; camera frame, m), to its frames and to its pace.

    Attributes:
        joints: gets the joints and a generator of its own for each recording.
        pace: how many times as fast all is done.
        frames_per_second: what is interpolated and then comes at this rate, where given.
    """

    joints: Joints = lambda joints_m, rng: joints_m
    pace: float = 1.0
    frames_per_second: float | None = None


class Changed(Recording):
    """A recording of one person and one sensor, changed; what is asked for, it gives skeletons and marks."""

    def __init__(self, recording: Recording, change: Change) -> None:
        super().__init__(recording.path)
        self._change = change

    def messages(self, topics: Collection[keys.Topic] | None = None) -> Iterator[Message]:
        """Yield the changed skeletons and the marks, which keep to the pace."""
        yield from self._changed

    @cached_property
    def _changed(self) -> list[Message]:
        read = list(super().messages((keys.SKELETON, keys.SEGMENT)))
        marks = [message for message in read if isinstance(message, Segment)]
        seen = [message for message in read if isinstance(message, Skeleton) and message.agents]
        nobody = [message for message in read if isinstance(message, Skeleton) and not message.agents]
        first_ns = read[0].stamp_ns
        kept = [*marks, *nobody] if self._change.frames_per_second is None else marks
        paced = [m.model_copy(update={"stamp_ns": self._paced(m.stamp_ns, first_ns)}) for m in kept]
        return sorted([*paced, *self._skeletons(seen, first_ns)], key=_order)

    def _paced(self, stamp_ns: int, first_ns: int) -> int:
        return first_ns + round((stamp_ns - first_ns) / self._change.pace)

    def _skeletons(self, seen: list[Skeleton], first_ns: int) -> Iterator[Skeleton]:
        joints_m = np.array([skeleton.agents[0].joints for skeleton in seen], dtype=np.float64)
        joints_m = self._change.joints(joints_m, np.random.default_rng([SEED, crc32(self.path.stem.encode())]))
        stamps_ns = np.array([skeleton.stamp_ns for skeleton in seen])
        if self._change.frames_per_second is not None:
            rate_hz = self._change.frames_per_second / self._change.pace
            stamps_ns, joints_m = resampled(stamps_ns, joints_m, rate_hz)
        agent, template = seen[0].agents[0], seen[0]
        for stamp_ns, frame_m in zip(stamps_ns.tolist(), joints_m, strict=True):
            agents = [agent.model_copy(update={"joints": _listed(frame_m)})]
            paced_ns = self._paced(stamp_ns, first_ns)
            yield template.model_copy(update={"stamp_ns": paced_ns, "agents": agents, "seq": None})


def resampled(stamps_ns: Stamps, joints_m: Array, frames_per_second: float) -> tuple[Stamps, Array]:
    """Interpolate at even instants from the first frame on, but not where frames are far apart."""
    at_ns = np.arange(stamps_ns[0], stamps_ns[-1] + 1, round(SECOND_NS / frames_per_second))
    after = np.searchsorted(stamps_ns, at_ns).clip(1, len(stamps_ns) - 1)
    gaps_ns = stamps_ns[after] - stamps_ns[after - 1]
    exact = stamps_ns[np.searchsorted(stamps_ns, at_ns)] == at_ns
    near = exact | (gaps_ns <= LONGEST_GAP_NS)
    share = ((at_ns - stamps_ns[after - 1]) / gaps_ns)[near, None, None]
    return at_ns[near], (1 - share) * joints_m[after - 1][near] + share * joints_m[after][near]


def turned(degrees: float) -> Joints:
    """Turn the scene about the vertical through the mean torso; who faces the camera turns to their right."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rotation = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])

    def turn(joints_m: Array, rng: np.random.Generator) -> Array:
        middle = joints_m[:, TORSO].mean(axis=0)
        return (joints_m - middle) @ rotation.T + middle

    return turn


def pitched(degrees: float) -> Joints:
    """Show the scene as a camera at the same place does that looks down by so much."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rotation = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
    return lambda joints_m, rng: joints_m @ rotation.T


def mirrored(joints_m: Array, rng: np.random.Generator) -> Array:
    """Show the mirror image: x reflected, and left and right joints exchanged."""
    other_side = {"left": "right", "right": "left"}
    names = ["_".join(other_side.get(word, word) for word in name.split("_")) for name in JOINTS]
    return joints_m[:, [INDEX[name] for name in names]] * [-1.0, 1.0, 1.0]


def seated(joints_m: Array, rng: np.random.Generator) -> Array:
    """Put the knees before the hips and the feet below the knees, and lower all by as much as the thighs are long."""
    left, right = (joints_m[:, hip] for hip in LEFT_OF_ACTOR)
    forward = _forward(left - right)
    sitting = joints_m.copy()
    for side, hip in zip(("left", "right"), LEFT_OF_ACTOR, strict=True):
        knee, foot = INDEX[f"{side}_knee"], INDEX[f"{side}_foot"]
        sitting[:, knee] = joints_m[:, hip] + _length_m(joints_m, hip, knee) * forward
        sitting[:, foot] = sitting[:, knee] + [0.0, _length_m(joints_m, knee, foot), 0.0]
    sitting[..., 1] += np.mean(
        [_length_m(joints_m, hip, INDEX[k]) for hip, k in zip(LEFT_OF_ACTOR, KNEES, strict=True)]
    )
    return sitting


def childlike(joints_m: Array, rng: np.random.Generator) -> Array:
    """Give the bones a child's proportions in the directions that they have, on the same floor."""
    small = joints_m.copy()
    for parent, child, _ in BONES:
        share = CHILDS_BONES.get(JOINTS[child].split("_")[-1], CHILDS_TRUNK)
        small[:, child] = small[:, parent] + share * (joints_m[:, child] - joints_m[:, parent])
    feet = [INDEX[name] for name in FEET]
    small[..., 1] += np.median(joints_m[:, feet, 1].max(axis=1) - small[:, feet, 1].max(axis=1))
    return small


def dropped(share: float) -> Joints:
    """Take out each joint of each frame with this probability (NaN)."""
    return lambda joints_m, rng: np.where(rng.random(joints_m.shape[:2])[..., None] < share, np.nan, joints_m)


def _forward(to_left: Array) -> Array:
    """Return the horizontal direction (n, 3) that somebody faces whose left is there: left x up, smoothed."""
    window = np.ones(2 * SMOOTHED_FRAMES + 1)
    x, z = (np.convolve(to_left[:, axis], window)[SMOOTHED_FRAMES:-SMOOTHED_FRAMES] for axis in (0, 2))
    forward = np.stack([z, np.zeros(len(x)), -x], axis=1)
    unit: Array = forward / np.linalg.norm(forward, axis=1, keepdims=True)
    return unit


def _length_m(joints_m: Array, parent: int, child: int) -> float:
    return float(np.median(np.linalg.norm(joints_m[:, child] - joints_m[:, parent], axis=1)))


def _listed(frame_m: Array) -> list[Joint]:
    return [None if np.isnan(joint).any() else joint.tolist() for joint in frame_m]


def _order(message: Message) -> tuple[int, int]:
    """Sort by stamp; a segment holds the frames at its own bounds."""
    rank = (0 if message.kind == "start" else 2) if isinstance(message, Segment) else 1
    return message.stamp_ns, rank
