"""The pinhole camera and the drawing of shapes, anti-aliased and at subpixel positions."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from scene_simulator.parameters import CameraParameters

Canvas = NDArray[np.uint8]
Colour = tuple[int, int, int]

SUBPIXEL_BITS = 4
"""Fractional bits of OpenCV's coordinates: at sixteenths of a pixel slow motion looks smooth."""
CIRCLE = np.stack([np.cos(a := np.linspace(0, 2 * np.pi, 24, endpoint=False)), np.sin(a)], axis=-1)
"""Points (24, 2) of the unit circle."""


@dataclass(frozen=True)
class Pinhole:
    """An ideal camera; pixel centres lie at whole numbers."""

    width: int
    height: int
    focal_px: float

    @classmethod
    def of(cls, parameters: CameraParameters) -> "Pinhole":
        """Build the camera that the parameters describe."""
        return cls(parameters.width, parameters.height, parameters.focal_px)

    @property
    def matrix(self) -> Array:
        """The intrinsic matrix K (3, 3)."""
        f = self.focal_px
        return np.array([[f, 0, (self.width - 1) / 2], [0, f, (self.height - 1) / 2], [0, 0, 1]])

    def project(self, points_m: Array) -> Array:
        """Project points (..., 3) to pixels (..., 2)."""
        centre = ((self.width - 1) / 2, (self.height - 1) / 2)
        return centre + self.focal_px * points_m[..., :2] / points_m[..., 2:]

    def pixels(self, length_m: float, depth_m: float) -> float:
        """Return the length in pixels of a length in metres at a depth."""
        return self.focal_px * length_m / depth_m


def shade(colour: Colour, factor: float) -> Colour:
    """Make a colour lighter (above 1) or darker."""
    blue, green, red = (min(max(int(channel * factor), 0), 255) for channel in colour)
    return blue, green, red


def polygon(canvas: Canvas, corners_px: Array, colour: Colour) -> None:
    """Fill a convex polygon (n, 2)."""
    cv2.fillConvexPoly(canvas, _fixed_point(corners_px), colour, cv2.LINE_AA, SUBPIXEL_BITS)


def line(canvas: Canvas, points_px: Array, colour: Colour, width_px: int = 1) -> None:
    """Draw an open line through points (n, 2)."""
    cv2.polylines(canvas, [_fixed_point(points_px)], False, colour, width_px, cv2.LINE_AA, SUBPIXEL_BITS)


def hull(canvas: Canvas, points_px: Array, colour: Colour) -> None:
    """Fill the convex hull of points (n, 2)."""
    polygon(canvas, np.asarray(cv2.convexHull(points_px.astype(np.float32)), dtype=float)[:, 0], colour)


def ellipse_px(centre_px: Array, radius_px: float, stretch: float = 1.0) -> Array:
    """Return the outline (24, 2) of a disc, or of an ellipse `stretch` times as high as wide."""
    return np.asarray(centre_px + radius_px * CIRCLE * (1.0, stretch))


def blob(camera: Pinhole, centres_m: Array, radii_m: tuple[float, ...]) -> Array:
    """Return outline points (24 n, 2) of balls with centres (n, 3) and radii (n): their hull is a limb or a trunk."""
    radii_px = camera.focal_px * np.array(radii_m) / centres_m[:, 2]
    return np.asarray(camera.project(centres_m)[:, None] + radii_px[:, None, None] * CIRCLE).reshape(-1, 2)


def limb(canvas: Canvas, camera: Pinhole, ends_m: Array, radii_m: tuple[float, float], colour: Colour) -> None:
    """Draw a tapering limb between two points (2, 3; m), with a dark rim and a lighter core."""
    for factor, scale in ((0.72, 1.0), (1.0, 0.86), (1.08, 0.45)):
        hull(canvas, blob(camera, ends_m, (radii_m[0] * scale, radii_m[1] * scale)), shade(colour, factor))


def _fixed_point(points_px: Array) -> NDArray[np.int32]:
    return np.round(points_px * (1 << SUBPIXEL_BITS)).astype(np.int32)
