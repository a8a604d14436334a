"""A person of known geometry before a depth camera: capsules around the bones, cast ray by ray."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import rotation_to_ray
from sensor_gateway.people.pose_estimator import LANDMARKS, MEDIAPIPE_WEIGHTS

Array = NDArray[np.float64]
Points = dict[str, Array]

STANDING = {
    "left_ear": (0.075, -0.68, 0.0),
    "left_shoulder": (0.18, -0.46, 0.0),
    "left_elbow": (0.24, -0.20, 0.02),
    "left_wrist": (0.27, 0.04, -0.05),
    "left_pinky": (0.29, 0.11, -0.07),
    "left_index": (0.26, 0.12, -0.07),
    "left_hip": (0.09, 0.0, 0.0),
    "left_knee": (0.11, 0.40, -0.02),
    "left_ankle": (0.12, 0.78, 0.03),
    "left_foot_index": (0.14, 0.83, -0.12),
}
"""The left half of somebody who stands facing the camera: m from between the hips; x to the image's right, y down."""

RADII_M = {
    ("left_shoulder", "right_shoulder"): 0.065,
    ("left_shoulder", "left_elbow"): 0.048,
    ("left_elbow", "left_wrist"): 0.036,
    ("left_wrist", "left_index"): 0.022,
    ("left_wrist", "left_pinky"): 0.022,
    ("left_hip", "left_knee"): 0.065,
    ("left_knee", "left_ankle"): 0.052,
    ("left_ankle", "left_foot_index"): 0.04,
}
HEAD_M = 0.09
TRUNK_M = (0.165, 0.105)
CHEST = 0.7


@dataclass(frozen=True)
class Person:
    """All 33 landmarks in the camera frame (m), and how much thicker than the plain body this one is."""

    points: Points
    thicker: float = 1.0

    @property
    def all_m(self) -> Array:
        return np.array([self.points[name] for name in LANDMARKS])

    @property
    def joints_m(self) -> Array:
        return MEDIAPIPE_WEIGHTS @ self.all_m


def person(
    at_m: tuple[float, float, float] = (0.0, 0.1, 2.5),
    turn_deg: float = 0.0,
    size: float = 1.0,
    thicker: float = 1.0,
    **moved_m: tuple[float, float, float],
) -> Person:
    """Stand somebody there, some landmarks elsewhere than the plain pose has them (before turning and scaling)."""
    half: Points = {name: np.array(place) for name, place in STANDING.items()}
    points = half | {name.replace("left", "right"): place * (-1, 1, 1) for name, place in half.items()}
    points |= {name: np.array(place) for name, place in moved_m.items()}
    sine, cosine = np.sin(np.radians(turn_deg)), np.cos(np.radians(turn_deg))
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    placed = {name: size * turn @ place + np.array(at_m) for name, place in points.items()}
    return Person(placed | _without_bones(placed), thicker * size)


def _without_bones(points: Points) -> Points:
    """Put the landmarks that no bone needs where they roughly are."""
    head = (points["left_ear"] + points["right_ear"]) / 2
    face = dict.fromkeys(LANDMARKS[:7] + LANDMARKS[9:11], head)
    thumbs = {f"{side}_thumb": points[f"{side}_index"] for side in ("left", "right")}
    heels = {f"{side}_heel": points[f"{side}_ankle"] for side in ("left", "right")}
    return face | thumbs | heels


def landmarks_of(
    body: Person,
    lens: Lens,
    model_size: float = 1.0,
    wrong_m: Array | float = 0.0,
    hidden: tuple[str, ...] = (),
    off_px: Array | float = 0.0,
) -> Landmarks:
    """See a person as a pose model does: a body of the model's size, its relative distances wrong by so much."""
    camera_m = body.all_m
    sights = camera_m[:, :2] / camera_m[:, 2:]
    visibility = np.where(np.isin(LANDMARKS, hidden), 0.2, 0.99)
    centre = (body.points["left_hip"] + body.points["right_hip"]) / 2
    world_m = (camera_m - centre) @ rotation_to_ray(np.average(sights, axis=0, weights=visibility)) / model_size
    world_m[:, 2] += wrong_m
    image_px = sights @ lens.matrix[:2, :2].T + lens.matrix[:2, 2] + off_px
    return Landmarks(image_px, visibility, MEDIAPIPE_WEIGHTS, world_m)


def depth_of(body: Person | None, lens: Lens, width: int, height: int, wall_m: float = 4.0) -> NDArray[np.float32]:
    """Return what a perfect depth camera measures (height, width; m): the person before a wall."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    focal_px, centre_px = lens.matrix[[0, 1], [0, 1]], lens.matrix[:2, 2]
    rays = np.dstack([(x - centre_px[0]) / focal_px[0], (y - centre_px[1]) / focal_px[1], np.ones((height, width))])
    depth = np.full((height, width), wall_m, dtype=np.float64)
    for start, end, radius, squeeze in [] if body is None else _capsules(body):
        reach = slice(*_rows(start, end, radius, lens, height))
        hit = _hit(rays[reach] @ squeeze.T, squeeze @ start, squeeze @ end, radius)
        depth[reach] = np.fmin(depth[reach], hit)
    return depth.astype(np.float32)


def _rows(start: Array, end: Array, radius: float, lens: Lens, height: int) -> tuple[int, int]:
    """Return the rows in which a capsule may be seen."""
    nearest = max(min(start[2], end[2]) - radius, 0.1)
    rows = [
        lens.matrix[1, 1] * (point[1] + sign * radius) / (nearest if sign * point[1] > 0 else point[2])
        for point in (start, end)
        for sign in (-1, 1)
    ]
    low, high = lens.matrix[1, 2] + min(rows) - 2, lens.matrix[1, 2] + max(rows) + 3
    return max(int(low), 0), min(max(int(high), 0), height)


def _capsules(body: Person) -> Iterator[tuple[Array, Array, float, Array]]:
    """Yield start, end, radius, and the linear map that makes the solid a round capsule."""
    p, round_ = body.points, np.eye(3)
    for (start, end), radius in RADII_M.items():
        yield p[start], p[end], radius * body.thicker, round_
        if start != "left_shoulder" or end != "right_shoulder":
            mirrored = start.replace("left", "right"), end.replace("left", "right")
            yield p[mirrored[0]], p[mirrored[1]], radius * body.thicker, round_
    head = (p["left_ear"] + p["right_ear"]) / 2
    yield head, head, HEAD_M * body.thicker, round_
    hips, neck = (p["left_hip"] + p["right_hip"]) / 2, (p["left_shoulder"] + p["right_shoulder"]) / 2
    across = p["left_shoulder"] - p["right_shoulder"]
    across = across / np.linalg.norm(across)
    squeeze = np.eye(3) - (1 - TRUNK_M[1] / TRUNK_M[0]) * np.outer(across, across)
    yield hips, hips + CHEST * (neck - hips), TRUNK_M[1] * body.thicker, squeeze


def _hit(rays: Array, start: Array, end: Array, radius: float) -> Array:
    """Return the parameter at which each ray from the origin first meets a capsule; NaN where it does not."""
    length = float(np.linalg.norm(end - start))
    hits = [_hit_ball(rays, start, radius)]
    if length > 0:
        axis = (end - start) / length
        hits += [_hit_ball(rays, end, radius), _hit_side(rays, start, axis, length, radius)]
    return np.fmin.reduce(hits)


def _hit_ball(rays: Array, centre: Array, radius: float) -> Array:
    return _first_root((rays**2).sum(axis=2), rays @ centre, float(centre @ centre) - radius**2)


def _hit_side(rays: Array, start: Array, axis: Array, length: float, radius: float) -> Array:
    across, start_across = rays - (rays @ axis)[..., None] * axis, start - (start @ axis) * axis
    hit = _first_root((across**2).sum(axis=2), across @ start_across, float(start_across @ start_across) - radius**2)
    along = hit * (rays @ axis) - start @ axis
    return np.where((along >= 0) & (along <= length), hit, np.nan)


def _first_root(square: Array, linear: Array, constant: float) -> Array:
    """Return the smaller t with square t² - 2 linear t + constant = 0; NaN where there is none."""
    discriminant = linear**2 - square * constant
    return (linear - np.sqrt(np.where(discriminant < 0, np.nan, discriminant))) / square
