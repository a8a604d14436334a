"""The camera that sees people, and where their joints are in its image: ROS4HRI's skeleton in 2-D, and region."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from actum import geometry
from actum.arrays import Array
from actum.messages import Image
from actum.skeletons import INDEX
from ros2_bridge.hri.types import POINT, REGION, SKELETON_2D
from ros2_bridge.message_types import made

KEYPOINTS = (
    *("head", "neck"),
    *(f"{side}_{joint}" for side in ("right", "left") for joint in ("shoulder", "elbow", "hand")),
    *(f"{side}_{joint}" for side in ("right", "left") for joint in ("hip", "knee", "foot")),
)
"""Our joints in the order of Skeleton2D's first fourteen points. The head's middle stands for the nose, hands and feet
for wrists and ankles; eyes and ears are not known."""
_KEYPOINT_JOINTS = [INDEX[joint] for joint in KEYPOINTS]
"""The index of each of these joints."""
FACE_POINTS = 4
"""How many points are left out after these: left eye, right eye, left ear, right ear."""
MARGIN_M = 0.12
"""How far a body reaches beyond its joints (m): half a head, or a hand beyond the wrist."""
NEAREST_M = 0.1
"""Joints nearer to the camera's plane than this (m) have no place in the image."""
MOST_COEFFICIENTS = 12
"""Of the lens's distortion those without a tilted sensor: radial (6), tangential (2), thin prism (4)."""
MOST_PX = 1e6
"""Largest focal length (px)."""
RADII = np.linspace(0.0, 5.0, 501)
"""Distances from the line of sight, on the plane at distance 1, at which a lens is looked at: up to 79 degrees."""
FURTHEST_M = 100.0
"""Most distance (m) of the camera from that of the skeletons, beyond which the transform between them is an error."""


class UnusableCameraError(ValueError):
    """An image whose camera shows nothing; the text says why."""


@dataclass(frozen=True)
class Camera:
    """A camera of the skeletons' sensor.

    Attributes:
        matrix: (3, 3), px.
        distortion: (12,), OpenCV's coefficients in the order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4.
        size_px: width and height.
        image_from_skeleton: (4, 4), m.
    """

    matrix: Array
    distortion: Array
    size_px: tuple[int, int]
    image_from_skeleton: Array

    @classmethod
    def of(cls, image: Image) -> Self:
        """Return the camera of an image.

        Raises:
            UnusableCameraError: its focal lengths or its place cannot be.
        """
        skeleton_from_image = geometry.from_flat(image.skeleton_from_image)
        if not (0 < image.K[0] < MOST_PX and 0 < image.K[4] < MOST_PX):
            raise UnusableCameraError(
                f"the focal lengths in the camera matrix K {image.K} must be above 0 and below {MOST_PX:g} px: "
                "calibrate the camera with 'actum calibrate intrinsics'"
            )
        if not geometry.is_rigid(skeleton_from_image, FURTHEST_M):
            raise UnusableCameraError(
                f"skeleton_from_image must be a rotation with a shift of at most {FURTHEST_M:g} m, but is "
                f"{image.skeleton_from_image}: run 'actum calibrate extrinsics' again"
            )
        given = np.array(image.distortion[:MOST_COEFFICIENTS], dtype=np.float64)
        return cls(
            np.array(image.K, dtype=np.float64).reshape(3, 3),
            np.pad(given, (0, MOST_COEFFICIENTS - len(given))),
            (image.width, image.height),
            geometry.invert(skeleton_from_image),
        )

    def seen(self, joints: Array, confidence: Sequence[float]) -> "InImage":
        """Return where joints (15, 3; m, NaN where unknown) are in the image."""
        there = geometry.apply(self.image_from_skeleton, joints)
        distance = np.where(there[:, 2] >= NEAREST_M, there[:, 2], np.nan)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # coefficients may be absurd
            plane = self._distorted(there[:, :2] / distance[:, None])
            places = (plane @ self.matrix[:2, :2].T + self.matrix[:2, 2]) / self.size_px
        inside = np.logical_and(places >= 0, places <= 1).all(axis=1, keepdims=True)
        return InImage(np.where(inside, places, np.nan), distance, confidence, self)

    def _distorted(self, plane: Array) -> Array:
        """Return points of the plane at distance 1 (n, 2) as the lens shows them, by OpenCV's model.

        NaN for points further out than the model holds: its polynomials turn back, and would show them in the image.
        """
        if not self.distortion.any():
            return plane
        _, _, p1, p2, *_, s1, s2, s3, s4 = self.distortion
        turns = np.flatnonzero(~(np.diff(RADII * self._radial(RADII**2)) > 0))
        x, y = plane.T
        r2 = x * x + y * y
        if len(turns):
            r2 = np.where(r2 <= RADII[turns[0]] ** 2, r2, np.nan)
        radial = self._radial(r2)
        across = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (s1 + r2 * s2)
        down = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (s3 + r2 * s4)
        return np.stack([across, down], axis=1)

    def _radial(self, r2: Array) -> Array:
        """Return by how much the lens moves points outwards whose squared distances from the axis are these."""
        k1, k2, _, _, k3, k4, k5, k6, *_ = self.distortion
        moved: Array = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        return moved


@dataclass(frozen=True)
class InImage:
    """One person's joints in an image.

    Attributes:
        places: (15, 2), 0 to 1 of the image's width and height; NaN where unknown, behind the camera, or outside.
        distances_m: (15,), from the camera's plane.
        confidence: (15,), of the source.
        camera: the camera.
    """

    places: Array
    distances_m: Array
    confidence: Sequence[float]
    camera: Camera

    def skeleton_2d(self, header: Any) -> Any:
        """Return a Skeleton2D; the confidence of a point that is not known is 0."""
        places, confidence = self.places.tolist(), self.confidence
        points = [_point(places[i], confidence[i]) for i in _KEYPOINT_JOINTS]
        return made(SKELETON_2D, header=header, skeleton=points + [made(POINT)] * FACE_POINTS)

    def region(self, header: Any) -> Any | None:
        """Return the region around the joints with what a body reaches beyond them; None where no joint is seen."""
        joints = zip(self.places.tolist(), self.distances_m.tolist(), self.confidence, strict=True)
        known = [(x, y, MARGIN_M / distance, sure) for (x, y), distance, sure in joints if not math.isnan(x)]
        if not known:
            return None
        across, down = (
            self.camera.matrix[0, 0] / self.camera.size_px[0],
            self.camera.matrix[1, 1] / self.camera.size_px[1],
        )
        return made(
            REGION,
            header=header,
            xmin=_within(min(x - margin * across for x, _, margin, _ in known)),
            ymin=_within(min(y - margin * down for _, y, margin, _ in known)),
            xmax=_within(max(x + margin * across for x, _, margin, _ in known)),
            ymax=_within(max(y + margin * down for _, y, margin, _ in known)),
            c=_within(sum(sure for *_, sure in known) / len(known)),
        )


def _point(place: Sequence[float], confidence: float) -> Any:
    x, y = place
    return made(POINT) if math.isnan(x) else made(POINT, x=x, y=y, c=_within(confidence))


def _within(number: float) -> float:
    """Return a number, or the nearest from 0 to 1."""
    return float(min(1.0, max(0.0, number)))
