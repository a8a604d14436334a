"""The objects on the table, each with its marker card on the face towards the camera."""

import cv2
import numpy as np

from actum.arrays import Array
from scene_simulator.drawing_primitives import Canvas, Colour, Pinhole, hull, line, polygon, shade
from scene_simulator.parameters import ObjectItem

DICTIONARY = cv2.aruco.DICT_4X4_50
"""The marker tracker's default dictionary; an object's id is that of its marker."""
MARKER_CELLS = 6
"""Cells along each side of a marker, with its black border."""
QUIET_CELLS = 1
"""Width in cells of the white margin around a marker, which detectors need."""
CELL_PX = 8
"""Side of a cell in the card's texture: larger than in any image."""
OVERSAMPLING = 3
"""Texture samples along each side of a pixel, which are averaged to make edges as soft as a lens does."""
FACES = (
    ((0, 1, 5, 4), 1.18),  # top
    ((1, 3, 7, 5), 0.78),  # right
    ((2, 0, 4, 6), 0.86),  # left
    ((0, 1, 3, 2), 1.0),  # front
)
"""Corners of a cuboid's visible faces, and the brightness of each face."""
RISER_COLOUR: Colour = (150, 160, 170)
"""Colour of risers, unlike the table's and the objects'."""
TURN = np.linspace(0, 2 * np.pi, 32, endpoint=False)
"""Angles (32,; rad) at which round outlines are sampled."""


class MarkerCard:
    """A white card with an ArUco marker of a given size, centred on the marked face."""

    def __init__(self, marker_id: int, marker_size_m: float) -> None:
        dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
        marker = cv2.aruco.generateImageMarker(dictionary, marker_id, MARKER_CELLS * CELL_PX, borderBits=1)
        printed = np.pad(np.asarray(marker), QUIET_CELLS * CELL_PX, constant_values=255)
        self._texture = np.stack([np.clip(printed, 25, 235), np.full_like(printed, 255)], axis=-1)
        half = marker_size_m * (0.5 + QUIET_CELLS / MARKER_CELLS)
        self._corners_m = np.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])

    def draw(self, canvas: Canvas, camera: Pinhole, camera_from_object: Array) -> None:
        """Draw the card through the homography of its face at a pose (4, 4), oversampled and averaged."""
        corners = self._corners_px(camera, camera_from_object)
        low = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 1, 0)
        high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 2, (camera.width, camera.height))
        width, height = (high - low).tolist()
        if width <= 0 or height <= 0:
            return
        side = len(self._texture) - 0.5
        flat = np.array([[-0.5, -0.5], [side, -0.5], [side, side], [-0.5, side]], dtype=np.float32)
        homography = cv2.getPerspectiveTransform(flat, ((corners - low + 0.5) * OVERSAMPLING - 0.5).astype(np.float32))
        fine = (width * OVERSAMPLING, height * OVERSAMPLING)
        printed = cv2.warpPerspective(self._texture, homography, fine).astype(np.float32)
        brightness, coverage = cv2.split(cv2.resize(printed, (width, height), interpolation=cv2.INTER_AREA))
        card, cover = np.asarray(brightness, dtype=float)[..., None], np.asarray(coverage, dtype=float)[..., None] / 255
        patch = canvas[low[1] : high[1], low[0] : high[0]]
        patch[:] = np.round(card + (1 - cover) * patch)

    def _corners_px(self, camera: Pinhole, camera_from_object: Array) -> Array:
        """Return the card's corners (4, 2) in the image, at a pose (4, 4)."""
        return camera.project(_transformed(camera_from_object, self._corners_m))


class Prop:
    """Draws one object: its body, its marker card, and the shadow and riser under it."""

    def __init__(self, item: ObjectItem, marker_size_m: float) -> None:
        self._item = item
        self._card = MarkerCard(item.id, marker_size_m)
        self._draw_body = {"cuboid": self._draw_cuboid, "cup": self._draw_cup}[item.shape]

    def draw(self, canvas: Canvas, camera: Pinhole, camera_from_object: Array) -> None:
        """Draw body and card at a pose (4, 4)."""
        self._draw_body(canvas, camera, camera_from_object)
        self._card.draw(canvas, camera, camera_from_object)

    def draw_shadow(self, canvas: Canvas, camera: Pinhole, position_m: Array, ground_y_m: float) -> None:
        """Darken the ground under the object at `position_m` (3,); the higher it hangs, the smaller the shadow."""
        width, height, depth = self._item.size_m
        lift = max(ground_y_m - position_m[1] - height / 2, 0.0)
        radius = 0.62 * max(1 - 2.0 * lift, 0.4)
        ring = np.stack([radius * width * np.cos(TURN), 0 * TURN, radius * (depth + 0.03) * np.sin(TURN)], axis=-1)
        centre = np.array([position_m[0], ground_y_m, position_m[2] + depth / 2])
        _darken(canvas, camera.project(centre + ring))

    def draw_riser(self, canvas: Canvas, camera: Pinhole, top_m: Array, table_y_m: float) -> None:
        """Draw the riser under the object; `top_m` (3,) is the point of its top below the marked face's middle."""
        width, _, depth = self._item.size_m
        upright = np.eye(4)
        upright[1, 1] = upright[2, 2] = -1
        upright[:3, 3] = top_m[0], (top_m[1] + table_y_m) / 2, top_m[2] + 0.004
        _cuboid(canvas, camera, upright, (width, table_y_m - top_m[1], depth), RISER_COLOUR)

    def _draw_cuboid(self, canvas: Canvas, camera: Pinhole, camera_from_object: Array) -> None:
        _cuboid(canvas, camera, camera_from_object, self._item.size_m, self._item.bgr)

    def _draw_cup(self, canvas: Canvas, camera: Pinhole, camera_from_object: Array) -> None:
        width, height, depth = self._item.size_m
        colour = self._item.bgr
        turn = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 10)
        handle = np.stack([width * (0.5 + 0.26 * np.cos(turn)), 0.3 * height * np.sin(turn), 0 * turn - depth / 2], -1)
        bend = camera.project(_transformed(camera_from_object, handle))
        stroke = max(round(camera.pixels(0.016, camera_from_object[2, 3])), 2)
        line(canvas, bend, shade(colour, 0.6), stroke + 2)
        line(canvas, bend, shade(colour, 0.9), stroke)
        rim, base = (_ring(self._item, y, scale) for y, scale in ((height / 2, 1.0), (-height / 2, 0.9)))
        rim_px, base_px = (camera.project(_transformed(camera_from_object, ring)) for ring in (rim, base))
        hull(canvas, np.concatenate([rim_px, base_px]), shade(colour, 0.72))
        middle = base_px.mean(axis=0)
        hull(canvas, np.concatenate([rim_px, base_px]) * 0.94 + 0.06 * middle, colour)
        polygon(canvas, rim_px, shade(colour, 1.2))
        polygon(canvas, rim_px.mean(axis=0) + 0.86 * (rim_px - rim_px.mean(axis=0)), shade(colour, 0.45))


def _ring(item: ObjectItem, y: float, scale: float) -> Array:
    """Return a horizontal ring (32, 3) of a round object in its own frame."""
    width, _, depth = item.size_m
    x, z = scale * width / 2 * np.cos(TURN), scale * depth / 2 * np.sin(TURN) - depth / 2
    return np.stack([x, np.full_like(TURN, y), z], axis=-1)


def _cuboid(
    canvas: Canvas, camera: Pinhole, camera_from_object: Array, size_m: tuple[float, float, float], colour: Colour
) -> None:
    """Draw the visible faces of a block whose marked face is centred at the object's origin."""
    width, height, depth = size_m
    signs = [(x, y, z) for z in (0, -1) for y in (1, -1) for x in (-1, 1)]
    corners = _transformed(camera_from_object, np.array(signs) * (width / 2, height / 2, depth))
    pixels = camera.project(corners)
    for face, factor in FACES:
        outline = pixels[list(face)]
        normal = np.cross(corners[face[1]] - corners[face[0]], corners[face[2]] - corners[face[1]])
        centre = corners[list(face)].mean(axis=0)
        outward = normal * np.sign(normal @ (centre - corners.mean(axis=0)))
        if outward @ centre < 0:
            polygon(canvas, outline, shade(colour, factor))
            line(canvas, np.vstack([outline, outline[:1]]), shade(colour, 0.7 * factor))


def _darken(canvas: Canvas, outline_px: Array) -> None:
    """Draw a translucent shadow inside an outline (n, 2; px)."""
    low = np.maximum(np.floor(outline_px.min(axis=0)).astype(int) - 1, 0)
    high = np.ceil(outline_px.max(axis=0)).astype(int) + 2
    patch = canvas[low[1] : high[1], low[0] : high[0]]
    if patch.size == 0:
        return
    dark = (patch * 0.72).astype(np.uint8)
    cover = np.zeros(patch.shape[:2], dtype=np.uint8)
    polygon(cover, outline_px - low, (255, 255, 255))
    cv2.copyTo(dark, cover, patch)


def _transformed(b_from_a: Array, points_m: Array) -> Array:
    """Transform points (n, 3) from frame a to frame b by `b_from_a` (4, 4)."""
    return np.asarray(points_m @ b_from_a[:3, :3].T + b_from_a[:3, 3])
