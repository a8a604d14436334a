"""Where one camera is seen from the other, from rendered pairs: as it truly is, or refused with the reason."""

import datetime

import cv2
import numpy as np
import pytest

from actum.calibration import Calibration, CalibrationError, IntrinsicsQuality
from actum_calibrator.bundle_adjustment import BundleAdjuster, CameraModel, compose, compose_with_jacobians, invert
from actum_calibrator.extrinsics import estimate_extrinsics, with_extrinsics
from actum_calibrator.pairs import Pair, PairingError, pair_files
from actum_calibrator.view_set import PoorSetError
from boards import Lens


def transform(turn_deg: tuple[float, float, float], position_m: tuple[float, float, float]) -> np.ndarray:
    made = np.eye(4)
    made[:3, :3] = cv2.Rodrigues(np.radians(turn_deg))[0]
    made[:3, 3] = position_m
    return made


def calibration(lens: Lens) -> Calibration:
    return Calibration(image_size=lens.size, K=lens.intrinsics.ravel().tolist(), distortion=list(lens.distortion))


MARKERS = calibration(Lens())
PEOPLE = calibration(Lens(matrix=(530.0, 532.0, 314.0, 245.0), distortion=(0.06, -0.1, 0.0, 0.0, 0.0)))
TRUE = transform((3, -18, 4), (0.25, 0.02, 0.05))
MOVED = transform((3, -18, 4), (0.26, 0.02, 0.05))


@pytest.fixture(scope="module")
def pairs(pairs_of) -> list[Pair]:
    return pairs_of(TRUE)


@pytest.fixture(scope="module")
def moved_pairs(pairs_of) -> list[Pair]:
    return pairs_of(MOVED, 2)


def errors_of(found: np.ndarray) -> tuple[float, float]:
    turn, _ = cv2.Rodrigues(found[:3, :3] @ TRUE[:3, :3].T)
    return 1000 * float(np.linalg.norm(found[:3, 3] - TRUE[:3, 3])), float(np.degrees(np.linalg.norm(turn)))


@pytest.mark.parametrize("count", [3, 5])
def test_the_true_transform_is_found(pairs: list[Pair], count: int) -> None:
    found = estimate_extrinsics(pairs[:count], MARKERS, PEOPLE)
    position_mm, rotation_deg = errors_of(found.skeleton_from_image)
    assert position_mm < 3
    assert rotation_deg < 0.3
    assert position_mm < 4 * found.position_deviation_mm
    assert found.rms_px < 0.2


def test_from_a_rough_start_the_adjustment_comes_to_the_same_transform(pairs: list[Pair]) -> None:
    markers, people = CameraModel.of(MARKERS), CameraModel.of(PEOPLE)
    true = np.concatenate([np.ravel(cv2.Rodrigues(TRUE[:3, :3])[0]), TRUE[:3, 3]])
    boards = [markers.pose_candidates(pair.markers)[0] for pair in pairs]
    adjuster = BundleAdjuster(markers, people, pairs, scale_px=1.0)
    off = np.array([0.02, -0.02, 0.02, 0.01, -0.01, 0.01])
    exact, rough = (adjuster.adjust(start, boards) for start in (true, true + off))
    assert rough.people_from_markers == pytest.approx(exact.people_from_markers, abs=1e-6)
    assert rough.rms_px == pytest.approx(exact.rms_px, abs=1e-6)


def test_the_cameras_exchanged_give_the_inverse(pairs: list[Pair]) -> None:
    there = estimate_extrinsics(pairs, MARKERS, PEOPLE).skeleton_from_image
    exchanged = [Pair(pair.name, pair.people, pair.markers) for pair in pairs]
    back = estimate_extrinsics(exchanged, PEOPLE, MARKERS).skeleton_from_image
    assert back @ there == pytest.approx(np.eye(4), abs=1e-4)


def test_the_order_of_pairs_does_not_matter(pairs: list[Pair]) -> None:
    forwards = estimate_extrinsics(pairs, MARKERS, PEOPLE).skeleton_from_image
    backwards = estimate_extrinsics(pairs[::-1], MARKERS, PEOPLE).skeleton_from_image
    assert backwards == pytest.approx(forwards, abs=1e-5)


def test_pairs_after_a_camera_moved_by_a_centimetre_are_named(pairs: list[Pair], moved_pairs: list[Pair]) -> None:
    with pytest.raises(PoorSetError) as refused:
        estimate_extrinsics([*moved_pairs, *pairs[2:]], MARKERS, PEOPLE)
    (reason,) = refused.value.reasons
    assert reason.startswith("2 of 5 pairs contradict the others (pair 0 (")
    assert ", pair 1 (" in reason
    assert "a camera moved" in reason
    assert all(f"pair {n}" not in reason for n in (2, 3, 4))


def test_too_few_pairs_are_refused(pairs: list[Pair]) -> None:
    with pytest.raises(PoorSetError, match="too few pairs: 2 are usable, at least 3"):
        estimate_extrinsics(pairs[:2], MARKERS, PEOPLE)


def test_another_camera_s_calibration_is_refused(pairs: list[Pair]) -> None:
    quality = IntrinsicsQuality(
        date=datetime.date(2026, 3, 1), views=12, rms_px=0.07, standard_deviations_px=[0.5] * 4, coverage=0.6
    )
    longer = Calibration(
        image_size=(640, 480), K=[700, 0, 327, 0, 696, 236, 0, 0, 1], distortion=[], intrinsics=quality
    )
    with pytest.raises(PoorSetError, match="calibration of the camera that sees markers does not fit its pictures"):
        estimate_extrinsics(pairs, longer, PEOPLE)
    with pytest.raises(PoorSetError, match="calibration of the camera that sees people does not fit its pictures"):
        estimate_extrinsics([Pair(pair.name, pair.people, pair.markers) for pair in pairs], PEOPLE, longer)


def test_a_calibration_of_another_size_is_refused(pairs: list[Pair]) -> None:
    larger = PEOPLE.model_copy(update={"image_size": (1280, 720)})
    with pytest.raises(CalibrationError, match="0_b is 640x480, but the calibration is for 1280x720"):
        estimate_extrinsics(pairs, MARKERS, larger)


def test_the_result_is_the_marker_camera_s_calibration_with_the_transform(pairs: list[Pair]) -> None:
    found = estimate_extrinsics(pairs, MARKERS, PEOPLE)
    made = with_extrinsics(MARKERS, found, datetime.date(2026, 3, 1))
    assert made.K == MARKERS.K
    assert np.reshape(made.image_fields()["skeleton_from_image"], (4, 4)) == pytest.approx(found.skeleton_from_image)
    assert made.extrinsics is not None
    assert made.extrinsics.pairs == len(pairs)


def test_poses_chain_as_matrices_do() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        second, first = rng.normal(size=(2, 6))
        there, by_second, by_first = compose_with_jacobians(second, first)
        step = 1e-6 * rng.normal(size=(2, 6))
        moved = compose(second + step[0], first + step[1]) - there
        assert moved == pytest.approx(by_second @ step[0] + by_first @ step[1], abs=1e-9)
        assert compose(invert(second), there)[3:] == pytest.approx(first[3:], abs=1e-9)


def touch(folder, *names: str) -> None:
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).touch()


def test_files_are_paired_by_name(tmp_path) -> None:
    touch(tmp_path, "1_a.png", "1_b.png", "2_b.jpg", "2_a.png")
    files = sorted(tmp_path.iterdir())
    assert pair_files(files) == pair_files([tmp_path])
    assert [(name, a.name, b.name) for name, a, b in pair_files(files)] == [
        ("1", "1_a.png", "1_b.png"),
        ("2", "2_a.png", "2_b.jpg"),
    ]


def test_folders_are_paired_by_their_files_names(tmp_path) -> None:
    touch(tmp_path / "m", "1.png", "2.png")
    touch(tmp_path / "p", "1.png", "2.jpg")
    assert [name for name, _, _ in pair_files([tmp_path / "m", tmp_path / "p"])] == ["1", "2"]


@pytest.mark.parametrize("names", [("1_a.png",), ("1_a.png", "1_b.png", "2.png"), ("1_a.png", "1_a.jpg", "1_b.png")])
def test_files_that_make_no_pairs_are_named(tmp_path, names: tuple[str, ...]) -> None:
    touch(tmp_path, *names)
    with pytest.raises(PairingError):
        pair_files([tmp_path])
