"""Markers drawn by a pinhole camera from poses that are known exactly, each pixel the mean of what it covers."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.families import family

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

WIDTH, HEIGHT = 640, 480
FOCAL_PX = 525.0
CAMERA = np.array([[FOCAL_PX, 0.0, (WIDTH - 1) / 2], [0.0, FOCAL_PX, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]])
SAMPLES = 6
"""Along each side of a pixel: its grey level is the mean of 36, which places an edge to a hundredth of a pixel."""
SIZE_M = 0.08
CLUTTER = 60
"""Grey rectangles on the wall behind the markers."""
SHADE, STRIPE_PX = 0.35, 80
"""Part of the light that is left in shadows, which fall in upright stripes of this width."""
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@dataclass(frozen=True)
class Print:
    """A marker on paper: grey levels of ink and paper, and how many cells of paper are left around the black square."""

    family: str
    id: int
    ink: float
    paper: float
    quiet_cells: float

    @cached_property
    def levels(self) -> Array:
        """Grey levels (across, across) of the cells with the black border."""
        return np.asarray(np.where(family(self.family).patterns[self.id], self.paper, self.ink))


@dataclass(frozen=True)
class Placed:
    """A print whose black square has the side `SIZE_M`, at `camera_from_square` (4, 4): x right, y down, z inwards."""

    printed: Print
    camera_from_square: Array

    @property
    def corners_px(self) -> Array:
        """True corners (4, 2), clockwise from the marker's own top left; pixel centres are at whole numbers."""
        return self._projected(SIZE_M / 2 * SQUARE)

    @property
    def distance_m(self) -> float:
        """From the camera to the marker's centre."""
        return float(np.linalg.norm(self.camera_from_square[:3, 3]))

    def draw(self, canvas: Array) -> None:
        """Draw on grey levels (height, width)."""
        levels, quiet = self.printed.levels, self.printed.quiet_cells
        across = len(levels)
        outline_px = self._projected(SIZE_M * (0.5 + quiet / across) * SQUARE)
        left, top = np.maximum(np.floor(outline_px.min(axis=0)).astype(int), 0)
        right, bottom = np.ceil(outline_px.max(axis=0)).astype(int) + 1
        under = canvas[top:bottom, left:right]
        column, row = across * (self._on_plane(left, top, under.shape) / SIZE_M + 0.5)
        inside = (np.minimum(column, row) > -quiet) & (np.maximum(column, row) < across + quiet)
        sheet = np.pad(levels, 1, constant_values=self.printed.paper)
        at_row, at_column = (np.clip(np.floor(cell).astype(int) + 1, 0, across + 1) for cell in (row, column))
        light, covered = _means(np.where(inside, sheet[at_row, at_column], 0.0)), _means(inside)
        under[:] = light + (1 - covered) * under

    @cached_property
    def _image_from_plane(self) -> Array:
        """Homography (3, 3) from x and y on the marker, in m, to pixels."""
        return np.asarray(CAMERA @ self.camera_from_square[:3][:, [0, 1, 3]])

    def _projected(self, points_m: Array) -> Array:
        mapped = np.column_stack([points_m, np.ones(len(points_m))]) @ self._image_from_plane.T
        return np.asarray(mapped[:, :2] / mapped[:, 2:])

    def _on_plane(self, left: int, top: int, shape: tuple[int, ...]) -> Array:
        """Where the samples of a window of pixels lie on the marker's plane: x and y in m, (2, rows, columns)."""
        y, x = (
            start - 0.5 + (np.arange(n * SAMPLES) + 0.5) / SAMPLES for start, n in zip((top, left), shape, strict=True)
        )
        plane_from_image = np.linalg.inv(self._image_from_plane)
        mapped = [by_x * x + (by_y * y + by_1)[:, None] for by_x, by_y, by_1 in plane_from_image]
        return np.stack(mapped[:2]) / mapped[2]


def placed(
    printed: Print,
    centre_px: Sequence[float] | Array,
    side_px: float,
    steep_rad: float,
    turn_rad: float,
    axis_rad: float,
) -> Placed:
    """Place a marker whose side would be `side_px` if it faced the camera.

    Its normal is `steep_rad` from its line of sight; it is turned in its plane by `turn_rad`, and tilted about the
    direction `axis_rad` in the image.
    """
    ray = np.linalg.solve(CAMERA, [*centre_px, 1.0])
    ray /= np.linalg.norm(ray)
    sideways = np.cross([0.0, 0.0, 1.0], ray)
    towards = sideways / max(np.linalg.norm(sideways), 1e-12) * np.arccos(ray[2])
    tilt = steep_rad * np.array([np.cos(axis_rad), np.sin(axis_rad), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(towards)[0] @ cv2.Rodrigues(tilt)[0] @ cv2.Rodrigues(np.array([0.0, 0.0, turn_rad]))[0]
    pose[:3, 3] = FOCAL_PX * SIZE_M / side_px * ray
    return Placed(printed, pose)


def photograph(
    markers: Sequence[Placed], blur_px: float, noise: float, wall: float, shaded: bool, seed: int, number: int = 0
) -> Pixels:
    """Draw markers before a wall with the clutter of a seed, blurred, with normal noise of each image's own number."""
    canvas, chance = np.full((HEIGHT, WIDTH), wall), np.random.default_rng(seed)
    for _ in range(CLUTTER):
        x, y, width, height = chance.integers((0, 0, 8, 8), (WIDTH, HEIGHT, 90, 90))
        canvas[y : y + height, x : x + width] = chance.integers(40, 220)
    for marker in markers:
        marker.draw(canvas)
    if shaded:
        canvas[:, np.arange(WIDTH) // STRIPE_PX % 2 == 1] *= SHADE
    grain = np.random.default_rng((seed, number)).normal(0.0, noise, canvas.shape)
    return np.clip(np.round(cv2.GaussianBlur(canvas, (0, 0), blur_px) + grain), 0, 255).astype(np.uint8)


def _means(samples: NDArray[np.generic]) -> Array:
    rows, columns = (length // SAMPLES for length in samples.shape)
    return np.asarray(samples.reshape(rows, SAMPLES, columns, SAMPLES).mean(axis=(1, 3)))
