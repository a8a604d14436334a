"""Synthetic people for tests: joints in the camera frame, and the messages that carry them."""

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent, Joint, Posture, Segment, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

STANDING = np.array(
    [
        [0.00, -0.60, 2.50],
        [0.00, -0.40, 2.50],
        [0.00, -0.18, 2.50],
        [0.19, -0.38, 2.50],
        [0.24, -0.10, 2.48],
        [0.25, 0.14, 2.40],
        [-0.19, -0.38, 2.50],
        [-0.24, -0.10, 2.48],
        [-0.25, 0.14, 2.40],
        [0.10, 0.08, 2.51],
        [0.11, 0.50, 2.50],
        [0.11, 0.92, 2.52],
        [-0.10, 0.08, 2.51],
        [-0.11, 0.50, 2.50],
        [-0.11, 0.92, 2.52],
    ]
)
"""A person 2.5 m away facing the camera, (15, 3) metres: their right hand is on the image's left."""

FRAME_NS = 33_333_333


def reaching(phase: float, height: float = 1.0) -> NDArray[np.float64]:
    """Return the joints with the right arm `phase` (0..1) of the way stretched forward and up."""
    joints = STANDING.copy()
    joints[7] += phase * np.array([0.02, -0.10, -0.20])
    joints[8] += phase * np.array([0.10, -0.35, -0.40])
    middle = joints.mean(axis=0)
    result: NDArray[np.float64] = middle + (joints - middle) * height
    return result


def turned(joints: NDArray[np.float64], heading_rad: float) -> NDArray[np.float64]:
    """Turn about the vertical through the torso, at a positive heading to the person's own left."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    torso = joints[INDEX["torso"]]
    result: NDArray[np.float64] = torso + (joints - torso) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T
    return result


def lacking(joints: NDArray[np.float64], *names: str) -> NDArray[np.float64]:
    """Return the joints with some unknown: NaN, and null in a skeleton message."""
    partial = joints.copy()
    partial[[INDEX[name] for name in names]] = np.nan
    return partial


def skeleton(stamp_ns: int, *joints: NDArray[np.float64], seq: int | None = None, session_id: str = "test") -> Skeleton:
    """Make a skeleton message of agents 1, 2, … with the given joints; NaN is a joint that the source lacks."""
    agents = [
        Agent(agent=number, joints=listed(person), confidence=[1.0] * 15) for number, person in enumerate(joints, 1)
    ]
    return Skeleton(stamp_ns=stamp_ns, seq=seq, sensor="kinect0", agents=agents, session_id=session_id)


def listed(joints: NDArray[np.float64]) -> list[Joint]:
    return [None if np.isnan(joint).any() else joint.tolist() for joint in joints]


def reaches(frames: int, first_ns: int = 0, seed: int = 0, noise_m: float = 0.003) -> list[Skeleton]:
    """Make a stream of one person who reaches forward and back once."""
    rng = np.random.default_rng(seed)
    phases = np.sin(np.linspace(0, np.pi, frames))
    return [
        skeleton(first_ns + i * FRAME_NS, reaching(phase) + rng.normal(0, noise_m, (15, 3)), seq=i)
        for i, phase in enumerate(phases)
    ]


def postures(from_s: float, to_s: float) -> list[Posture]:
    """Postures of a person who reaches, thirty a second."""
    node = PosePreprocessor(PoseSettings.defaults())
    frames = reaches(round(to_s * SECOND_NS / FRAME_NS))
    found = [posture for frame in frames for posture in node.handle(frame) if isinstance(posture, Posture)]
    return [posture for posture in found if posture.stamp_ns >= from_s * SECOND_NS]


def marks(name: str, start_s: float, end_s: float) -> list[Segment]:
    bounds = (("start", start_s), ("end", end_s))
    return [
        Segment(sensor="kinect0", kind=kind, segment_id=name, stamp_ns=round(stamp_s * SECOND_NS))
        for kind, stamp_s in bounds
    ]
