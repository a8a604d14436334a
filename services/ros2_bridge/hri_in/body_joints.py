"""Which frames of a body are our fifteen joints: the names of ROS4HRI's human model, and those of other trackers."""

import math
from collections.abc import Callable, Mapping

from actum.skeletons import JOINTS
from ros2_bridge.hri.placements import Placement
from ros2_bridge.rotations import Point

Places = Callable[[str], Point | None]
"""Where the frame of a body with a name lies (m), by the name without the body's id; None where that is unknown."""


def _of_side(joint: str, *parts: str) -> dict[str, tuple[str, ...]]:
    """Return the names of a joint of both sides, likest first, from the parts of the body that it may be called by."""
    return {
        f"{side}_{joint}": tuple(
            name for part in parts for name in (f"{side}_{part}", f"{side[0]}_{part}", f"{part}_{side}")
        )
        for side in ("left", "right")
    }


NAMES: Mapping[str, tuple[str, ...]] = {
    "head": ("head",),
    "neck": ("neck", "shoulder_center", "spine_shoulder"),
    "torso": ("spine_mid", "spine", "spine_navel"),
    **_of_side("shoulder", "shoulder"),
    **_of_side("elbow", "elbow"),
    **_of_side("hand", "hand", "wrist"),
    **_of_side("hip", "hip"),
    **_of_side("knee", "knee"),
    **_of_side("foot", "foot", "ankle"),
}
"""The names of frames that are a joint of ours, likest first: `l_wrist` is human_description's, `left_hand` OpenNI's,
`wrist_left` Kinect's. A wrist stands for a hand where there is none: human_description has no hands."""
MODEL_SHOULDERS = "torso"
"""The frame of human_description in the middle of the shoulders. OpenNI calls the middle of the trunk so, and the
joint above it `neck`, which human_description lacks."""
MODEL_NECK = "r_head"
"""The frame of human_description at the lower end of the head: as far as OpenNI's neck above the shoulders' line."""
BODY = "body"
"""The frame of human_description in the middle of the hips."""


def joints_of(places: Places, body: Placement | None) -> list[Point | None]:
    """Return the joints (m) in our order, None where none of the joint's names has a place.

    The torso, where it has no frame, is half as far above the hips as the neck is from them: along the z axis of the
    body, whose frame is `body`; towards the neck where that frame is unknown.
    """
    found = {joint: _first(places, names) for joint, names in NAMES.items()}
    if found["neck"] is None:
        found["neck"] = places(MODEL_NECK) or places(MODEL_SHOULDERS)
    elif found["torso"] is None:
        found["torso"] = places(MODEL_SHOULDERS)
    hips = _middle(found["left_hip"], found["right_hip"]) or (body and body.position_m)
    neck = found["neck"]
    if found["torso"] is None and hips is not None and neck is not None:
        half_m = math.dist(hips, neck) / 2
        found["torso"] = _middle(hips, neck) if body is None else Placement(hips, body.xyzw).at((0.0, 0.0, half_m))
    return [found[joint] for joint in JOINTS]


def _first(places: Places, names: tuple[str, ...]) -> Point | None:
    return next((place for name in names if (place := places(name)) is not None), None)


def _middle(one: Point | None, other: Point | None) -> Point | None:
    if one is None or other is None:
        return None
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2, (one[2] + other[2]) / 2
