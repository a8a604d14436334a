"""Objects whose marker cannot be read, because its card reflects a light."""

import numpy as np

from actum.arrays import Array
from scene_simulator.drawing_primitives import Canvas, Colour, Pinhole, polygon
from scene_simulator.parameters import ObjectItem
from scene_simulator.props import MarkerCard, Prop

GLARE: Colour = (250, 250, 250)
"""Colour of a card that reflects a light, as bright as its white."""


class GlaringCard(MarkerCard):
    """A marker card with glare that hides its marker."""

    @property
    def reach_m(self) -> float:
        """The distance (m) from the middle to a corner."""
        return float(np.linalg.norm(self._corners_m[0]))

    def draw(self, canvas: Canvas, camera: Pinhole, camera_from_object: Array) -> None:
        """Draw the card at a pose (4, 4) in one colour."""
        polygon(canvas, self._corners_px(camera, camera_from_object), GLARE)


class GlaringProp(Prop):
    """Draws one object with glare on its marker card."""

    def __init__(self, item: ObjectItem, marker_size_m: float) -> None:
        super().__init__(item, marker_size_m)
        self._card: GlaringCard = GlaringCard(item.id, marker_size_m)

    @property
    def card_reach_m(self) -> float:
        """The distance (m) from the card's middle to its corners."""
        return self._card.reach_m
