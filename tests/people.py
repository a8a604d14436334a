"""Synthetic people for tests: joints in the camera frame, and the messages that carry them."""

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent, Skeleton

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


def skeleton(stamp_ns: int, *joints: NDArray[np.float64], seq: int | None = None, session_id: str = "test") -> Skeleton:
    """Make a skeleton message of agents 1, 2, … with the given joints."""
    agents = [
        Agent(agent=number, joints=person.tolist(), confidence=[1.0] * 15) for number, person in enumerate(joints, 1)
    ]
    return Skeleton(stamp_ns=stamp_ns, seq=seq, sensor="kinect0", agents=agents, session_id=session_id)


def reaches(frames: int, first_ns: int = 0, seed: int = 0, noise_m: float = 0.003) -> list[Skeleton]:
    """Make a stream of one person who reaches forward and back once."""
    rng = np.random.default_rng(seed)
    phases = np.sin(np.linspace(0, np.pi, frames))
    return [
        skeleton(first_ns + i * FRAME_NS, reaching(phase) + rng.normal(0, noise_m, (15, 3)), seq=i)
        for i, phase in enumerate(phases)
    ]
