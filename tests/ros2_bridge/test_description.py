"""Bodies' URDFs become links, whichever detector wrote them, and what describes no body is refused."""

import math

import numpy as np
import pytest

import human_model
from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from people import STANDING, reaching, turned
from ros2_bridge.hri.human_model import FOREARM_M, LINKS, link_places
from ros2_bridge.hri_in.description import MOST_LINKS, SHOULDERS_M, USUAL_LINKS, BadDescriptionError, links_of
from ros2_bridge.hri_out.body import body_of
from ros2_bridge.hri_out.personal_model import PERSONAL_LINKS, urdf

UPRIGHT = {link.joint: 0.0 for link in LINKS if link.joint is not None}


def robot(*joints: str) -> str:
    return f"<robot name='human'>{''.join(joints)}</robot>"


def joint(child: str, parent: str = "body_ab", kind: str = "fixed", inner: str = "<origin xyz='0 0 0.1'/>") -> str:
    ends = f"<parent link='{parent}'/><child link='{child}'/>"
    return f"<joint name='of_{child}' type='{kind}'>{ends}{inner}</joint>"


def test_human_descriptions_urdf_gives_the_links_that_count_without_one() -> None:
    rng = np.random.default_rng(0)
    described = links_of(human_model.urdf("ab", FOREARM_M), "ab")
    for _ in range(20):
        angles = {name: float(angle) for name, angle in zip(UPRIGHT, rng.uniform(-2, 2, len(UPRIGHT)), strict=True)}
        ours = link_places(angles, USUAL_LINKS)
        theirs = link_places(angles, described)
        assert ours.keys() == theirs.keys()
        for name in ours:
            assert theirs[name] == pytest.approx(ours[name]), name


def test_human_descriptions_arms_begin_where_depth_cameras_have_the_shoulders() -> None:
    usual, measured = link_places(UPRIGHT), link_places(UPRIGHT, USUAL_LINKS)
    arms = {name for name in usual if name.endswith(("shoulder", "elbow", "wrist"))}
    for name in usual:
        moved = np.array(measured[name]) - usual[name]
        assert moved == pytest.approx(SHOULDERS_M if name in arms else (0, 0, 0)), name


@pytest.mark.parametrize("joints", [STANDING, reaching(1.0), turned(reaching(0.5, 0.7), 2.5)])
def test_in_a_persons_own_model_all_links_lie_at_the_persons_joints(joints: np.ndarray) -> None:
    body = body_of(joints)
    assert body is not None
    found = link_places(body.angles | body.shifts_m, links_of(urdf("ab"), "ab"))
    for name, (place, _) in body.links.items():
        assert found[name] == pytest.approx(place, abs=1e-6), name


def test_a_persons_own_model_with_all_joints_at_0_is_human_descriptions() -> None:
    usual = link_places(UPRIGHT)
    own = link_places(UPRIGHT, PERSONAL_LINKS)
    for name in usual.keys() - {"r_head", "y_head", "p_head", "head"}:
        assert own[name] == pytest.approx(usual[name]), name
    assert own["spine"] == pytest.approx([each / 2 for each in own["torso"]])


def test_links_are_turned_by_rpy_and_slide_along_axes_in_their_own_orientation() -> None:
    quarter = "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/><axis xyz='1 0 0'/>"
    links = links_of(robot(joint("hand_ab", kind="prismatic", inner=quarter)), "ab")
    assert link_places({"of_hand": 0.5}, [*links])["hand"] == pytest.approx((1, 0.5, 0))
    assert link_places({"of_hand": math.nan}, links)["hand"] == pytest.approx((1, 0, 0))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<robot",
        "<robot/>",
        '<!DOCTYPE robot [<!ENTITY a "a">]>' + robot(joint("head_ab")),
        robot(joint("head_cd", "body_cd")),
        robot(*(joint(f"l{i}_ab") for i in range(MOST_LINKS + 1))),
        robot(joint("head_ab"), joint("head_ab")),
        robot(joint("a_ab"), joint("b_ab", "a_ab"), joint("a_ab", "b_ab")),
        robot(joint("head_ab", inner="<origin xyz='0 0'/>")),
        robot(joint("head_ab", inner="<origin xyz='0 0 nan'/>")),
        robot(joint("head_ab", inner="<origin xyz='0 0 1e9'/>")),
        robot(joint("head_ab", kind="revolute", inner="<axis xyz='1 1 0'/>")),
    ],
    ids=[
        *("nothing", "no XML", "no joints", "with entities", "of another body", "too many", "twice", "in a circle"),
        *("two numbers", "no number", "too far", "a long axis"),
    ],
)
def test_what_describes_no_body_is_refused(text: str) -> None:
    with pytest.raises(BadDescriptionError):
        links_of(text, "ab")
