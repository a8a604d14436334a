"""What the tests of imported Kinect v1 sets look at in a take."""

import numpy as np

from actum.messages import Segment
from actum.skeletons import INDEX
from actum_dataset_importer.takes import Take

SOURCE_JOINTS = [
    "hip_center",
    "torso",
    "neck",
    "head",
    *(f"left_{joint}" for joint in ("shoulder", "elbow", "wrist", "hand")),
    *(f"right_{joint}" for joint in ("shoulder", "elbow", "wrist", "hand")),
    *(f"left_{joint}" for joint in ("hip", "knee", "ankle", "foot")),
    *(f"right_{joint}" for joint in ("hip", "knee", "ankle", "foot")),
]
"""The set's own order of its twenty joints, by our names where we have the joint."""


def times(marks: list[Segment]) -> list[tuple[str, str, int, str | None]]:
    return [(mark.kind, mark.segment_id, mark.stamp_ns, mark.label) for mark in marks]


def facing(take: Take) -> float:
    """Median cosine between the body's forward axis (left x up) and the way from the torso to the camera."""
    joints = np.array([frame.agents[0].joints for frame in take.frames if frame.agents])
    left = joints[:, INDEX["left_hip"]] - joints[:, INDEX["right_hip"]]
    up = joints[:, INDEX["torso"]] - (joints[:, INDEX["left_hip"]] + joints[:, INDEX["right_hip"]]) / 2
    forward, to_camera = np.cross(left, up), -joints[:, INDEX["torso"]]
    norms = np.linalg.norm(forward, axis=1) * np.linalg.norm(to_camera, axis=1)
    return float(np.median((forward * to_camera).sum(axis=1) / norms))
