"""Renders the colour camera's image of the scene, far parts first."""

import cv2
import numpy as np

from actum.arrays import Array
from scene_simulator.background import draw_room, draw_table
from scene_simulator.drawing_primitives import Canvas, Pinhole
from scene_simulator.figure import Figure, Stroke
from scene_simulator.props import Prop
from scene_simulator.simulated_scene import Scene, SceneState

SLACK_PX = 64
"""Pixels by which the noise pattern is larger than the image: a random offset makes it differ from image to image."""
VISIBLE_RISER_M = 0.004
"""Least height of a riser that is drawn: between two repetitions risers grow from 0."""


class Renderer:
    """Renders the states of one scene; `rng` generates the sensor's noise."""

    def __init__(self, scene: Scene, rng: np.random.Generator) -> None:
        parameters = scene.parameters
        self.camera = Pinhole.of(parameters.camera)
        self._table_y_m = parameters.table_y_m
        self._items = scene.items
        self._props = [Prop(item, parameters.objects.marker_size_m) for item in scene.items]
        self._figure = Figure(scene.actor)
        self._room = draw_room(self.camera, parameters.camera.height_m)
        names = [item.name for item in scene.items]
        self._table, self._table_mask = draw_table(self.camera, parameters, names, scene.places_x_m)
        self._blur_sd_px, self._jpeg_quality = parameters.image.blur_sd_px, parameters.image.jpeg_quality
        self._rng = rng
        size = (self.camera.height + SLACK_PX, self.camera.width + SLACK_PX, 3)
        self._grain = np.round(rng.normal(0, parameters.image.grey_noise_sd, size)).astype(np.int16)

    def jpeg(self, state: SceneState) -> bytes:
        """Render one image as JPEG, with blur and noise."""
        done, data = cv2.imencode(".jpg", self.image(state), [cv2.IMWRITE_JPEG_QUALITY, self._jpeg_quality])
        assert done
        return data.tobytes()

    def image(self, state: SceneState) -> Canvas:
        """Render one image (height, width, 3; BGR) with blur and noise."""
        blurred = cv2.GaussianBlur(self.clean_image(state), (3, 3), self._blur_sd_px)
        x, y = self._rng.integers(SLACK_PX, size=2)
        grain = self._grain[y : y + self.camera.height, x : x + self.camera.width]
        return np.asarray(cv2.add(blurred, grain, dtype=cv2.CV_8U), dtype=np.uint8)

    def clean_image(self, state: SceneState) -> Canvas:
        """Render one image (height, width, 3; BGR) without blur and noise."""
        canvas = self._room.copy()
        self._figure.draw_below(canvas, self.camera, state.joints_m)
        cv2.copyTo(self._table, self._table_mask, canvas)
        for row, prop in enumerate(self._props):
            prop.draw_shadow(canvas, self.camera, state.positions_m[row], self._table_y_m)
        strokes = [*self._figure.strokes(self.camera, state), *self._prop_strokes(state)]
        for _, draw in sorted(strokes, key=lambda stroke: -stroke[0]):
            draw(canvas)
        return canvas

    def _prop_strokes(self, state: SceneState) -> list[Stroke]:
        strokes = [self._object_stroke(state, row) for row in range(len(self._props))]
        strokes += [
            self._riser_stroke(row, state.riser_tops_m[row])
            for row in range(len(self._props))
            if self._table_y_m - state.riser_tops_m[row, 1] > VISIBLE_RISER_M
        ]
        if state.grip > 0 and state.target is not None:  # the closed hand's fingers before the face that they hold
            position = state.positions_m[state.target]
            edge = position - (0.0, self._items[state.target].size_m[1] / 2, 0.0)
            down = np.array([0.0, max(state.finger_overlap_m, 0.0), 0.0])
            depth = float(position[2]) - 0.01
            strokes.append((depth, lambda canvas: self._figure.draw_fingers(canvas, self.camera, state, (edge, down))))
        return strokes

    def _object_stroke(self, state: SceneState, row: int) -> Stroke:
        pose, prop = state.camera_from_object(row), self._props[row]
        return float(state.positions_m[row, 2]), lambda canvas: prop.draw(canvas, self.camera, pose)

    def _riser_stroke(self, row: int, top_m: Array) -> Stroke:
        prop = self._props[row]
        return float(top_m[2]) + 0.005, lambda canvas: prop.draw_riser(canvas, self.camera, top_m, self._table_y_m)
