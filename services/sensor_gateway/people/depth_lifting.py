"""Lifts a person's joints by measured depth: each joint lies half a limb's thickness behind the measured surface.

Depth images have holes, mixed values at edges, and objects in front of or beside a joint. So the body estimated from
the colour image is first scaled to the distance at which most of its joints agree with the surface. Each joint's own
surface is then searched for near the depth expected from that body. A joint without a surface keeps the expected
distance, with the correction of the next joint towards the torso.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES
from sensor_gateway.captured_picture import DepthImage
from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import Placed, placed, posed

HALF_THICKNESS_M: Mapping[str, float] = MappingProxyType(
    {
        "head": 0.085,
        "neck": 0.07,
        "torso": 0.11,
        "left_shoulder": 0.055,
        "left_elbow": 0.04,
        "left_hand": 0.02,
        "right_shoulder": 0.055,
        "right_elbow": 0.04,
        "right_hand": 0.02,
        "left_hip": 0.09,
        "left_knee": 0.06,
        "left_foot": 0.065,
        "right_hip": 0.09,
        "right_knee": 0.06,
        "right_foot": 0.065,
    }
)
"""Depth of each joint of the model's body behind the skin; for the torso, seen from the front."""

NARROW_M = 0.04
"""Half the width of an arm or a leg; along the ray feet are longer."""

HALF_WIDTH_M = 0.16
"""Depth of the torso joint behind the skin of a trunk seen from the side."""

TRUNK = ("neck", "torso", "left_shoulder", "right_shoulder", "left_hip", "right_hip")
MIDDLES = ("left_elbow", "right_elbow", "left_knee", "right_knee")
ENDS = ("left_hand", "right_hand", "left_foot", "right_foot")

REACH_M: Mapping[str, float] = MappingProxyType(
    {"head": 0.2, **dict.fromkeys(TRUNK, 0.12), **dict.fromkeys(MIDDLES, 0.2), **dict.fromkeys(ENDS, 0.3)}
)
"""Largest difference between a joint's measured and expected depth: a surface beyond belongs to something else."""

SIZE_RANGE = (0.5, 1.6)
"""Smallest and largest body size that a joint's surface may indicate, relative to the model's body."""

LEAST_VISIBLE = 0.5
"""Least confidence of a visible joint: below it, the surface belongs to another part or person."""

LEAST_JOINTS = 3
"""Fewest measured joints whose median gives the body's distance."""

LEAST_PIXELS = 5
"""Fewest pixels of a surface: fewer may be noise or the mixed values of an edge."""

LEAST_SHARE = 0.15
"""Least share of a window's pixels in a surface: even a limb that is narrower than its window covers more."""

NEAREST_QUANTILE = 0.1
"""Quantile of depths that gives a limb's nearest depth: nearer outliers are ignored."""

LIMB_DEPTH_M = 0.04
"""Range of depths behind the nearest one that belong to a limb's own surface: half its width."""

WINDOWS = (0.5, 1.0, 2.0)
"""Half sides of the windows that are tried in turn until one has enough surface, in half widths of the limb."""

UNMEASURED = 0.5
"""Factor on the confidence of a joint whose distance is not measured."""

_HALF_THICKNESS_M = np.array([HALF_THICKNESS_M[name] for name in JOINTS])
_RADIUS_M = np.where(np.isin(JOINTS, MIDDLES + ENDS), np.minimum(_HALF_THICKNESS_M, NARROW_M), _HALF_THICKNESS_M)
_IN_TRUNK = np.array([name in TRUNK for name in JOINTS])
_REACH_M = np.array([REACH_M[name] for name in JOINTS])


@dataclass(frozen=True)
class _Body:
    """The body estimated from the colour image alone.

    Attributes:
        joints_m: (15, 3), camera frame, for a body of the model's size.
        pixels: (15, 2), the joints in the image.
        confidence: (15,), in [0, 1].
        offset_m: (15,), depth of each joint behind its surface, along z.
        radius_px: (15,), radius around each joint's pixel of the surface that belongs to it.
    """

    joints_m: Array
    pixels: Array
    confidence: Array
    offset_m: Array
    radius_px: Array


def lifted(landmarks: Landmarks, lens: Lens, depth_m: DepthImage, person_height_m: float | None = None) -> Placed:
    """Place one person by depth (height, width; m, 0 where it is unknown) that is registered to the colour image.

    If too few joints have depth, the person is placed by the colour image alone.

    Raises:
        PlacingError: the landmarks fit no place in front of the camera.
    """
    body = _body(landmarks, lens)
    scale = _scale(body, depth_m)
    if scale is None:
        return placed(landmarks, lens, person_height_m)
    expected_m = scale * body.joints_m[:, 2]
    surface_m = scale * (body.joints_m[:, 2] - body.offset_m)
    measured_m = _surfaces(body, depth_m, surface_m - _REACH_M, surface_m + _REACH_M) + scale * body.offset_m
    distance_m = expected_m + _filled_along_limbs(measured_m - expected_m)
    confidence = body.confidence * np.where(np.isnan(measured_m), UNMEASURED, 1.0)
    return Placed(body.joints_m * (distance_m / body.joints_m[:, 2])[:, None], confidence, depth_std_m=None)


def _body(landmarks: Landmarks, lens: Lens) -> _Body:
    rays = lens.rays(landmarks.image_px)
    z_m = posed(landmarks, rays)[:, 2:]
    joints_m = landmarks.joints(z_m * np.column_stack([rays, np.ones(len(rays))]))
    pixels = landmarks.joints(z_m * landmarks.image_px) / landmarks.joints(z_m)
    directions = joints_m / np.linalg.norm(joints_m, axis=1, keepdims=True)
    half_thickness_m = _HALF_THICKNESS_M.copy()
    half_thickness_m[INDEX["torso"]] = _torso_half_thickness_m(joints_m, directions[INDEX["torso"]])
    radius_px = lens.matrix[0, 0] * _RADIUS_M / joints_m[:, 2]
    return _Body(joints_m, pixels, landmarks.confidence, half_thickness_m * directions[:, 2], radius_px)


def _torso_half_thickness_m(joints_m: Array, direction: Array) -> float:
    """Return half the thickness of an elliptic trunk along a ray's direction (3,): 1 / √(cos² φ / a² + sin² φ / b²).

    φ is the angle by which the trunk is turned from the ray, a half its depth, b half its width.
    """
    names = ("left_shoulder", "left_hip", "right_shoulder", "right_hip")
    left_shoulder, left_hip, right_shoulder, right_hip = (joints_m[INDEX[name]] for name in names)
    across = left_shoulder + left_hip - right_shoulder - right_hip
    sine = float(across @ direction) / max(float(np.linalg.norm(across)), 1e-9)
    cosine = np.sqrt(max(1 - sine**2, 0.0))
    return float(1 / np.hypot(cosine / HALF_THICKNESS_M["torso"], sine / HALF_WIDTH_M))


def _scale(body: _Body, depth_m: DepthImage) -> float | None:
    """Estimate the body's size relative to the model's, the median over its joints; None if too few are measured.

    A body s times as large at s times the distance looks the same. With a joint at depth z and its surface at z - o,
    the measured distance is s (z - o).
    """
    model_m = body.joints_m[:, 2] - body.offset_m
    sizes = _surfaces(body, depth_m, SIZE_RANGE[0] * model_m, SIZE_RANGE[1] * model_m) / model_m
    known = sizes[~np.isnan(sizes)]
    return float(np.median(known)) if len(known) >= LEAST_JOINTS else None


def _surfaces(body: _Body, depth_m: DepthImage, low_m: Array, high_m: Array) -> Array:
    """Return the depth of each visible joint's surface (15,; m) between two depths (15,; m); NaN if there is none.

    It is the median of a window's depths in range; of a limb only of those within `LIMB_DEPTH_M` of the nearest.
    """
    surfaces = np.full(len(JOINTS), np.nan)
    for i in np.flatnonzero(body.confidence >= LEAST_VISIBLE):
        low, high = max(float(low_m[i]), 0.0), float(high_m[i])
        for window in WINDOWS:
            values = _window(depth_m, body.pixels[i], window * body.radius_px[i])
            near = values[(values > low) & (values < high)]
            if len(near) and not _IN_TRUNK[i]:  # a limb may be narrower than its window: no mixed values, no background
                near = near[near <= np.quantile(near, NEAREST_QUANTILE) + LIMB_DEPTH_M]
            if len(near) >= max(LEAST_PIXELS, LEAST_SHARE * values.size):
                surfaces[i] = np.median(near)
                break
    return surfaces


def _window(depth_m: DepthImage, pixel: Array, half_px: float) -> DepthImage:
    """Return the square of the depth image around a pixel (x, y); empty if the pixel is outside the image."""
    height, width = depth_m.shape
    (x, y), half = np.rint(pixel).astype(int), max(round(half_px), 1)
    if not (0 <= x < width and 0 <= y < height):
        return depth_m[:0]
    return depth_m[max(y - half, 0) : y + half + 1, max(x - half, 0) : x + half + 1]


def _filled_along_limbs(differences_m: Array) -> Array:
    """Fill missing differences (15,; NaN) with that of the next joint towards the torso that has one, or with 0."""
    filled = differences_m.copy()
    torso = INDEX["torso"]
    filled[torso] = 0.0 if np.isnan(filled[torso]) else filled[torso]
    for parent, child, _ in BONES:
        if np.isnan(filled[child]):
            filled[child] = filled[parent]
    return filled
