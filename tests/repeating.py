"""Somebody who repeats one action with pauses, and what happens around it."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from actum.messages import Skeleton
from people import FRAME_NS, STANDING, skeleton

Array = NDArray[np.float64]
Part = Array
"""Joints (frames, 15, 3) in the camera frame."""

RATE_HZ = 30
WAVE = {8: (-0.25, -0.75, -0.10), 7: (-0.10, -0.25, -0.05)}
"""Joints that a wave moves, the right hand and elbow, and how far (m)."""
GOGGLES = {8: (0.20, -0.60, -0.15), 5: (-0.20, -0.60, -0.15), 7: (0.0, -0.2, -0.1), 4: (0.0, -0.2, -0.1)}
SCRATCH = {5: (-0.15, -0.30, -0.15), 4: (0.0, -0.1, -0.1)}


def eased(frames: int) -> Array:
    """Rise from 0 to 1 and fall back, softly."""
    return (1 - np.cos(np.linspace(0, 2 * np.pi, frames))) / 2


def held(frames: int) -> Array:
    """Rise, stay at the top for half of the time, fall."""
    quarter = frames // 4
    rise = (1 - np.cos(np.linspace(0, np.pi, quarter))) / 2
    return np.concatenate([rise, np.ones(frames - 2 * quarter), rise[::-1]])


def moved(phase: Array, joints: dict[int, tuple[float, float, float]]) -> Part:
    """Stand and move some joints by a share of their way."""
    part = np.repeat(STANDING[None], len(phase), axis=0)
    for joint, way_m in joints.items():
        part[:, joint] += phase[:, None] * np.array(way_m)
    return part


def rest(seconds: float) -> Part:
    return np.repeat(STANDING[None], round(seconds * RATE_HZ), axis=0)


def walk(seconds: float) -> Part:
    """Walk up to two metres nearer: the legs and arms swing in turn."""
    times_s = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    part = np.repeat(STANDING[None], len(times_s), axis=0)
    swing = 0.25 * np.sin(2 * np.pi * 0.9 * times_s)
    for joint, share in ((10, 0.6), (11, 1.0), (5, -0.6), (13, -0.6), (14, -1.0), (8, 0.6)):
        part[:, joint, 2] += share * swing
    part[:, :, 2] += np.linspace(1.5, 0, len(times_s))[:, None]
    return part


class Stream:
    """A stream that is put together part by part, and where its repetitions lie (frames)."""

    def __init__(self) -> None:
        self.parts: list[Part] = []
        self.truths: list[tuple[int, int]] = []

    @property
    def frames(self) -> int:
        return sum(map(len, self.parts))

    def then(self, part: Part) -> "Stream":
        self.parts.append(part)
        return self

    def repeat(self, parts: Iterable[Part], pause_s: float = 1.2) -> "Stream":
        """Do each part once, with a pause before and after."""
        for part in parts:
            self.then(rest(pause_s))
            self.truths.append((self.frames, self.frames + len(part) - 1))
            self.then(part)
        return self.then(rest(pause_s))

    def joints(self, noise_m: float = 0.003, seed: int = 0) -> Array:
        joined = np.concatenate(self.parts)
        return joined + np.random.default_rng(seed).normal(0, noise_m, joined.shape)

    def skeletons(self, noise_m: float = 0.003, first_ns: int = 0) -> list[Skeleton]:
        return [skeleton(first_ns + i * FRAME_NS, joints, seq=i) for i, joints in enumerate(self.joints(noise_m))]


def together(*streams: Sequence[Array]) -> list[Skeleton]:
    """Let people 1, 2, … be seen in the same frames; all streams are as long as the shortest."""
    return [skeleton(i * FRAME_NS, *joints, seq=i) for i, joints in enumerate(zip(*streams, strict=False))]


def five_waves(seconds: float = 1.4, pause_s: float = 1.2) -> Stream:
    return Stream().repeat([moved(eased(round(seconds * RATE_HZ)), WAVE)] * 5, pause_s)
