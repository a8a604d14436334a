"""Registration of a template with an image by a similarity: shift, rotation and scale, from grey levels."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array

Points = NDArray[np.complex128]
"""Points of an image as x + i y, in pixels."""

MAX_ITERATIONS = 8
"""Gauss-Newton steps: starts may be as far off as the template's details are wide."""
CONVERGED_PX = 0.02
"""Pixels by which no point of the template moves any more in a step: far below the noise."""
MAX_STEP = 0.2
"""Relative scale, and rotation in radians, by which one step may go: beyond it the linear model is wrong."""
MIN_DEVIATION = 4.0
"""Grey levels by which images differ from noise alone."""
DEVIATIONS_PER_MEDIAN = 1.5
"""Standard deviation of normal residuals over the median of their absolute values: 1.4826, rounded."""


@dataclass(frozen=True)
class Similarity:
    """Maps a template's points z, complex pixels from its centre, to `centre_px` + `scale_rotation` z.

    The scale is |`scale_rotation`|, the rotation its argument in radians.
    """

    centre_px: complex
    scale_rotation: complex = 1.0


class Template:
    """A disc of a grey image, to be registered with others (Baker and Matthews 2004, inverse compositional)."""

    def __init__(self, image: Array, centre_px: complex, radius_px: float) -> None:
        """Cut it out of a blurred image (height, width), whose edge is repeated beyond it."""
        reach = max(round(radius_px), 2)
        y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        disc = np.hypot(x, y) <= reach
        self._points: Points = (x + 1j * y)[disc]
        self._reach_px = reach
        self._square = _sampled(image, centre_px + x + 1j * y)
        self._levels = self._square[disc]
        slopes: Array = np.asarray(np.gradient(self._square), dtype=np.float64)
        gy, gx = slopes[:, disc]
        self._max_step = np.array([reach, reach, MAX_STEP, MAX_STEP, np.inf, np.inf])
        px, py = self._points.real, self._points.imag
        by_scale, by_rotation = gx * px + gy * py, gy * px - gx * py
        self._jacobian = np.stack([gx, gy, by_scale, by_rotation, self._levels, np.ones_like(gx)], axis=1)

    @property
    def width_px(self) -> int:
        """Width and height of the square around it."""
        return len(self._square)

    def search(self, image: Array) -> complex:
        """Find the centre, in whole pixels, where it correlates best with a blurred image (height, width).

        Rotation and scale are those of the template.
        """
        correlations = cv2.matchTemplate(
            image.astype(np.float32), self._square.astype(np.float32), cv2.TM_CCOEFF_NORMED
        )
        left, top = cv2.minMaxLoc(correlations)[3]
        return complex(left, top) + self._reach_px * (1 + 1j)

    def register(self, image: Array, start: Similarity) -> tuple[Similarity, float]:
        """Register it with a blurred image (height, width) from a start nearby.

        Robust Gauss-Newton steps decrease the sum of rho(I(W z) - (1 + g) T(z) - o) over its points z, with gain g,
        offset o and Cauchy's rho.

        Returns:
            Where it is, and its normalised cross-correlation, weighted by what is not hidden by something else.
        """
        centre, scale_rotation, weight = start.centre_px, start.scale_rotation, np.ones(len(self._levels))
        for _ in range(MAX_ITERATIONS):
            error = _sampled(image, centre + scale_rotation * self._points) - self._levels
            weighted = self._jacobian * weight[:, None]
            step = np.linalg.lstsq(weighted.T @ self._jacobian, weighted.T @ error, rcond=None)[0]
            residual = error - self._jacobian @ step
            step = np.clip(step, -self._max_step, self._max_step)
            deviation = max(MIN_DEVIATION, DEVIATIONS_PER_MEDIAN * float(np.median(np.abs(residual))))
            weight = 1 / (1 + (residual / deviation) ** 2)
            scale_rotation = scale_rotation / complex(1 + step[2], step[3])
            centre = centre - scale_rotation * complex(step[0], step[1])
            if np.abs(step[:2]).max() < CONVERGED_PX and self._reach_px * np.abs(step[2:4]).max() < CONVERGED_PX:
                break
        levels = _sampled(image, centre + scale_rotation * self._points)
        return Similarity(centre, scale_rotation), self._correlation(levels, weight)

    def _correlation(self, levels: Array, weight: Array) -> float:
        """Normalised cross-correlation of the template with levels (m,), weighted by (m,); 0 where one is flat."""
        share = weight / weight.sum()
        one, other = levels - share @ levels, self._levels - share @ self._levels
        scale = float(np.sqrt((share @ one**2) * (share @ other**2)))
        return float(share @ (one * other)) / scale if scale > 0 else 0.0


def _sampled(image: Array, points_px: Points) -> Array:
    """Sample at points of any shape."""
    x, y = (part.reshape(1, -1).astype(np.float32) for part in (points_px.real, points_px.imag))
    sampled = cv2.remap(image.astype(np.float32), x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, dtype=np.float64).reshape(points_px.shape)
