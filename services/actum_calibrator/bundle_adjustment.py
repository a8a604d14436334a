"""Bundle adjustment of two cameras: fits their transform and the board's pose in every pair to all detected corners.

A pose (6) is a rotation vector (rad) and a translation (m); `b_from_a` maps points of frame a to frame b.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum.arrays import Array
from actum.calibration import Calibration
from actum_calibrator.board_views import View
from actum_calibrator.pairs import Pair

ITERATIONS = 60  # from a good start about ten suffice
SMALLEST_STEP = 1e-9  # rad and m: far below the accuracy of any board
DAMPING = 1e-3  # of the first step, relative to the diagonal of the normal equations, as Marquardt has it
LEAST_DAMPING = 1e-12  # with less damping a step is a Gauss-Newton step
MOST_DAMPING = 1e9  # if not even so short a step lowers the cost, it is at its minimum


@dataclass(frozen=True)
class CameraModel:
    """A camera's K (3, 3) and distortion, as OpenCV takes them."""

    matrix: Array
    distortion: Array

    @classmethod
    def of(cls, calibration: Calibration) -> "CameraModel":
        """Build the model of a calibration."""
        return cls(calibration.matrix, np.array(calibration.distortion, dtype=np.float64))

    def linearised(self, view: View, camera_from_board: Array) -> tuple[Array, Array]:
        """Return projected minus detected corners (2n,) in px, and their Jacobian (2n, 6) by the board's pose (6)."""
        rotation, position = camera_from_board[:3], camera_from_board[3:]
        projected, jacobian = cv2.projectPoints(view.corners_m, rotation, position, self.matrix, self.distortion)
        errors = np.asarray(projected, dtype=np.float64).ravel() - view.corners_px.ravel()
        return errors, np.asarray(jacobian, dtype=np.float64)[:, :6]

    def pose_candidates(self, view: View) -> list[Array]:
        """Return the one or two refined poses (6) that fit a view of a plane, by IPPE (Collins and Bartoli 2014)."""
        _, rotations, positions, _ = cv2.solvePnPGeneric(
            view.corners_m, view.corners_px, self.matrix, self.distortion, flags=cv2.SOLVEPNP_IPPE
        )
        refined = [
            cv2.solvePnPRefineLM(view.corners_m, view.corners_px, self.matrix, self.distortion, *pose)
            for pose in zip(rotations, positions, strict=True)
        ]
        poses = [np.concatenate([np.ravel(part) for part in pose]) for pose in refined]
        return [pose for pose in poses if np.isfinite(pose).all()]


@dataclass(frozen=True)
class BundleAdjustment:
    """The result: the transform (6), each pair's RMS reprojection error, and the covariance (6, 6) of the transform."""

    people_from_markers: Array
    rms_px: list[float]
    covariance: Array


class BundleAdjuster:
    """Levenberg-Marquardt over the transform between the cameras and the board's pose in every pair.

    Each pair's errors have Cauchy's weight w = 1 / (1 + (rms / `scale_px`)^2), so that a pair that contradicts the
    others has little influence. The parameters (6 + 6 pairs) are the transform from the marker camera to the people
    camera, then the pose of each pair's board in the marker camera.
    """

    def __init__(self, markers: CameraModel, people: CameraModel, pairs: Sequence[Pair], scale_px: float) -> None:
        self._markers, self._people, self._pairs = markers, people, pairs
        self._scale_px = scale_px

    def adjust(self, people_from_markers: Array, markers_from_boards: Sequence[Array]) -> BundleAdjustment:
        """Adjust the parameters, starting from poses (6) of the transform and of each pair's board."""
        parameters, damping = np.concatenate([people_from_markers, *markers_from_boards]), DAMPING
        cost = self._cost(parameters)
        for _ in range(ITERATIONS):
            normal, gradient = self._normal_equations(parameters)
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), -gradient)
            if (tried := self._cost(parameters + step)) < cost:
                parameters, cost, damping = parameters + step, tried, max(damping / 10, LEAST_DAMPING)
            else:
                damping *= 10
            if np.abs(step).max() < SMALLEST_STEP or damping > MOST_DAMPING:
                break
        normal, _ = self._normal_equations(parameters)
        errors_px = self._errors(parameters)
        freedom = max(1, sum(map(len, errors_px)) - len(parameters))
        variance = sum(self._weight(errors) * errors.dot(errors) for errors in errors_px) / freedom
        covariance = np.linalg.inv(normal)[:6, :6] * variance
        return BundleAdjustment(parameters[:6], [rms_px(errors) for errors in errors_px], covariance)

    def rms_px(self, people_from_markers: Array, markers_from_board: Array, pair: Pair) -> float:
        """Return the RMS reprojection error of a pair in both images, at poses (6) of the transform and the board."""
        return rms_px(self._linearised(people_from_markers, markers_from_board, pair)[0])

    def _weight(self, errors: Array) -> float:
        return 1 / (1 + _mean_square(errors) / self._scale_px**2)

    def _cost(self, parameters: Array) -> float:
        """Return Cauchy's loss: the sum of n s^2 log(1 + rms^2 / s^2) over the pairs."""
        scale = self._scale_px**2
        return float(
            sum(len(errors) / 2 * scale * np.log1p(_mean_square(errors) / scale) for errors in self._errors(parameters))
        )

    def _errors(self, parameters: Array) -> list[Array]:
        """Return each pair's reprojection errors (2n,) in both images, n corners together."""
        boards = zip(parameters[6:].reshape(-1, 6), self._pairs, strict=True)
        return [self._linearised(parameters[:6], board, pair)[0] for board, pair in boards]

    def _normal_equations(self, parameters: Array) -> tuple[Array, Array]:
        """Return the weighted J^T J (p, p) and J^T e (p,) of all p parameters; a pair involves only its own board."""
        normal, gradient = np.zeros((len(parameters), len(parameters))), np.zeros(len(parameters))
        for i, pair in enumerate(self._pairs):
            involved = np.r_[0:6, 6 + 6 * i : 12 + 6 * i]
            errors, jacobian = self._linearised(parameters[:6], parameters[involved[6:]], pair)
            weight = self._weight(errors)
            normal[np.ix_(involved, involved)] += weight * jacobian.T @ jacobian
            gradient[involved] += weight * jacobian.T @ errors
        return normal, gradient

    def _linearised(self, people_from_markers: Array, markers_from_board: Array, pair: Pair) -> tuple[Array, Array]:
        """Return one pair's errors (m,), and their Jacobian (m, 12) with respect to transform and board pose."""
        people_from_board, by_transform, by_board = compose_with_jacobians(people_from_markers, markers_from_board)
        in_markers, markers_jacobian = self._markers.linearised(pair.markers, markers_from_board)
        in_people, people_jacobian = self._people.linearised(pair.people, people_from_board)
        jacobian = np.block(
            [
                [np.zeros((len(in_markers), 6)), markers_jacobian],
                [people_jacobian @ by_transform, people_jacobian @ by_board],
            ]
        )
        return np.concatenate([in_markers, in_people]), jacobian


def compose(b_from_a: Array, a_from_board: Array) -> Array:
    """Compose two poses (6) to b_from_board (6)."""
    return compose_with_jacobians(b_from_a, a_from_board)[0]


def compose_with_jacobians(b_from_a: Array, a_from_board: Array) -> tuple[Array, Array, Array]:
    """Compose two poses (6); also return the Jacobians (6, 6) with respect to the first and the second argument."""
    second, first = b_from_a, a_from_board
    r, t, r_r1, r_t1, r_r2, r_t2, t_r1, t_t1, t_r2, t_t2 = cv2.composeRT(first[:3], first[3:], second[:3], second[3:])
    by_second, by_first = np.block([[r_r2, r_t2], [t_r2, t_t2]]), np.block([[r_r1, r_t1], [t_r1, t_t1]])
    return np.concatenate([np.ravel(r), np.ravel(t)]), by_second, by_first


def invert(pose: Array) -> Array:
    """Return the inverse (6) of a pose (6)."""
    rotation, _ = cv2.Rodrigues(pose[:3])
    return np.concatenate([-pose[:3], -rotation.T @ pose[3:]])


def rms_px(errors_px: Array) -> float:
    """Return the root mean square length of flat errors (2n,)."""
    return math.sqrt(_mean_square(errors_px))


def _mean_square(errors: Array) -> float:
    """Return the mean squared length of flat errors (2n,)."""
    return float(errors.dot(errors)) / (len(errors) / 2)
