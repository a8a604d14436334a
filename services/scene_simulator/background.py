"""Draws the static background: the room, and the table with a name plate in front of each object."""

from collections.abc import Sequence

import cv2
import numpy as np

from actum.arrays import Array
from scene_simulator.drawing_primitives import Canvas, Colour, Pinhole, line, polygon, shade
from scene_simulator.parameters import Parameters

# Colours (BGR).
WALL: tuple[Colour, Colour] = ((226, 222, 214), (196, 194, 190))
FLOOR: Colour = (138, 150, 164)
WOOD: Colour = (108, 150, 190)
PLATE: Colour = (236, 240, 242)
INK: Colour = (60, 60, 60)
WALL_Z_M = 3.6
"""Depth of the wall, behind every place where the person may stand."""
LEG_SIDE_M = 0.05
"""Side of the table's square legs."""
PLANKS = 5
"""Number of planks of the table top; the seams between them are drawn."""


def draw_room(camera: Pinhole, camera_height_m: float) -> Canvas:
    """Draw wall, floor, a window and a picture: (height, width, 3)."""
    rows = np.linspace(0, 1, camera.height)[:, None, None]
    wall = (1 - rows) * np.array(WALL[0]) + rows * np.array(WALL[1])
    room = np.broadcast_to(wall, (camera.height, camera.width, 3)).astype(np.uint8).copy()
    horizon = camera.project(np.array([0.0, camera_height_m, WALL_Z_M]))[1]
    room[round(horizon) :] = FLOOR
    cv2.rectangle(room, (0, round(horizon) - 10), (camera.width, round(horizon)), shade(WALL[0], 1.08), -1)
    low, high = (camera.project(np.array(corner)) for corner in ((0.75, -1.05, WALL_Z_M), (1.75, -0.05, WALL_Z_M)))
    corner, opposite = (tuple(int(value) for value in point) for point in (low, high))
    cv2.rectangle(room, corner, opposite, (236, 222, 196), -1)
    cv2.rectangle(room, corner, opposite, (250, 250, 250), 5, cv2.LINE_AA)
    middle = (corner[0] + opposite[0]) // 2
    cv2.line(room, (middle, corner[1]), (middle, opposite[1]), (250, 250, 250), 4)
    frame = camera.project(np.array([[-1.75, -0.95, WALL_Z_M], [-0.85, -0.35, WALL_Z_M]]))
    (left, top), (right, bottom) = np.round(frame).astype(int).tolist()
    cv2.rectangle(room, (left, top), (right, bottom), (214, 196, 150), -1)
    hills = np.array([[left, bottom], [left + 40, top + 40], [left + 75, bottom - 22], [left + 100, top + 52]])
    cv2.fillPoly(room, [np.vstack([hills, [[right, bottom - 14], [right, bottom]]]).astype(np.int32)], (120, 150, 110))
    cv2.circle(room, (right - 28, top + 22), 10, (150, 215, 245), -1, cv2.LINE_AA)
    cv2.rectangle(room, (left, top), (right, bottom), (70, 90, 110), 4, cv2.LINE_AA)
    return room


def draw_table(
    camera: Pinhole, parameters: Parameters, names: Sequence[str], lanes_x_m: Array
) -> tuple[Canvas, Canvas]:
    """Draw the table by itself; return the picture (height, width, 3) and its mask (height, width).

    `lanes_x_m` (n,) are the x positions of the named objects.
    """
    picture = np.full((camera.height, camera.width, 3), shade(WOOD, 0.9), dtype=np.uint8)
    mask = np.zeros((camera.height, camera.width), dtype=np.uint8)
    table, y = parameters.table, parameters.table_y_m
    half, floor = table.width_m / 2, parameters.camera.height_m
    legs = [
        np.array([[x, y, z], [x + LEG_SIDE_M, y, z], [x + LEG_SIDE_M, floor, z], [x, floor, z]])
        for z in (table.far_z_m, table.near_z_m)
        for x in (-half, half - LEG_SIDE_M)
    ]
    top = np.array([[-half, y, table.far_z_m], [half, y, table.far_z_m], [half, y, table.near_z_m]])
    top = np.vstack([top, [[-half, y, table.near_z_m]]])
    apron = np.stack([top[3], top[2], top[2] + (0, table.thickness_m, 0), top[3] + (0, table.thickness_m, 0)])
    for corners, factor in (*((leg, 0.62) for leg in legs), (top, 1.08), (apron, 0.82)):
        polygon(picture, camera.project(corners), shade(WOOD, factor))
        polygon(mask, camera.project(corners), (255, 255, 255))
    for share in np.linspace(0, 1, PLANKS + 1)[1:-1]:
        seam = np.stack([top[0] + share * (top[3] - top[0]), top[1] + share * (top[2] - top[1])])
        line(picture, camera.project(seam), shade(WOOD, 0.98))
    for name, x in zip(names, lanes_x_m, strict=True):
        _draw_plate(picture, camera, name, np.array([x, y + table.thickness_m / 2, table.near_z_m]))
    return picture, mask


def _draw_plate(picture: Canvas, camera: Pinhole, name: str, centre_m: Array) -> None:
    """Write an object's name on the table's edge."""
    centre = camera.project(centre_m)
    half = np.array([24.0, 7.5])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    polygon(picture, centre + corners, PLATE)
    (width, height), _ = cv2.getTextSize(name, cv2.FONT_HERSHEY_SIMPLEX, 0.42, 1)
    at = (round(centre[0] - width / 2), round(centre[1] + height / 2) - 1)
    cv2.putText(picture, name, at, cv2.FONT_HERSHEY_SIMPLEX, 0.42, INK, 1, cv2.LINE_AA)
