"""People as a camera's pose model would tell of them: 33 landmarks of a body whose place is known."""

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import INDEX
from people import STANDING
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.pose_estimator import LANDMARKS, MEDIAPIPE_WEIGHTS

Array = NDArray[np.float64]

EARS_M = 0.07
FACE = {"nose": -0.10, "mouth": -0.09, "eye": -0.08}
"""How far in front of the head's middle these lie."""

K = np.array([[525.0, 0, 319.5], [0, 525.0, 239.5], [0, 0, 1]])


def landmark_points(joints_m: Array) -> Array:
    """Return the 33 points (33, 3) of a body that faces the camera, of which the joints are the middles."""
    return np.array([_point(name, joints_m) for name in LANDMARKS])


def _point(name: str, joints_m: Array) -> Array:
    left = 1.0 if "left" in name else -1.0
    side = "left" if "left" in name else "right"
    part = name.removeprefix(f"{side}_").split("_")[0]
    head = joints_m[INDEX["head"]]
    if name == "nose" or part in ("eye", "mouth"):
        return head + np.array((0.0 if name == "nose" else 0.03 * left, 0.0, FACE.get(part, FACE["nose"])))
    if part == "ear":
        return head + np.array((EARS_M * left, 0.0, 0.0))
    if part in ("wrist", "pinky", "index", "thumb"):
        return joints_m[INDEX[f"{side}_hand"]] + {"wrist": [0, -0.06, 0], "thumb": [0.03, 0, 0]}.get(part, [0, 0.03, 0])
    if part in ("ankle", "heel", "foot"):
        return joints_m[INDEX[f"{side}_foot"]] + {"heel": [0, 0.06, 0.04], "foot": [0, 0.04, -0.07]}.get(
            part, [0, -0.04, 0.07]
        )
    return joints_m[INDEX[f"{side}_{part}"]]


def projected(points_m: Array, matrix: Array = K) -> Array:
    """Project points (n, 3) to pixels (n, 2)."""
    flat = points_m @ matrix.T
    return flat[:, :2] / flat[:, 2:]


def as_seen(points_m: Array, matrix: Array = K, size: float = 1.0) -> Landmarks:
    """Return what a model tells of a body whose points (33, 3) are known.

    It sees a cut of the image around the person, as a camera turned to them would, and gives a body of its own size
    with the origin between the hips and axes of that camera.
    """
    hips = points_m[[LANDMARKS.index("left_hip"), LANDMARKS.index("right_hip")]].mean(axis=0)
    sight = points_m.mean(axis=0) / np.linalg.norm(points_m.mean(axis=0))
    right = np.cross([0.0, 1.0, 0.0], sight)
    right /= np.linalg.norm(right)
    looking = np.array([right, np.cross(sight, right), sight])
    world_m = (points_m - hips) @ looking.T / size
    return Landmarks(projected(points_m, matrix), np.ones(len(points_m)), MEDIAPIPE_WEIGHTS, world_m)


def standing_at(x_m: float, z_m: float, size: float = 1.0) -> Array:
    """Return the points of a standing person whose middle is at that place, at the height of the camera."""
    joints = STANDING - STANDING.mean(axis=0)
    return landmark_points(joints * size + [x_m, 0.1, z_m])
