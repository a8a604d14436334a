"""MediaPipe's 33 landmarks of a person, and the table that maps them to the fifteen joints."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from actum.arrays import Array
from actum.skeletons import JOINTS

LANDMARKS: tuple[str, ...] = (
    "nose",
    "left_eye_inner", "left_eye", "left_eye_outer", "right_eye_inner", "right_eye", "right_eye_outer",
    "left_ear", "right_ear",
    "mouth_left", "mouth_right",
    "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow",
    "left_wrist", "right_wrist",
    "left_pinky", "right_pinky", "left_index", "right_index", "left_thumb", "right_thumb",
    "left_hip", "right_hip",
    "left_knee", "right_knee",
    "left_ankle", "right_ankle",
    "left_heel", "right_heel",
    "left_foot_index", "right_foot_index",
)  # fmt: skip
"""Names of the landmarks in MediaPipe's order; left and right are the actor's own."""

MEDIAPIPE_33: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "head": ("left_ear", "right_ear"),
        "neck": ("left_shoulder", "right_shoulder"),
        "torso": ("left_shoulder", "right_shoulder", "left_hip", "right_hip"),
        "left_shoulder": ("left_shoulder",),
        "left_elbow": ("left_elbow",),
        "left_hand": ("left_wrist", "left_pinky", "left_index"),
        "right_shoulder": ("right_shoulder",),
        "right_elbow": ("right_elbow",),
        "right_hand": ("right_wrist", "right_pinky", "right_index"),
        "left_hip": ("left_hip",),
        "left_knee": ("left_knee",),
        "left_foot": ("left_ankle", "left_foot_index"),
        "right_hip": ("right_hip",),
        "right_knee": ("right_knee",),
        "right_foot": ("right_ankle", "right_foot_index"),
    }
)
"""The landmarks whose mean is each joint: as with NiTE, the head's and the palms' joints are their centres."""


def _weights() -> Array:
    weights = np.zeros((len(JOINTS), len(LANDMARKS)))
    for row, joint in enumerate(JOINTS):
        names = MEDIAPIPE_33[joint]
        weights[row, [LANDMARKS.index(name) for name in names]] = 1 / len(names)
    return weights


_WEIGHTS = _weights()
_PARTS = _WEIGHTS > 0


@dataclass(frozen=True)
class Landmarks:
    """One person in one image.

    Attributes:
        image_px: (33, 2), positions in the image; they may lie outside it.
        world_m: (33, 3), metric positions of a body of the model's size; origin between the hips, the camera's axes
            (x right, y down, z forward).
        visibility: (33,), in [0, 1].
    """

    image_px: Array
    world_m: Array
    visibility: Array


def joints_of(points: Array) -> Array:
    """Return the joints (15, d), each the mean of its landmarks, from landmarks (33, d)."""
    return _WEIGHTS @ points


def confidence_of(visibility: Array) -> Array:
    """Return each joint's confidence (15,): the least visibility of its landmarks, from visibility (33,)."""
    return np.asarray(np.where(_PARTS, visibility, np.inf).min(axis=1))
