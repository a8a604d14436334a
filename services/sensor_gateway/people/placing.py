"""Places a person's landmarks in the camera frame, in metres.

MediaPipe's world landmarks have a body's shape but no position, and their axes are rotated with the ray to the person.
They are rotated back and translated to where they project best onto the image landmarks. The distance follows from the
body's size, which is about the same for everybody in the model's output. A pose model without world landmarks leaves
the body's shape open: the body is then taken to be flat, parallel to the image, with a trunk of standard length.
"""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX
from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks

MODEL_HEIGHT_M = 1.64
"""The stature of the model's body: 1.46 m from ankle to ear, which is 0.89 of a stature."""

SIZE_STD = 0.07
"""Relative standard deviation of people's size from the model's body."""

KNOWN_SIZE_STD = 0.03
"""Relative standard deviation if the stature is known: the model's bone lengths vary with the posture."""

TRUNK_M = 0.288 * MODEL_HEIGHT_M
"""Length of the trunk of the model's body from shoulders to hips, by the usual share of a person's stature."""

NEAREST_M = 0.2
"""Least depth of a landmark: a nearer one means a wrong fit."""

LEAST_WEIGHT = 1e-3
"""Weight of an invisible landmark: keeps the fit solvable."""


@dataclass(frozen=True)
class Placed:
    """One person in the camera frame.

    Attributes:
        joints_m: (15, 3), positions in the camera frame.
        confidence: (15,), in [0, 1].
        depth_std_m: the standard deviation of the distance; None if the distance is measured.
    """

    joints_m: Array
    confidence: Array
    depth_std_m: float | None


class PlacingError(ValueError):
    """The landmarks fit no place in front of the camera."""


def placed(landmarks: Landmarks, lens: Lens, person_height_m: float | None = None) -> Placed:
    """Place one person at the distance that fits the size of the model's body, or of a person of the given stature.

    Raises:
        PlacingError: the landmarks fit no place in front of the camera.
    """
    scale = 1.0 if person_height_m is None else person_height_m / MODEL_HEIGHT_M
    rays = lens.rays(landmarks.image_px)
    points_m = posed(landmarks, rays, scale)
    size_std = SIZE_STD if person_height_m is None else KNOWN_SIZE_STD
    joints_m = landmarks.joints(points_m)
    return Placed(joints_m, landmarks.confidence, float(size_std * joints_m[:, 2].mean()))


def posed(landmarks: Landmarks, rays: Array, scale: float = 1.0) -> Array:
    """Return points (n, 3) rotated and translated to where they project best onto rays (n, 2; x, y at z = 1).

    The translation t minimises Σ w² ‖(p + t)_xy - r (p + t)_z‖² over rotated points p, their rays r and visibility w.

    Raises:
        PlacingError: the best translation puts a landmark behind the camera or nearer than `NEAREST_M`, or the trunk of
            a flat body has no length in the image.
    """
    world_m = flat(landmarks, rays) if landmarks.world_m is None else landmarks.world_m
    weights = np.maximum(landmarks.visibility, LEAST_WEIGHT)
    rotated = world_m * scale @ rotation_to_ray(np.average(rays, axis=0, weights=weights)).T
    coefficients = np.zeros((len(rays), 2, 3))
    coefficients[:, 0, 0] = coefficients[:, 1, 1] = 1
    coefficients[:, :, 2] = -rays
    wanted = rays * rotated[:, 2:] - rotated[:, :2]
    weighted = coefficients * weights[:, None, None], wanted * weights[:, None]
    translation = np.linalg.lstsq(weighted[0].reshape(-1, 3), weighted[1].reshape(-1), rcond=None)[0]
    points_m: Array = rotated + translation
    if not (points_m[:, 2].min() > NEAREST_M and np.isfinite(points_m).all()):
        raise PlacingError(
            "no position in front of the camera agrees with the body points found in the image, so this detection of a "
            "person is not used"
        )
    return points_m


def flat(landmarks: Landmarks, rays: Array) -> Array:
    """Return points (n, 3; m) with the shape of the image, turned from the ray to the person as world landmarks are.

    Raises:
        PlacingError: the trunk has no length in the image.
    """
    joints = landmarks.joints(rays)
    trunk = np.linalg.norm(joints[INDEX["neck"]] - joints[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0))
    if not trunk > 0:
        raise PlacingError(
            "the neck and the hips lie at the same point of the image, so the person's distance cannot be estimated "
            "and this detection is not used"
        )
    sight = np.average(rays, axis=0, weights=np.maximum(landmarks.visibility, LEAST_WEIGHT))
    return np.column_stack([(rays - sight) * TRUNK_M / trunk, np.zeros(len(rays))]) @ rotation_to_ray(sight)


def rotation_to_ray(ray: Array) -> Array:
    """Return the smallest rotation (3, 3) that turns the optical axis onto a ray (2,; x, y at z = 1)."""
    x, y, z = np.array([*ray, 1.0]) / np.linalg.norm([*ray, 1.0])
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 + z))
