"""What a pose model finds of a person in an image: its own points, and how they make the fifteen joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.skeletons import JOINTS


@dataclass(frozen=True)
class Landmarks:
    """One person in one image: the n points of a pose model, in the model's own order.

    Attributes:
        image_px: (n, 2), positions in the image; they may lie outside it.
        visibility: (n,), in [0, 1].
        joint_weights: (15, n), the share of each point in each joint; every row sums to 1.
        world_m: (n, 3), metric positions of a body of average size; any origin, the camera's axes (x right, y down,
            z forward). None if the pose model finds positions in the image only.
    """

    image_px: Array
    visibility: Array
    joint_weights: Array
    world_m: Array | None

    def joints(self, points: Array) -> Array:
        """Return the joints (15, d), each the weighted mean of its points, from points (n, d)."""
        return self.joint_weights @ points

    @property
    def confidence(self) -> Array:
        """The confidence of each joint (15,): the least visibility of its points."""
        return np.asarray(np.where(self.joint_weights > 0, self.visibility, np.inf).min(axis=1))


def joint_weights(names: Sequence[str], points_of_joint: Mapping[str, tuple[str, ...]]) -> Array:
    """Return weights (15, n) that make each joint the mean of some of a model's n points, whose names are given."""
    weights = np.zeros((len(JOINTS), len(names)))
    for row, joint in enumerate(JOINTS):
        points = points_of_joint[joint]
        weights[row, [names.index(name) for name in points]] = 1 / len(points)
    return weights


class Estimator(Protocol):
    """A pose model: detects people in images."""

    def people(self, image_bgr: NDArray[np.uint8], stamp_ns: int) -> list[Landmarks]:
        """Return the landmarks of the people detected in an image (height, width, 3; BGR); stamps rise."""
        ...


class Nobody:
    """The estimator of sources whose images are not searched for people."""

    def people(self, image_bgr: NDArray[np.uint8], stamp_ns: int) -> list[Landmarks]:
        """Return no detections."""
        return []
