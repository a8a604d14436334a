"""A person's own URDF and joint states, read as robot_state_publisher reads them, place links as the bridge does."""

from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from human_model import about
from people import STANDING, lacking, reaching, turned
from ros2_bridge.hri_out.body import Body, body_of
from ros2_bridge.hri_out.personal_model import urdf

Array = NDArray[np.float64]
LIMBS = {f"{side}_{link}" for side in "lr" for link in ("elbow", "wrist", "knee", "ankle")}


def published(text: str, positions: dict[str, float]) -> dict[str, Array]:
    """Each link's pose (4, 4) in the body's frame, by the kinds of joints that an URDF has."""
    waiting, found = ElementTree.fromstring(text).findall("joint"), {"body_ab": np.eye(4)}
    while waiting:
        joint = next(it for it in waiting if link(it, "parent") in found)
        waiting.remove(joint)
        placed, position = np.eye(4), positions.get(joint.get("name", "").removesuffix("_ab"), 0.0)
        placed[:3, 3] = numbers(joint, "origin")
        if joint.get("type") == "prismatic":
            placed[:3, 3] += position * numbers(joint, "axis")
        elif joint.get("type") == "continuous":
            placed[:3, :3] = about(numbers(joint, "axis"), position)
        found[link(joint, "child")] = found[link(joint, "parent")] @ placed
    return found


def link(joint: ElementTree.Element, end: str) -> str:
    return joint.find(end).get("link")  # type: ignore[union-attr, return-value]


def numbers(joint: ElementTree.Element, of: str) -> Array:
    return np.array(joint.find(of).get("xyz").split(), dtype=float)  # type: ignore[union-attr]


def seen(joints: Array) -> Body:
    body = body_of(joints)
    assert body is not None
    return body


@pytest.mark.parametrize("joints", [STANDING, reaching(1.0), turned(reaching(0.5, 0.7), 2.5)])
def test_each_link_lies_at_the_measured_joint(joints: Array) -> None:
    body = seen(joints)
    found = published(urdf("ab"), body.angles | body.shifts_m)
    for name, (place, _) in body.links.items():
        assert found[f"{name}_ab"][:3, 3] == pytest.approx(place, abs=1e-6), name


def test_limbs_are_turned_as_the_bridges_frames() -> None:
    body = seen(reaching(1.0))
    found = published(urdf("ab"), body.angles | body.shifts_m)
    for name in LIMBS:
        x, y, z, w = body.links[name][1]
        down = [-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y))]
        assert -found[f"{name}_ab"][:3, 2] == pytest.approx(down, abs=1e-6), name


def test_every_joint_that_is_published_is_one_of_the_urdf() -> None:
    body = seen(STANDING)
    names = {joint.get("name") for joint in ElementTree.fromstring(urdf("ab")).findall("joint")}
    assert {f"{name}_ab" for name in body.angles | body.shifts_m} <= names


def test_what_is_not_seen_does_not_slide() -> None:
    missing = seen(STANDING).shifts_m.keys() - seen(lacking(STANDING, "left_hand", "right_shoulder")).shifts_m.keys()
    assert missing == {"l_wrist_along_z", "r_elbow_along_z", *(f"r_shoulder_along_{axis}" for axis in "xyz")}
