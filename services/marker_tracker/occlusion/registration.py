"""Where a patch of one image is in another: shifted, turned and larger or smaller, by its grey levels."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]

BLUR_PX = 0.8
ITERATIONS = 8
SETTLED_PX = 0.02
MOST_TURN = 0.2
"""By how much, in parts and in radians, one step may grow and turn."""
LEAST_DEVIATION = 4.0
"""Grey levels by which patches differ from noise alone."""


@dataclass(frozen=True)
class Similarity:
    """Maps a patch's points, complex pixels from its middle, to `middle_px` + `turn` z: `turn` grows and rotates."""

    middle_px: complex
    turn: complex = 1.0


class Patch:
    """A round piece of a grey image, to be found again (Baker and Matthews 2004, inverse compositional)."""

    def __init__(self, window: Array, middle_px: complex, radius_px: float) -> None:
        """Cut it out of a blurred image (height, width), whose edge is repeated beyond it."""
        reach = max(round(radius_px), 2)
        y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        self._inside = np.hypot(x, y) <= reach
        self._points = (x + 1j * y)[self._inside]
        self.levels = _levels(window, middle_px + x + 1j * y)
        self._known = self.levels[self._inside]
        slopes: Array = np.asarray(np.gradient(self.levels), dtype=np.float64)
        gy, gx = slopes[:, self._inside]
        self._furthest = np.array([reach, reach, MOST_TURN, MOST_TURN, np.inf, np.inf])
        px, py = self._points.real, self._points.imag
        larger, turned = gx * px + gy * py, gy * px - gx * py
        self._jacobian = np.stack([gx, gy, larger, turned, self._known, np.ones_like(gx)], axis=1)

    @property
    def reach_px(self) -> int:
        """How far it goes from its middle pixel."""
        return len(self.levels) // 2

    def near(self, window: Array) -> complex:
        """Find where in a blurred image (height, width) it fits best, upright and in its size."""
        fits = cv2.matchTemplate(window.astype(np.float32), self.levels.astype(np.float32), cv2.TM_CCOEFF_NORMED)
        left, top = cv2.minMaxLoc(fits)[3]
        return complex(left, top) + self.reach_px * (1 + 1j)

    def found(self, window: Array, start: Similarity) -> tuple[Similarity, float]:
        """Find it in a blurred image (height, width) from near its place on; and tell how alike it is, at most 1.

        Gauss-Newton steps make small the sum of rho(I(W z) - (1 + g) P(z) - o) over its points z, with gain g, offset
        o and Cauchy's rho. It is as alike as what is not hidden by something else: the correlation, weighted.
        """
        middle, turn, weight = start.middle_px, start.turn, np.ones(len(self._known))
        for _ in range(ITERATIONS):
            error = _levels(window, middle + turn * self._points) - self._known
            weighted = self._jacobian * weight[:, None]
            step = np.linalg.lstsq(weighted.T @ self._jacobian, weighted.T @ error, rcond=None)[0]
            residual = error - self._jacobian @ step
            step = np.clip(step, -self._furthest, self._furthest)
            deviation = max(LEAST_DEVIATION, 1.5 * float(np.median(np.abs(residual))))
            weight = 1 / (1 + (residual / deviation) ** 2)
            turn = turn / complex(1 + step[2], step[3])
            middle = middle - turn * complex(step[0], step[1])
            if np.abs(step[:2]).max() < SETTLED_PX and self.reach_px * np.abs(step[2:4]).max() < SETTLED_PX:
                break
        return Similarity(middle, turn), self._alike(_levels(window, middle + turn * self._points), weight)

    def _alike(self, levels: Array, weight: Array) -> float:
        share = weight / weight.sum()
        one, other = levels - share @ levels, self._known - share @ self._known
        scale = float(np.sqrt((share @ one**2) * (share @ other**2)))
        return float(share @ (one * other)) / scale if scale > 0 else 0.0


def blurred(pixels: Pixels) -> Array:
    """Take the noise off grey levels (height, width)."""
    if not pixels.size:
        return np.zeros(pixels.shape)
    return np.asarray(cv2.GaussianBlur(pixels.astype(np.float32), (0, 0), BLUR_PX), dtype=np.float64)


def _levels(window: Array, points_px: NDArray[np.complex128]) -> Array:
    """Sample at points of any shape."""
    shape = points_px.shape
    x, y = (part.reshape(1, -1).astype(np.float32) for part in (points_px.real, points_px.imag))
    sampled = cv2.remap(window.astype(np.float32), x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, dtype=np.float64).reshape(shape)
