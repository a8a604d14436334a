"""Draws the actor's body from joints: trunk, head, limbs and hands."""

from collections.abc import Callable, Iterator

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX
from scene_simulator.actor import FINGER, Actor
from scene_simulator.drawing_primitives import (
    Canvas,
    Colour,
    Pinhole,
    blob,
    ellipse_px,
    hull,
    limb,
    line,
    polygon,
    shade,
)
from scene_simulator.simulated_scene import SceneState

Stroke = tuple[float, Callable[[Canvas], None]]
"""The depth of a part (m), and the function that draws it: far parts are drawn first."""

# Colours (BGR), chosen by a person's seed.
SHIRTS: tuple[Colour, ...] = ((160, 120, 70), (90, 140, 90), (120, 80, 130), (70, 110, 170), (140, 140, 80))
SKINS: tuple[Colour, ...] = ((165, 195, 232), (130, 165, 208), (90, 125, 175), (70, 95, 140))
HAIRS: tuple[Colour, ...] = ((35, 45, 60), (45, 75, 115), (70, 130, 175), (60, 60, 60))
TROUSERS: Colour = (92, 78, 70)
USUAL_HEIGHT_M = 1.70
"""Stature to which the limbs' radii refer; for other statures they are scaled."""
FINGER_SIDES_M = (-0.027, -0.009, 0.009, 0.027)
"""Positions of the four fingers across the palm."""
FINGER_RADII_M = (0.011, 0.009)
"""Radii of a finger at the knuckle and at the tip."""
SLEEVE = 0.35
"""Share of the forearm that the shirt covers."""


class Figure:
    """Draws one actor, in colours from the actor's seed."""

    def __init__(self, actor: Actor) -> None:
        rng = np.random.default_rng(actor.appearance_seed)
        self._actor = actor
        self._size = actor.height_m / USUAL_HEIGHT_M
        self._shirt, self._skin, self._hair = (tones[rng.integers(len(tones))] for tones in (SHIRTS, SKINS, HAIRS))

    def draw_below(self, canvas: Canvas, camera: Pinhole, joints_m: Array) -> None:
        """Draw the parts behind and below the table, legs and hips, from joints (15, 3; m)."""
        for side in ("left", "right"):
            hip, knee, foot = (joints_m[INDEX[f"{side}_{part}"]] for part in ("hip", "knee", "foot"))
            limb(canvas, camera, np.stack([knee, foot]), self._radii(0.06, 0.045), TROUSERS)
            limb(canvas, camera, np.stack([hip, knee]), self._radii(0.09, 0.065), TROUSERS)
        hips = joints_m[[INDEX[name] for name in ("torso", "left_hip", "right_hip")]]
        hull(canvas, blob(camera, hips, self._sized(0.14, 0.085, 0.085)), shade(self._shirt, 0.92))

    def strokes(self, camera: Pinhole, state: SceneState) -> Iterator[Stroke]:
        """Yield the drawing of each part above the table."""
        joints = state.joints_m
        trunk = joints[[INDEX["neck"], INDEX["torso"]]]
        yield trunk[:, 2].max() + 0.1, lambda canvas: self._draw_trunk(canvas, camera, joints)
        yield trunk[:, 2].max() + 0.05, lambda canvas: self._draw_head(canvas, camera, joints)
        for side in ("left", "right"):
            yield from self._arm_strokes(camera, state, side)

    def draw_fingers(self, canvas: Canvas, camera: Pinhole, state: SceneState, over_m: tuple[Array, Array]) -> None:
        """Draw the acting hand's fingers around the held object: from the palm over the object's edge to the tips.

        `over_m` is the middle (3,) of the held face's upper edge, and the vector (3,) by which the fingers go below it.
        """
        palm = state.joints_m[INDEX[f"{self._actor.hand}_hand"]]
        edge, down = over_m
        for side in FINGER_SIDES_M:
            knuckle = palm + np.array([side, 0.0, -0.02])
            bend = np.array([palm[0] + side * 1.1, edge[1] - 0.008, edge[2] - 0.012])
            bend = knuckle + state.grip * (bend - knuckle) + (1 - state.grip) * np.array([0, -0.02, -0.03])
            for ends in ((knuckle, bend), (bend, bend + state.grip * down)):
                limb(canvas, camera, np.stack(ends), FINGER_RADII_M, self._skin)

    def _arm_strokes(self, camera: Pinhole, state: SceneState, side: str) -> Iterator[Stroke]:
        shoulder, elbow, hand = (state.joints_m[INDEX[f"{side}_{part}"]] for part in ("shoulder", "elbow", "hand"))
        wrist = elbow + 0.8 * (hand - elbow)
        cuff = elbow + SLEEVE * (wrist - elbow)
        upper, sleeve, fore = np.stack([shoulder, elbow]), np.stack([elbow, cuff]), np.stack([elbow, wrist])

        def draw_upper(canvas: Canvas) -> None:
            limb(canvas, camera, upper, self._radii(0.060, 0.048), self._shirt)

        def draw_fore(canvas: Canvas) -> None:
            limb(canvas, camera, fore, self._radii(0.040, 0.029), self._skin)
            limb(canvas, camera, sleeve, self._radii(0.048, 0.044), self._shirt)

        yield float(upper[:, 2].mean()), draw_upper
        yield float(fore[:, 2].mean()), draw_fore
        yield float(hand[2]), lambda canvas: self._draw_hand(canvas, camera, state, side, hand - elbow)

    def _draw_hand(self, canvas: Canvas, camera: Pinhole, state: SceneState, side: str, fore: Array) -> None:
        acting = side == self._actor.hand
        hand = state.joints_m[INDEX[f"{side}_hand"]]
        along = fore / np.linalg.norm(fore)
        open_hand = 1 - max(state.grip, state.pointing) if acting else 1.0
        across = np.array([along[2], 0.0, -along[0]])
        for offset in FINGER_SIDES_M:
            start = hand + offset * across
            tip = start + (0.02 + 0.8 * open_hand * FINGER * self._actor.height_m) * along
            limb(canvas, camera, np.stack([start, tip]), FINGER_RADII_M, self._skin)
        limb(canvas, camera, np.stack([hand - 0.03 * along, hand + 0.015 * along]), (0.030, 0.040), self._skin)
        if acting and state.pointing > 0:
            tip = hand + state.pointing * (state.fingertip_m - hand)
            limb(canvas, camera, np.stack([hand, tip]), FINGER_RADII_M, self._skin)

    def _draw_trunk(self, canvas: Canvas, camera: Pinhole, joints: Array) -> None:
        spine, across = joints[INDEX["torso"]], joints[INDEX["left_hip"]] - joints[INDEX["right_hip"]]
        waist = spine + np.array([[0.5], [-0.5]]) * across
        corners = np.concatenate([joints[[INDEX["left_shoulder"], INDEX["right_shoulder"]]], waist])
        for factor, scale in ((0.72, 1.0), (1.0, 0.93)):
            radii = self._sized(*(scale * np.array([0.062, 0.062, 0.085, 0.085])))
            hull(canvas, blob(camera, corners, radii), shade(self._shirt, factor))
        neck, head = joints[INDEX["neck"]], joints[INDEX["head"]]
        collar = np.stack([neck + np.array([0, 0.0, -0.03]), neck])
        limb(canvas, camera, collar, self._radii(0.062, 0.055), shade(self._skin, 0.88))
        limb(canvas, camera, np.stack([neck, head]), self._radii(0.048, 0.05), shade(self._skin, 0.88))

    def _draw_head(self, canvas: Canvas, camera: Pinhole, joints: Array) -> None:
        head = joints[INDEX["head"]]
        centre = camera.project(head)
        unit = camera.pixels(0.078 * self._size, float(head[2]))
        turn = float(joints[INDEX["left_hip"]][2] - joints[INDEX["right_hip"]][2]) * -4
        down = np.array([0.0, unit])
        polygon(canvas, ellipse_px(centre - 0.16 * down, 1.10 * unit, 1.28), self._hair)
        polygon(canvas, ellipse_px(centre + 0.10 * down, unit, 1.26), shade(self._skin, 0.75))
        polygon(canvas, ellipse_px(centre + 0.08 * down, 0.93 * unit, 1.26), self._skin)
        polygon(canvas, ellipse_px(centre - 0.68 * down, 0.98 * unit, 0.56), self._hair)
        centre_px = centre + unit * np.array([turn, 0.0])
        for side in (-1, 1):
            eye_px = centre_px + unit * np.array([side * 0.36, 0.08])
            polygon(canvas, ellipse_px(eye_px, 0.15 * unit, 0.8), (240, 240, 240))
            polygon(canvas, ellipse_px(eye_px, 0.09 * unit), (50, 40, 40))
            brow = np.array([[-0.18, -0.24], [0.18, -0.24 - 0.04 * side]])
            line(canvas, eye_px + brow * unit, self._hair)
        line(canvas, centre_px + unit * np.array([[0.0, 0.15], [0.09, 0.46], [-0.05, 0.5]]), shade(self._skin, 0.7))
        smile = np.array([[-0.3, 0.76], [-0.12, 0.85], [0.12, 0.85], [0.3, 0.76]])
        line(canvas, centre_px + unit * smile, (90, 80, 160))

    def _radii(self, first_m: float, second_m: float) -> tuple[float, float]:
        return first_m * self._size, second_m * self._size

    def _sized(self, *radii_m: float) -> tuple[float, ...]:
        return tuple(radius * self._size for radius in radii_m)
