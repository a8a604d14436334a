"""Large markers that were cut out of their paper with hardly any white, on something dark."""

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np

from marker_tracker.detection.families import family as family_of

from .rendering import Pixels
from .rows import OURS, ROWS

FAMILY = "DICT_4X4_50"
SIDE_PX = 96
EDGES_PX = (3, 4, 5, 6, 7, 8, 12)
"""White left around the marker: a cell has 16 px."""
NUMBERS = range(10)
ANGLES_DEG = (0.0, 12.0, 25.0)
WIDTH, HEIGHT = 320, 240
DARK, PAPER = 30, 200
"""Grey levels of ink and wall, and of paper."""
SHOWN = ("OpenCV, no refinement", "OpenCV, APRILTAG", OURS, "no inner squares", "no second look")


def cut_outs() -> Iterator[str]:
    """Write how many are found, by the white left around them."""
    yield f"| of {len(NUMBERS) * len(ANGLES_DEG)} found | {' | '.join(f'{edge_px} px' for edge_px in EDGES_PX)} | all |"
    yield "|---" * (len(EDGES_PX) + 2) + "|"
    for name in SHOWN:
        counts = [
            sum(_is_found(name, number, edge_px, angle_deg) for number in NUMBERS for angle_deg in ANGLES_DEG)
            for edge_px in EDGES_PX
        ]
        yield f"| {name} | {' | '.join(map(str, counts))} | {sum(counts)} |"


def _is_found(name: str, number: int, edge_px: int, angle_deg: float) -> bool:
    with ROWS[name].running(FAMILY, [number]) as detect:
        found = detect(0, _drawn(number, edge_px, angle_deg))
    return [marker.id for marker in found] == [number] and abs(_side_px(found[0].corners_px) - SIDE_PX) < 1.5


def _side_px(corners_px: np.ndarray) -> float:
    return float(np.linalg.norm(corners_px - np.roll(corners_px, 1, axis=0), axis=1).mean())


def _drawn(number: int, edge_px: int, angle_deg: float) -> Pixels:
    printed = cv2.aruco.generateImageMarker(family_of(FAMILY).dictionary, number, SIDE_PX)
    paper = np.pad(np.where(printed > 0, PAPER, DARK).astype(np.uint8), edge_px, constant_values=PAPER)
    turned: Any = cv2.getRotationMatrix2D((len(paper) / 2, len(paper) / 2), angle_deg, 1.0)
    turned[:, 2] += np.array([WIDTH - len(paper), HEIGHT - len(paper)]) / 2
    drawn: Any = cv2.warpAffine(paper, turned, (WIDTH, HEIGHT), borderMode=cv2.BORDER_CONSTANT, borderValue=DARK)
    return np.asarray(drawn, np.uint8)
