"""Draws the fifteen joints of everybody into the picture in which they were found."""

from collections.abc import Sequence

import cv2
import numpy as np

from actum.arrays import Array, Pixels
from actum.messages import Agent
from actum.skeletons import INDEX
from actum.standard_body import BONES
from sensor_gateway.lens import Lens

Colour = tuple[int, int, int]

LEFT: Colour = (255, 144, 30)  # BGR: blue
RIGHT: Colour = (60, 90, 255)  # red
MIDDLE: Colour = (240, 240, 240)
WHITE: Colour = (255, 255, 255)
BLACK: Colour = (0, 0, 0)
NAMED = ("head", "left_hand", "right_hand", "left_foot", "right_foot")
TEXT_SCALE = 0.45
"""Of OpenCV's font: letters of some ten pixels."""
SUBPIXEL_BITS = 4
"""OpenCV draws at sixteenths of a pixel."""


def drawn(image_bgr: Pixels, agents: Sequence[Agent], lens: Lens, caption: str) -> Pixels:
    """Return a picture (height, width, 3) with everybody's joints: left blue, right red, hands and feet named."""
    canvas = np.ascontiguousarray(image_bgr).copy()
    for agent in agents:
        _draw_agent(canvas, agent, lens)
    _write(canvas, caption, (8, canvas.shape[0] - 10), WHITE)
    return canvas


def sheet(pictures: Sequence[Pixels], columns: int) -> Pixels:
    """Return one picture of equally large pictures (height, width, 3) in rows; the rest of the last row is black."""
    height, width = pictures[0].shape[:2]
    rows = -(-len(pictures) // columns)
    canvas = np.zeros((rows * height, min(columns, len(pictures)) * width, 3), np.uint8)
    for i, picture in enumerate(pictures):
        top, left = i // columns * height, i % columns * width
        canvas[top : top + height, left : left + width] = picture
    return canvas


def _draw_agent(canvas: Pixels, agent: Agent, lens: Lens) -> None:
    points = {i: _pixel(np.array(joint), lens) for i, joint in enumerate(agent.joints) if joint is not None}
    for parent, child, _ in BONES:
        if parent in points and child in points:
            cv2.line(canvas, points[parent], points[child], side_colour(child), 2, cv2.LINE_AA, SUBPIXEL_BITS)
    for i, point in points.items():
        cv2.circle(canvas, point, 4 << SUBPIXEL_BITS, side_colour(i), -1, cv2.LINE_AA, SUBPIXEL_BITS)
    for name in NAMED:
        if INDEX[name] in points:
            x, y = points[INDEX[name]]
            text = f"agent {agent.agent}" if name == "head" else name.replace("_", " ")
            _write(canvas, text, ((x >> SUBPIXEL_BITS) + 6, (y >> SUBPIXEL_BITS) - 6), side_colour(INDEX[name]))


def _pixel(joint_m: Array, lens: Lens) -> tuple[int, int]:
    """Project a joint (3,) into the picture, in sixteenths of a pixel."""
    zero = np.zeros(3)  # the joint is in the camera frame: no rotation, no translation
    [[[x, y]]] = cv2.projectPoints(joint_m.reshape(1, 1, 3), zero, zero, lens.matrix, lens.distortion)[0]
    return round(x * (1 << SUBPIXEL_BITS)), round(y * (1 << SUBPIXEL_BITS))


def side_colour(joint: int) -> Colour:
    """Return the colour of a joint, by its index: left blue, right red, the trunk white."""
    if INDEX["left_shoulder"] <= joint <= INDEX["left_hand"] or INDEX["left_hip"] <= joint <= INDEX["left_foot"]:
        return LEFT
    return MIDDLE if joint <= INDEX["torso"] else RIGHT


def _write(canvas: Pixels, text: str, place: tuple[int, int], colour: Colour) -> None:
    shade = place[0] + 1, place[1] + 1
    for ink, at in ((BLACK, shade), (colour, place)):
        cv2.putText(canvas, text, at, cv2.FONT_HERSHEY_SIMPLEX, TEXT_SCALE, ink, 1, cv2.LINE_AA)
