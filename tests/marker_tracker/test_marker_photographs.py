"""Real photographs: every marker found and no false one, corners as published, a tag turned by known angles."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from actum.geometry import angle_between_rad
from actum.messages import Image, TrackedObject
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.marker import Marker
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings
from rotation_of import rotation_of

pytestmark = pytest.mark.data

K = [329.87, 0.0, 528.0, 0.0, 332.95, 396.0, 0.0, 0.0, 1.0]
IDENTITY = np.eye(4).ravel().tolist()
ANGLES = (-60, -20, 0, 20, 40, 60)
MARKERS = {
    "dt_apriltags/test_image.png": {60, 82, 318, 328, 387},
    "dt_apriltags/test_image_multiple_01.png": {22, 24, 58, 85, 144, 198},
    "dt_apriltags/test_image_multiple_02.png": {22, 24, 85, 144, 198},
    "dt_apriltags/test_image_multiple_03.png": {22, 24, 58, 85, 144, 198},
    "dt_apriltags/test_image_multiple_04.png": {22, 24, 58, 85, 144, 198},
    **{f"dt_apriltags/test_image_rotation_{degrees}.png": {76} for degrees in ANGLES},
    "ubiquity_fiducials/403.jpg": {403},
    "ubiquity_fiducials/aruco_images_bag_frame.jpg": {100, 103, 106, 107, 110, 111, 112},
    "ubiquity_fiducials/tag_01_d7_14cm.png": {1},
    "ubiquity_fiducials/tag_245-246_d7_14cm.png": {245, 246},
}
FAMILIES = (
    "DICT_4X4_1000", "DICT_5X5_1000", "DICT_6X6_1000", "DICT_7X7_1000", "DICT_ARUCO_ORIGINAL", "DICT_ARUCO_MIP_36H12",
    "DICT_APRILTAG_16H5", "DICT_APRILTAG_25H9", "DICT_APRILTAG_36H10", "DICT_APRILTAG_36H11",
)  # fmt: skip
PUBLISHED_PX = {
    ("tag_01_d7_14cm.png", 1): [
        (569.89917, 201.55890), (777.42560, 206.85025), (767.95856, 415.37830), (565.75311, 409.24496),
    ],
    ("tag_245-246_d7_14cm.png", 245): [
        (307.68246, 157.38346), (545.10131, 167.04420), (540.11614, 403.27578), (305.64746, 395.01422),
    ],
    ("tag_245-246_d7_14cm.png", 246): [
        (671.51892, 173.46070), (900.29650, 178.44973), (895.06933, 407.39855), (666.39910, 403.12911),
    ],
}  # fmt: skip


def found(data: Path, name: str, families: tuple[str, ...]) -> list[Marker]:
    pixels = cv2.imread(str(data / "markers" / name), cv2.IMREAD_GRAYSCALE)
    return MarkerDetector(dict.fromkeys(families, ())).search(pixels)


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "ids"), MARKERS.items())
def test_every_marker_is_found_and_no_false_one_with_all_families_searched(data, name, ids) -> None:
    family = "DICT_APRILTAG_36H11" if name.startswith("dt") else "DICT_5X5_1000"
    markers = found(data, name, FAMILIES)
    assert sorted((marker.family, marker.id) for marker in markers) == [(family, number) for number in sorted(ids)]


@pytest.mark.parametrize(("file", "number"), PUBLISHED_PX)
def test_corners_are_within_a_tenth_of_a_pixel_of_the_published(data, file, number) -> None:
    (marker,) = (each for each in found(data, f"ubiquity_fiducials/{file}", ("DICT_5X5_1000",)) if each.id == number)
    off = marker.corners_px - np.array(PUBLISHED_PX[file, number])
    assert np.linalg.norm(off, axis=1).max() < 0.1


def the_tag(data: Path, degrees: int) -> TrackedObject:
    pixels = cv2.imread(str(data / "markers" / "dt_apriltags" / f"test_image_rotation_{degrees}.png"))
    return tag_in(pixels)


def tag_in(pixels: np.ndarray) -> TrackedObject:
    height, width = pixels.shape[:2]
    image = Image(
        stamp_ns=0, sensor="kinect0", format="bgr8", width=width, height=height, data=pixels.tobytes(),
        K=[K[0], 0.0, (width - 1) / 2, *K[3:]], distortion=[], skeleton_from_image=IDENTITY,
    )  # fmt: skip
    tracker = MarkerTracker(Settings(dictionary="DICT_APRILTAG_36H11", marker_size_m=0.065))
    (answer,) = tracker.handle(image)
    (tag,) = answer.objects
    assert tag.id == 76
    return tag


def yaw_degrees(tag: TrackedObject) -> float:
    x, _, z = rotation_of(tag.quaternion_xyzw)[:, 2]
    return float(np.degrees(np.arctan2(x, -z)))


def test_the_tag_has_turned_as_far_as_it_was_turned(data) -> None:
    off = np.array([yaw_degrees(the_tag(data, degrees)) - degrees for degrees in ANGLES])
    off -= off.mean()
    assert np.abs(off).max() < 4.0
    assert np.abs(off).mean() < 1.5


@pytest.mark.parametrize("degrees", ANGLES)
def test_the_tag_stays_where_it_is_turned(data, degrees) -> None:
    straight, turned = the_tag(data, 0), the_tag(data, degrees)
    angle = np.degrees(angle_between_rad(rotation_of(straight.quaternion_xyzw), rotation_of(turned.quaternion_xyzw)))
    assert angle == pytest.approx(abs(degrees), abs=5.0)
    assert np.allclose(straight.position_m, turned.position_m, atol=0.02)


@pytest.mark.parametrize("degrees", [-60, 60])
@pytest.mark.parametrize("steeper", [65, 70, 75])
def test_a_tag_as_narrow_as_at_steeper_angles_is_found(data, degrees, steeper) -> None:
    pixels = cv2.imread(str(data / "markers" / "dt_apriltags" / f"test_image_rotation_{degrees}.png"))
    narrower = np.cos(np.radians(steeper)) / np.cos(np.radians(degrees))
    assert tag_in(cv2.resize(pixels, None, fx=narrower, fy=1.0, interpolation=cv2.INTER_AREA)).seen


@pytest.mark.parametrize("degrees", ANGLES)
def test_the_tag_is_found_in_smaller_photographs(data, degrees) -> None:
    pixels = cv2.imread(str(data / "markers" / "dt_apriltags" / f"test_image_rotation_{degrees}.png"))
    assert tag_in(cv2.resize(pixels, None, fx=0.75, fy=0.75, interpolation=cv2.INTER_AREA)).seen


@pytest.mark.parametrize(("scale", "steeper"), [(0.6, 60), (0.42, 60), (0.35, 60), (0.6, 70), (0.8, 76), (1.0, 80)])
def test_a_steep_tag_is_found_in_smaller_photographs(data, scale, steeper) -> None:
    photograph = data / "markers" / "dt_apriltags" / "test_image_rotation_60.png"
    narrower = np.cos(np.radians(steeper)) / np.cos(np.radians(60))
    pixels = cv2.resize(
        cv2.imread(str(photograph), cv2.IMREAD_GRAYSCALE),
        None,
        fx=scale * narrower,
        fy=scale,
        interpolation=cv2.INTER_AREA,
    )
    assert [marker.id for marker in MarkerDetector({"DICT_APRILTAG_36H11": ()}).search(pixels)] == [76]
