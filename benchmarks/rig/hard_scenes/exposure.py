"""Motion blur: the mean of images drawn at several instants of an exposure."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from scene_simulator.drawing_primitives import Canvas
from scene_simulator.simulated_scene import SceneState

INSTANTS = 3
"""Instants of one exposure: enough for visible blur; each costs the drawing of an image."""
MOVING = ("joints_m", "fingertip_m", "positions_m", "yaw_rad", "riser_tops_m", "grip", "pointing")


@dataclass(frozen=True)
class ExposedState(SceneState):
    """The ground truth of one frame that knows the frame before it; None in the first frame."""

    before: SceneState | None = None


def states_while_open(before: SceneState, state: SceneState, share: float) -> list[SceneState]:
    """Interpolate states over the last `share` (0 to 1) of the interval between two frames; the last one is `state`."""
    if share == 0:
        return [state]
    return [_interpolated(before, state, 1 - share * (1 - step)) for step in np.linspace(0, 1, INSTANTS)]


def mean_image(images: Sequence[Canvas]) -> Canvas:
    """Return the mean of images (height, width, 3)."""
    if len(images) == 1:
        return images[0]
    total = np.zeros(images[0].shape, dtype=np.float32)
    for image in images:
        cv2.accumulate(image, total)
    return np.asarray(np.round(total / len(images)), dtype=np.uint8)


def _interpolated(before: SceneState, state: SceneState, share: float) -> SceneState:
    values = {name: (1 - share) * getattr(before, name) + share * getattr(state, name) for name in MOVING}
    return replace(state, **values)
