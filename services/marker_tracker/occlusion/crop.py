"""A crop of an image, blurred and scaled, and the mapping between its coordinates and the image's."""

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np

from actum.arrays import Array, Pixels

BLUR_PX = 0.8
"""Standard deviation in pixels: removes noise from gradients, and keeps the texture of a hand."""
HALF_PX = 0.5 + 0.5j
"""Pixels from a pixel's corner to its centre, as x + i y."""


@dataclass(frozen=True)
class Crop:
    """Part of an image.

    Attributes:
        levels: (height, width), blurred grey levels.
        origin_px: the crop's top left pixel in the image, as x + i y.
        scale: the crop's pixels per image pixel, at most 1.
    """

    levels: Array
    origin_px: complex
    scale: float

    @classmethod
    def around(cls, pixels: Pixels, centre_px: complex, radius_px: float, scale: float) -> Self:
        """Cut a square out of a grey image (height, width), clipped at the image's edges."""
        left, top = max(round(centre_px.real - radius_px), 0), max(round(centre_px.imag - radius_px), 0)
        right, bottom = max(round(centre_px.real + radius_px), 0) + 1, max(round(centre_px.imag + radius_px), 0) + 1
        return cls(blurred(scaled(pixels[top:bottom, left:right], scale)), complex(left, top), scale)

    def from_image(self, point_px: complex) -> complex:
        """Map a point x + i y of the image into the crop."""
        return (point_px - self.origin_px + HALF_PX) * self.scale - HALF_PX

    def to_image(self, point_px: complex) -> complex:
        """Map a point x + i y of the crop into the image."""
        return (point_px + HALF_PX) / self.scale - HALF_PX + self.origin_px


def blurred(pixels: Pixels) -> Array:
    """Smooth grey levels (height, width) by a Gaussian of `BLUR_PX`."""
    if not pixels.size:
        return np.zeros(pixels.shape)
    return np.asarray(cv2.GaussianBlur(pixels.astype(np.float32), (0, 0), BLUR_PX), dtype=np.float64)


def scaled(pixels: Pixels, scale: float) -> Pixels:
    """Scale a grey image (height, width) down; one of less than a pixel becomes empty."""
    if scale * min(pixels.shape) < 1:
        return pixels[:0, :0]
    if scale == 1.0:
        return pixels
    return np.asarray(cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)
