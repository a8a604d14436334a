"""Registration of a template with a grey image by a similarity: shift, rotation and scale."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array

Points = NDArray[np.complex128]
"""Points of an image as x + i y, in pixels."""

MAX_ITERATIONS = 8
"""Gauss-Newton steps: the start may be off by the width of the template's details."""
CONVERGED_PX = 0.02
"""Pixels: iteration stops when a step moves every point of the template by less, far below the noise."""
MAX_STEP = 0.2
"""Largest change in one step of the relative scale, and of the rotation in radians: the model is linear up to there."""
MIN_DEVIATION = 4.0
"""Least scale of residuals in the robust cost, in grey levels: images differ by that from noise alone."""
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
    """A disc of a grey image that is registered with other images (inverse compositional, Baker and Matthews 2004)."""

    def __init__(self, image: Array, centre_px: complex, radius_px: float) -> None:
        """Cut the disc out of a blurred image (height, width); beyond its edges, edge pixels are repeated."""
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
        """Width and height of the square around the disc."""
        return len(self._square)

    def search(self, image: Array) -> complex:
        """Find the centre, in whole pixels, at which the template correlates best with a blurred image (height, width).

        The template is neither turned nor scaled. The centre is returned as x + i y.
        """
        correlations = cv2.matchTemplate(
            image.astype(np.float32), self._square.astype(np.float32), cv2.TM_CCOEFF_NORMED
        )
        left, top = cv2.minMaxLoc(correlations)[3]
        return complex(left, top) + self._reach_px * (1 + 1j)

    def register(self, image: Array, start: Similarity) -> tuple[Similarity, float]:
        """Register the template with a blurred image (height, width), from a start nearby.

        Robust Gauss-Newton steps decrease the sum of rho(I(W z) - (1 + g) T(z) - o) over the template's points z, with
        gain g, offset o and Cauchy's rho.

        Returns:
            The similarity, and the normalised cross-correlation weighted by the robust weights, which leave out points
            that something else hides.
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
    """Sample grey levels of an image (height, width) at points of any shape: the same shape."""
    x, y = (part.reshape(1, -1).astype(np.float32) for part in (points_px.real, points_px.imag))
    sampled = cv2.remap(image.astype(np.float32), x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, dtype=np.float64).reshape(points_px.shape)
