"""A ChArUco board seen by a lens with distortion, rendered ray by ray from a pose that is known exactly."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from actum_calibrator.board import Board

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

SUPERSAMPLING = 3
TEXELS_PER_M = 4000
WHITE_EDGE_M = 0.0175
PAPER, WALL = 235, 120


@dataclass(frozen=True)
class Lens:
    """A camera: focal lengths and centre in px, OpenCV's distortion."""

    size: tuple[int, int] = (640, 480)
    matrix: tuple[float, float, float, float] = (560.0, 557.0, 327.0, 236.0)
    distortion: tuple[float, ...] = (-0.21, 0.09, 0.0008, -0.0006, 0.0)

    @property
    def intrinsics(self) -> Array:
        fx, fy, cx, cy = self.matrix
        return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])

    @cached_property
    def rays(self) -> Array:
        """Directions with z = 1 of the finely sampled pixels: (3, n)."""
        width, height = self.size
        x, y = (np.arange(side * SUPERSAMPLING) / SUPERSAMPLING - 1 / 3 for side in (width, height))
        pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 1, 2)
        straight = cv2.undistortPoints(pixels, self.intrinsics, np.array(self.distortion)).reshape(-1, 2)
        return np.vstack([straight.T, np.ones(len(straight))]).astype(np.float32)


@cache
def print_of(board: Board) -> Pixels:
    """The printed sheet as grey levels, squares and the white paper around them."""
    squares = [round(side * TEXELS_PER_M) for side in (board.width_m, board.height_m)]
    drawn = np.asarray(board.opencv.generateImage(squares, marginSize=0))
    edge = round(WHITE_EDGE_M * TEXELS_PER_M)
    sheet = cv2.copyMakeBorder(drawn, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=255)
    return (20 + sheet * ((PAPER - 20) / 255)).astype(np.uint8)


def photograph(
    lens: Lens, board: Board, camera_from_board: Array, blur_px: float = 0.7, noise: float = 3.0, seed: int = 0
) -> Pixels:
    """Render the board before a grey wall."""
    ray_from_plane = camera_from_board[:3][:, [0, 1, 3]]
    x, y, scale = np.linalg.inv(ray_from_plane).astype(np.float32) @ lens.rays
    shape = (lens.size[1] * SUPERSAMPLING, lens.size[0] * SUPERSAMPLING)
    with np.errstate(divide="ignore", invalid="ignore"):
        texels = [((along / scale + WHITE_EDGE_M) * TEXELS_PER_M - 0.5).reshape(shape) for along in (x, y)]
    u, v = (np.where(np.isfinite(t), t, -1e4).clip(-1e4, 1e4).astype(np.float32) for t in texels)
    fine = cv2.remap(print_of(board), u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=WALL)
    image = cv2.resize(fine, lens.size, interpolation=cv2.INTER_AREA).astype(np.float64)
    if blur_px > 0:
        image = cv2.GaussianBlur(image, (0, 0), blur_px)
    image += np.random.default_rng(seed).normal(0, noise, image.shape)
    return image.round().clip(0, 255).astype(np.uint8)


def facing(board: Board, centre_m: Sequence[float], turn_deg: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
    """Place the board's middle, facing the camera and then turned about x, y and z of the camera: camera_from_board."""
    pose = np.eye(4)
    for axis, angle in enumerate(np.radians(turn_deg)):
        pose[:3, :3] = cv2.Rodrigues(np.eye(3)[axis] * angle)[0] @ pose[:3, :3]
    pose[:3, 3] = np.array(centre_m) - pose[:3, :3] @ (board.width_m / 2, board.height_m / 2, 0.0)
    return pose


TURNS = (
    (30, 0, 0), (-28, 8, 5), (0, 32, -8), (6, -30, 10), (25, 25, 0), (-22, 24, 90), (20, -26, 15), (-24, -22, -20),
)  # fmt: skip
PLACES = (
    (-0.11, -0.07), (0.11, -0.07), (-0.11, 0.07), (0.11, 0.07), (0.0, 0.0), (0.0, -0.08), (0.13, 0.0), (-0.13, 0.0),
)  # fmt: skip


def good_poses(board: Board, count: int = 12) -> list[Array]:
    """Tilted every way, all over the image, near and far."""
    poses = []
    for n in range(count):
        x, y = PLACES[n % len(PLACES)]
        distance_m = (0.42, 0.5, 0.6)[n % 3]
        poses.append(facing(board, (x * distance_m / 0.45, y * distance_m / 0.45, distance_m), TURNS[(n + n // 8) % 8]))
    return poses
