"""Background clutter: shapes, textures, edges, and false markers that no dictionary contains."""

from collections.abc import Callable

import cv2
import numpy as np

from actum.arrays import Array
from scene_simulator.drawing_primitives import Canvas, Colour, Pinhole
from scene_simulator.props import DICTIONARY

CELLS = 4
"""Cells along each side of the dictionary's markers."""
FEWEST_WRONG_CELLS = 3
"""Least number of cells in which a false marker differs from every marker: more than a detector corrects."""
SIZE_RANGE_M = (0.06, 0.22)
"""Range of the squares' sides: about those of the markers and the objects."""
TEXTURE_PX = 48
"""Side of a texture before it is drawn in perspective."""
UNIT_SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
"""Corners (4, 2) of a unit square around the origin."""


def draw_clutter(canvas: Canvas, camera: Pinhole, origin_m: Array, sides_m: Array, count: int, seed: int) -> None:
    """Scatter `count` squares of all textures over a rectangle with a corner `origin_m` (3,) and sides (2, 3; m)."""
    rng = np.random.default_rng(seed)
    along = sides_m / np.linalg.norm(sides_m, axis=1, keepdims=True)
    for number in range(count):
        texture = TEXTURES[number % len(TEXTURES)](rng)
        middle = origin_m + rng.random(2) @ sides_m
        corners = middle + rng.uniform(*SIZE_RANGE_M) * (_rotated_square(rng.uniform(0, 2 * np.pi)) @ along)
        _draw_texture(canvas, texture, camera.project(corners))


def _rotated_square(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(UNIT_SQUARE @ np.array([[cos, sin], [-sin, cos]]))


def _draw_texture(canvas: Canvas, texture: Canvas, corners_px: Array) -> None:
    side = TEXTURE_PX - 1
    flat = np.array([[0, 0], [side, 0], [side, side], [0, side]], dtype=np.float32)
    homography = cv2.getPerspectiveTransform(flat, corners_px.astype(np.float32))
    size = (canvas.shape[1], canvas.shape[0])
    cover = cv2.warpPerspective(np.full(texture.shape[:2], 255, np.uint8), homography, size)
    cv2.copyTo(cv2.warpPerspective(texture, homography, size, flags=cv2.INTER_AREA), cover, canvas)


def _colour(rng: np.random.Generator) -> Colour:
    blue, green, red = rng.integers(30, 226, 3).tolist()
    return blue, green, red


def _plain(rng: np.random.Generator) -> Canvas:
    texture = np.empty((TEXTURE_PX, TEXTURE_PX, 3), np.uint8)
    texture[:] = _colour(rng)
    return texture


def _framed(rng: np.random.Generator) -> Canvas:
    """Draw a bright picture in a black frame, with the outline of a marker."""
    texture = _plain(rng)
    cv2.rectangle(texture, (0, 0), (TEXTURE_PX - 1, TEXTURE_PX - 1), (235, 235, 235), 6)
    cv2.rectangle(texture, (6, 6), (TEXTURE_PX - 7, TEXTURE_PX - 7), (25, 25, 25), 6)
    return texture


def _noisy(rng: np.random.Generator) -> Canvas:
    coarse = rng.integers(0, 256, (12, 12, 3), dtype=np.uint8)
    return np.asarray(cv2.resize(coarse, (TEXTURE_PX, TEXTURE_PX), interpolation=cv2.INTER_CUBIC), dtype=np.uint8)


def _striped(rng: np.random.Generator) -> Canvas:
    texture, ink = _plain(rng), _colour(rng)
    for x in range(0, TEXTURE_PX, 8):
        cv2.rectangle(texture, (x, 0), (x + 3, TEXTURE_PX), ink, -1)
    return texture


def _checked(_: np.random.Generator) -> Canvas:
    cells = np.indices((6, 6)).sum(axis=0) % 2
    return _enlarged(np.where(cells, 235, 25))


def _false_marker(rng: np.random.Generator) -> Canvas:
    """Draw a black square with a code that differs from every marker's."""
    cells = np.full((CELLS + 4, CELLS + 4), 235)
    cells[1:-1, 1:-1] = 25
    cells[2:-2, 2:-2] = np.where(_false_code(rng), 235, 25)
    return _enlarged(cells)


def _false_code(rng: np.random.Generator) -> Canvas:
    dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    while True:
        code = rng.integers(0, 2, (CELLS, CELLS), dtype=np.uint8)
        wrong = [dictionary.getDistanceToId(code, marker) for marker in range(len(dictionary.bytesList))]
        if min(wrong) >= FEWEST_WRONG_CELLS:
            return code


def _enlarged(cells: Array) -> Canvas:
    grey = cv2.resize(cells.astype(np.uint8), (TEXTURE_PX, TEXTURE_PX), interpolation=cv2.INTER_NEAREST)
    return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), dtype=np.uint8)


TEXTURES: tuple[Callable[[np.random.Generator], Canvas], ...] = (
    _plain,
    _framed,
    _noisy,
    _false_marker,
    _striped,
    _checked,
)
