"""Renders the scene under conditions: clutter, motion blur, defocus, glare, and a hand over the held marker."""

import cv2
import numpy as np

from actum.arrays import Array
from scene_simulator.background import WALL_Z_M
from scene_simulator.drawing_primitives import Canvas, Pinhole, limb
from scene_simulator.figure import FINGER_RADII_M, FINGER_SIDES_M, Figure, Stroke
from scene_simulator.random_streams import random_stream
from scene_simulator.render import Renderer
from scene_simulator.simulated_scene import CLOSED, SceneState

from .clutter import draw_clutter
from .exposure import ExposedState, mean_image, states_while_open
from .glare import GlaringProp
from .hard_scene import HardScene


class CoveringFigure(Figure):
    """Draws the hand of an actor over a marker."""

    def draw_palm_over(self, canvas: Canvas, camera: Pinhole, middle_m: Array, radius_m: float) -> None:
        """Draw the hand laid flat over an area around `middle_m` (3,), with its fingers side by side."""
        ends = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]) * radius_m
        limb(canvas, camera, middle_m + ends, (radius_m, radius_m), self._skin)
        for side in FINGER_SIDES_M:
            finger = np.array([[side, -0.5 * radius_m, 0.0], [side, 0.9 * radius_m, 0.0]])
            limb(canvas, camera, middle_m + finger, FINGER_RADII_M, self._skin)


class HardRenderer(Renderer):
    """Renders the states of one scene under its conditions; `rng` generates the sensor's noise."""

    def __init__(self, scene: HardScene, rng: np.random.Generator) -> None:
        super().__init__(scene, rng)
        self._seeds, self._conditions = scene.seeds, scene.conditions
        self._open_share = min(scene.conditions.exposure_s * scene.parameters.camera.frame_rate_hz, 1.0)
        self._glaring = [GlaringProp(item, scene.parameters.objects.marker_size_m) for item in scene.items]
        self._covering = CoveringFigure(scene.actor)
        if self._conditions.clutter:
            self._draw_clutter(scene)

    def clean_image(self, state: SceneState) -> Canvas:
        """Render one image (height, width, 3; BGR) without noise, with the blur of motion and of defocus."""
        before = state.before if isinstance(state, ExposedState) else None
        open_states = states_while_open(before or state, state, self._open_share)
        exposed = mean_image([super(HardRenderer, self).clean_image(each) for each in open_states])
        if not self._conditions.defocus_sd_px:
            return exposed
        return np.asarray(cv2.GaussianBlur(exposed, (0, 0), self._conditions.defocus_sd_px), dtype=np.uint8)

    def _prop_strokes(self, state: SceneState) -> list[Stroke]:
        strokes = super()._prop_strokes(state)
        if state.grip > CLOSED and state.target is not None and self._conditions.covers_marker:
            strokes.append(self._palm_stroke(state, state.target))
        return strokes

    def _object_stroke(self, state: SceneState, row: int) -> Stroke:
        """Return the drawing of an object, with glare on its card in a share `unread_share` of the images."""
        shares = random_stream("unread", *self._seeds, state.frame).random(len(self._glaring))
        if shares[row] >= self._conditions.unread_share:
            return super()._object_stroke(state, row)
        pose, prop = state.camera_from_object(row), self._glaring[row]
        return float(state.positions_m[row, 2]), lambda canvas: prop.draw(canvas, self.camera, pose)

    def _palm_stroke(self, state: SceneState, target: int) -> Stroke:
        """Return the drawing of the hand over the marker card of the held object."""
        middle, radius_m = state.positions_m[target] - (0.0, 0.0, 0.02), self._glaring[target].card_reach_m
        return float(middle[2]), lambda canvas: self._covering.draw_palm_over(canvas, self.camera, middle, radius_m)

    def _draw_clutter(self, scene: HardScene) -> None:
        """Scatter clutter over the wall and the table."""
        wall_seed, table_seed = random_stream("clutter", *self._seeds).integers(2**31, size=2).tolist()
        half, top = np.array([2.2, 1.6]), scene.parameters.table
        wall = np.array([[2 * half[0], 0.0, 0.0], [0.0, 2 * half[1], 0.0]])
        corner = np.array([-half[0], -half[1], WALL_Z_M])
        draw_clutter(self._room, self.camera, corner, wall, self._conditions.clutter, wall_seed)
        corner = np.array([-top.width_m / 2, self._table_y_m, top.near_z_m])
        sides = np.array([[top.width_m, 0.0, 0.0], [0.0, 0.0, top.far_z_m - top.near_z_m]])
        draw_clutter(self._table, self.camera, corner, sides, self._conditions.clutter, table_seed)
