"""Where people are in the image: as OpenCV projects them, and only where the image has them."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.geometry import flat
from actum.skeletons import INDEX
from humans import NEAR, image
from people import STANDING, lacking
from ros2_bridge.frames import header
from ros2_bridge.hri_out.camera import KEYPOINTS, Camera, UnusableCameraError

SURE = [1.0] * 15
LENS = [-0.28, 0.09, 0.001, -0.002, -0.01, 0.02, 0.01, 0.003, 0.001, 0.0005, -0.001, 0.0002]
"""OpenCV's first twelve coefficients, as of a wide webcam."""
OF = header(1, "camera")


@pytest.mark.parametrize("count", [0, 4, 5, 8, 12])
def test_joints_are_where_opencv_projects_them(count) -> None:
    camera = Camera.of(image(distortion=LENS[:count]))
    expected, _ = cv2.projectPoints(
        STANDING, np.zeros(3), np.zeros(3), np.array(NEAR).reshape(3, 3), np.array(LENS[:count])
    )
    assert camera.seen(STANDING, SURE).places * [640, 480] == pytest.approx(expected[:, 0], abs=1e-6)


def test_a_foot_far_below_the_image_is_not_shown_where_the_lens_model_turns_back() -> None:
    """At 55 degrees, the polynomial of a usual webcam points into the image again, as OpenCV's projection does."""
    joints, foot = STANDING.copy(), INDEX["left_foot"]
    joints[foot] = [0.0, 1.0, 0.7]
    camera = Camera.of(image(distortion=[-0.4, 0.0, 0.0, 0.0]))
    projected, _ = cv2.projectPoints(
        joints[foot], np.zeros(3), np.zeros(3), np.array(NEAR).reshape(3, 3), np.array([-0.4, 0.0, 0.0, 0.0])
    )
    assert 0 < projected[0, 0, 1] < 480
    places = camera.seen(joints, SURE).places
    assert np.isnan(places[foot]).all()
    assert not np.isnan(places[INDEX["head"]]).any()


def test_a_camera_beside_that_of_the_skeletons_sees_people_from_its_own_place() -> None:
    half_a_metre_right = np.eye(4)
    half_a_metre_right[0, 3] = 0.5
    here, there = (
        Camera.of(it).seen(STANDING, SURE).places
        for it in (image(), image(skeleton_from_image=flat(half_a_metre_right)))
    )
    assert there[0, 0] - here[0, 0] == pytest.approx(-0.5 * 525 / 2.5 / 640)


def test_the_points_are_in_the_order_of_skeleton2d() -> None:
    """hri_msgs/msg/Skeleton2D.msg: nose, neck, right arm, left arm, right leg, left leg, eyes, ears."""
    seen = Camera.of(image()).seen(STANDING, SURE)
    points = seen.skeleton_2d(OF).skeleton
    assert KEYPOINTS[:4] == ("head", "neck", "right_shoulder", "right_elbow")
    assert KEYPOINTS[8:12] == ("right_hip", "right_knee", "right_foot", "left_hip")
    for point, joint in zip(points, KEYPOINTS, strict=False):
        assert (point.x, point.y) == pytest.approx(tuple(seen.places[INDEX[joint]]))


def test_a_point_that_is_unknown_outside_or_behind_has_no_confidence() -> None:
    joints = lacking(STANDING, "left_hand")
    joints[INDEX["right_hand"]] = [9.0, 0.0, 2.0]
    joints[INDEX["right_foot"]] = [0.0, 0.0, -2.0]
    points = Camera.of(image()).seen(joints, SURE).skeleton_2d(OF).skeleton
    gone = {KEYPOINTS[i] for i, point in enumerate(points[:14]) if (point.x, point.y, point.c) == (0, 0, 0)}
    assert gone == {"left_hand", "right_hand", "right_foot"}


def test_a_points_confidence_is_the_sources_within_0_and_1() -> None:
    sure = list(SURE)
    sure[INDEX["head"]], sure[INDEX["neck"]] = 0.25, 7.0
    points = Camera.of(image()).seen(STANDING, sure).skeleton_2d(OF).skeleton
    assert [point.c for point in points[:2]] == [0.25, 1.0]


def test_a_region_reaches_beyond_the_joints_by_half_a_head_and_ends_with_the_image() -> None:
    seen = Camera.of(image()).seen(STANDING, SURE)
    region = seen.region(OF)
    top, margin = seen.places[:, 1].min(), 0.12 * 525 / 2.5 / 480
    assert region.ymin == pytest.approx(top - margin)
    close = Camera.of(image()).seen(STANDING - [0, 0, 1.4], SURE).region(OF)
    assert close.ymax == 1


def test_who_is_not_in_the_image_has_no_region() -> None:
    assert Camera.of(image()).seen(STANDING - [0, 0, 9], SURE).region(OF) is None


@pytest.mark.parametrize(
    "fields", [{"K": [-1.0, *NEAR[1:]]}, {"K": [1e300, *NEAR[1:]]}, {"skeleton_from_image": [1e9] * 16}]
)
def test_a_camera_that_cannot_be_is_none(fields) -> None:
    with pytest.raises(UnusableCameraError):
        Camera.of(image(**fields))


@given(st.lists(st.floats(-1e308, 1e308), min_size=0, max_size=14))
def test_absurd_lenses_show_nothing_outside_of_the_image(distortion) -> None:
    places = Camera.of(image(distortion=distortion)).seen(STANDING, SURE).places
    known = places[~np.isnan(places)]
    assert ((known >= 0) & (known <= 1)).all()
