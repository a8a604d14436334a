"""Two cameras and the board in each pair of pictures, adjusted together to the corners in all pictures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum.calibration import Calibration
from actum_calibrator.board import Array
from actum_calibrator.pairs import Pair
from actum_calibrator.views import View

ITERATIONS = 60
SMALLEST_STEP = 1e-9
DAMPING, GENTLEST, STRONGEST = 1e-3, 1e-12, 1e9


@dataclass(frozen=True)
class Eye:
    """A camera's K and distortion, as OpenCV takes them."""

    matrix: Array
    distortion: Array

    @classmethod
    def of(cls, calibration: Calibration) -> "Eye":
        """Take them from a calibration."""
        return cls(calibration.matrix, np.array(calibration.distortion, dtype=np.float64))

    def residuals_px(self, view: View, pose: Array) -> Array:
        """Corners as projected minus as seen, at a pose of the board: (n, 2)."""
        projected, _ = cv2.projectPoints(view.corners_m, pose[:3], pose[3:], self.matrix, self.distortion)
        residuals: Array = projected.reshape(-1, 2) - view.corners_px
        return residuals

    def linearised(self, view: View, pose: Array) -> tuple[Array, Array]:
        """The same, flat, and its Jacobian by the pose: (2n), (2n, 6)."""
        projected, jacobian = cv2.projectPoints(view.corners_m, pose[:3], pose[3:], self.matrix, self.distortion)
        return (projected.reshape(-1, 2) - view.corners_px).ravel(), np.asarray(jacobian, dtype=np.float64)[:, :6]

    def poses(self, view: View) -> list[Array]:
        """The one or two poses that a plane can have here, by IPPE (Collins and Bartoli 2014), refined: (6) each."""
        _, rotations, positions, _ = cv2.solvePnPGeneric(
            view.corners_m, view.corners_px, self.matrix, self.distortion, flags=cv2.SOLVEPNP_IPPE
        )
        found = [
            self._refined(view, np.asarray(rotation), np.asarray(position))
            for rotation, position in zip(rotations, positions, strict=True)
        ]
        return [pose for pose in found if np.isfinite(pose).all()]

    def _refined(self, view: View, rotation: Array, position: Array) -> Array:
        refined = cv2.solvePnPRefineLM(
            view.corners_m, view.corners_px, self.matrix, self.distortion, rotation, position
        )
        return np.concatenate([np.ravel(part) for part in refined])


@dataclass(frozen=True)
class Adjustment:
    """The outcome: poses are rotation vectors with positions (6), `covariance` (6, 6) is that of the first."""

    people_from_markers: Array
    markers_from_boards: list[Array]
    rms_px: list[float]
    covariance: Array


class Adjuster:
    """Levenberg-Marquardt over the transform between the cameras and the board's pose in every pair.

    Each pair's residuals count by the weight w = 1 / (1 + (rms / `scale_px`)^2), Cauchy's, so that a pair that
    contradicts the others does not draw them along.
    """

    def __init__(self, markers: Eye, people: Eye, pairs: Sequence[Pair], scale_px: float) -> None:
        self._markers, self._people, self._pairs = markers, people, pairs
        self._scale_px = scale_px

    def adjust(self, people_from_markers: Array, markers_from_boards: Sequence[Array]) -> Adjustment:
        """Adjust from a first guess, poses (6) as in `Adjustment`."""
        state, damping = np.concatenate([people_from_markers, *markers_from_boards]), DAMPING
        cost = self._cost(state)
        for _ in range(ITERATIONS):
            normal, gradient = self._normal_equations(state)
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), -gradient)
            if (tried := self._cost(state + step)) < cost:
                state, cost, damping = state + step, tried, max(damping / 10, GENTLEST)
            else:
                damping *= 10
            if np.abs(step).max() < SMALLEST_STEP or damping > STRONGEST:
                break
        return self._outcome(state)

    def _outcome(self, state: Array) -> Adjustment:
        normal, _ = self._normal_equations(state)
        rms = self._rms_px(state)
        count = 2 * sum(len(pair.markers.ids) + len(pair.people.ids) for pair in self._pairs)
        variance = sum(w * r.dot(r) for w, r in self._weighted(state)) / max(1, count - len(state))
        covariance = np.linalg.inv(normal)[:6, :6] * variance
        return Adjustment(state[:6], list(state[6:].reshape(-1, 6)), rms, covariance)

    def _weighted(self, state: Array) -> list[tuple[float, Array]]:
        residuals = [self._residuals(state, place) for place in range(len(self._pairs))]
        return [(1 / (1 + _mean_square(r) / self._scale_px**2), r) for r in residuals]

    def _cost(self, state: Array) -> float:
        """Cauchy's loss: sum of n s^2 log(1 + rms^2 / s^2)."""
        scale = self._scale_px**2
        residuals = [self._residuals(state, place) for place in range(len(self._pairs))]
        return float(sum(len(r) / 2 * scale * np.log1p(_mean_square(r) / scale) for r in residuals))

    def _rms_px(self, state: Array) -> list[float]:
        return [float(np.sqrt(_mean_square(self._residuals(state, place)))) for place in range(len(self._pairs))]

    def _residuals(self, state: Array, place: int) -> Array:
        pair, board = self._pairs[place], state[6 + 6 * place : 12 + 6 * place]
        seen = (
            self._markers.residuals_px(pair.markers, board),
            self._people.residuals_px(pair.people, composed(state[:6], board)),
        )
        return np.concatenate(seen).ravel()

    def _normal_equations(self, state: Array) -> tuple[Array, Array]:
        normal, gradient = np.zeros((len(state), len(state))), np.zeros(len(state))
        for place, (weight, _) in enumerate(self._weighted(state)):
            at = np.r_[0:6, 6 + 6 * place : 12 + 6 * place]
            residuals, jacobian = self._linearised(state[:6], state[at[6:]], self._pairs[place])
            normal[np.ix_(at, at)] += weight * jacobian.T @ jacobian
            gradient[at] += weight * jacobian.T @ residuals
        return normal, gradient

    def _linearised(self, people_from_markers: Array, board: Array, pair: Pair) -> tuple[Array, Array]:
        """One pair's residuals, and their Jacobian by the transform (6) and by the board's pose (6)."""
        whole, by_transform, by_board = composed_with_jacobians(people_from_markers, board)
        near, near_by_board = self._markers.linearised(pair.markers, board)
        far, far_by_whole = self._people.linearised(pair.people, whole)
        jacobian = np.block(
            [[np.zeros((len(near), 6)), near_by_board], [far_by_whole @ by_transform, far_by_whole @ by_board]]
        )
        return np.concatenate([near, far]), jacobian


def composed(b_from_a: Array, a_from_board: Array) -> Array:
    """Chain two poses (6): b_from_board."""
    return composed_with_jacobians(b_from_a, a_from_board)[0]


def composed_with_jacobians(b_from_a: Array, a_from_board: Array) -> tuple[Array, Array, Array]:
    """Chain two poses (6), with the Jacobians (6, 6) by the first and by the second argument."""
    second, first = b_from_a, a_from_board
    r, t, r_r1, r_t1, r_r2, r_t2, t_r1, t_t1, t_r2, t_t2 = cv2.composeRT(first[:3], first[3:], second[:3], second[3:])
    by_second, by_first = np.block([[r_r2, r_t2], [t_r2, t_t2]]), np.block([[r_r1, r_t1], [t_r1, t_t1]])
    return np.concatenate([np.ravel(r), np.ravel(t)]), by_second, by_first


def inverted(pose: Array) -> Array:
    """Invert a pose (6)."""
    rotation, _ = cv2.Rodrigues(pose[:3])
    return np.concatenate([-pose[:3], -rotation.T @ pose[3:]])


def rms_px(residuals: Array) -> float:
    """Root mean square length of residuals (n, 2)."""
    return math.sqrt(_mean_square(residuals.ravel()))


def _mean_square(residuals: Array) -> float:
    """Mean squared length of residuals (2n)."""
    return float(residuals.dot(residuals)) / (len(residuals) / 2)
