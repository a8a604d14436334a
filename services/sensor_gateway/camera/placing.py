"""A person's landmarks placed in the camera frame, in metres.

MediaPipe's world landmarks have a body's shape but no place, and axes turned with the line of sight to the person.
They are turned back and moved to where they project best onto the image landmarks. How far away that is rests on the
body's size: by itself the model gives everybody about the same.
"""

from dataclasses import dataclass

import numpy as np

from sensor_gateway.camera.landmarks import Array, Landmarks, confidence_of, joints_of
from sensor_gateway.camera.lens import Lens

MODEL_HEIGHT_M = 1.64
"""The stature of the model's body: 1.46 m from ankle to ear, which is 0.89 of a stature."""

SIZE_STD = 0.07
"""By how much people differ in size from the model's body, as a share."""

KNOWN_SIZE_STD = 0.03
"""The same where the stature is known: the model's bones change with the posture."""

NEAREST_M = 0.2
LEAST_WEIGHT = 1e-3


@dataclass(frozen=True)
class Placed:
    """One person: joints (15, 3; m, camera frame), confidence (15,), standard deviation of the distance (m).

    The deviation is None where the distance is measured.
    """

    joints_m: Array
    confidence: Array
    depth_std_m: float | None


class PlacingError(ValueError):
    """The landmarks fit no place in front of the camera."""


def placed(landmarks: Landmarks, lens: Lens, person_height_m: float | None = None) -> Placed:
    """Place one person.

    Raises:
        PlacingError: the landmarks fit no place in front of the camera.
    """
    scale = 1.0 if person_height_m is None else person_height_m / MODEL_HEIGHT_M
    sights = lens.sights(landmarks.image_px)
    points_m = located(landmarks.world_m * scale, sights, landmarks.visibility)
    size_std = SIZE_STD if person_height_m is None else KNOWN_SIZE_STD
    joints_m = joints_of(points_m)
    return Placed(joints_m, confidence_of(landmarks.visibility), float(size_std * joints_m[:, 2].mean()))


def located(world_m: Array, sights: Array, visibility: Array) -> Array:
    """Turn and move world landmarks (33, 3) to where they project best onto lines of sight (33, 2).

    The translation t minimises Σ w² ‖(p + t)_xy - s (p + t)_z‖² over turned points p, their sights s and visibility w.

    Raises:
        PlacingError: the best place is behind the camera or right at it.
    """
    weights = np.maximum(visibility, LEAST_WEIGHT)
    turned = world_m @ turned_to(np.average(sights, axis=0, weights=weights)).T
    coefficients = np.zeros((len(sights), 2, 3))
    coefficients[:, 0, 0] = coefficients[:, 1, 1] = 1
    coefficients[:, :, 2] = -sights
    wanted = sights * turned[:, 2:] - turned[:, :2]
    weighted = coefficients * weights[:, None, None], wanted * weights[:, None]
    translation = np.linalg.lstsq(weighted[0].reshape(-1, 3), weighted[1].reshape(-1), rcond=None)[0]
    points_m: Array = turned + translation
    if not (points_m[:, 2].min() > NEAREST_M and np.isfinite(points_m).all()):
        raise PlacingError("the landmarks fit no place in front of the camera")
    return points_m


def turned_to(sight: Array) -> Array:
    """Return the smallest rotation (3, 3) that turns the optical axis to a line of sight (x, y at z = 1)."""
    x, y, z = np.array([*sight, 1.0]) / np.linalg.norm([*sight, 1.0])
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 + z))
