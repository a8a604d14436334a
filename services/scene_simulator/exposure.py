"""What a camera takes in while its shutter is open."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from scene_simulator.paint import Canvas
from scene_simulator.simulated_scene import SceneState

INSTANTS = 3
MOVING = ("joints_m", "fingertip_m", "positions_m", "yaw_rad", "riser_tops_m", "grip", "pointing")


def while_open(before: SceneState, state: SceneState, share: float) -> list[SceneState]:
    """Give instants of the last `share` (0 to 1) of the way from the frame before to a frame, which ends them."""
    if share == 0:
        return [state]
    return [_between(before, state, 1 - share * (1 - step)) for step in np.linspace(0, 1, INSTANTS)]


def averaged(images: Sequence[Canvas]) -> Canvas:
    """Return the mean of images."""
    if len(images) == 1:
        return images[0]
    total = np.zeros(images[0].shape, dtype=np.float32)
    for image in images:
        cv2.accumulate(image, total)
    return np.asarray(np.round(total / len(images)), dtype=np.uint8)


def _between(before: SceneState, state: SceneState, share: float) -> SceneState:
    values = {name: (1 - share) * getattr(before, name) + share * getattr(state, name) for name in MOVING}
    return replace(state, **values)
