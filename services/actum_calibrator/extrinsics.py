"""Estimates the transform from the marker camera to the people camera, from pairs of pictures of one board."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum import geometry
from actum.arrays import Array
from actum.calibration import Calibration, ExtrinsicsQuality
from actum_calibrator.board_views import View
from actum_calibrator.bundle_adjustment import BundleAdjuster, BundleAdjustment, CameraModel, compose, invert, rms_px
from actum_calibrator.pairs import Pair
from actum_calibrator.view_set import PoorSetError

FEWEST_PAIRS = 3  # a single pair allows several transforms; a third pair decides if two disagree
ROBUST_SCALE_OF_NOISE = 2.0  # residuals beyond twice the noise of single cameras indicate a moved board or camera
MISMATCH = 3.0  # times the calibration's RMS error: above it, the calibration belongs to another camera
LEAST_MISMATCH_OF_DIAGONAL = 2.5e-4  # 0.2 px in 640x480: the noise of corners
OUTLIER = 3.0  # times the noise of a pair's single cameras: above it, a camera or the board has moved
LEAST_OUTLIER_OF_DIAGONAL = 5e-4  # 0.4 px in 640x480: the noise of two calibrations
MOST_POSITION_DEVIATION_MM = 5.0  # small compared with the distances between objects
MOST_ROTATION_DEVIATION_DEG = 0.5  # 17 mm at a distance of 2 m


@dataclass(frozen=True)
class Extrinsics:
    """The transform (4, 4; m) from the marker camera's frame to the people camera's, and measures of its quality."""

    skeleton_from_image: Array
    rms_px: float
    rms_of_pairs_px: list[float]
    position_deviation_mm: float
    rotation_deviation_deg: float


def estimate_extrinsics(pairs: Sequence[Pair], markers: Calibration, people: Calibration) -> Extrinsics:
    """Fit one transform to all pairs, minimising the reprojection error in both cameras.

    Raises:
        PoorSetError: there are too few pairs, or they contradict each other or do not determine the transform.
        CalibrationError: the size of a picture differs from that of its camera's calibration.
    """
    if len(pairs) < FEWEST_PAIRS:
        few = f"{len(pairs)} are usable, at least {FEWEST_PAIRS} are needed, 6 to 10 are good; take more"
        raise PoorSetError([f"too few pairs: {few}"])
    for pair in pairs:
        markers.check_size(*pair.markers.size, pair.markers.name)
        people.check_size(*pair.people.size, pair.people.name)
    cameras = CameraModel.of(markers), CameraModel.of(people)
    markers_noise_px = [_noise_px(pair.markers, cameras[0]) for pair in pairs]
    people_noise_px = [_noise_px(pair.people, cameras[1]) for pair in pairs]
    if reasons := [*_mismatch("markers", markers_noise_px, markers), *_mismatch("people", people_noise_px, people)]:
        raise PoorSetError(reasons)
    both = zip(markers_noise_px, people_noise_px, strict=True)
    noise_px = [math.sqrt((one**2 + other**2) / 2) for one, other in both]
    adjustment = _adjusted(pairs, *cameras, float(np.median(noise_px)))
    if reasons := _contradictions(adjustment, pairs, noise_px) or _undetermined(adjustment):
        raise PoorSetError(reasons)
    transform = np.eye(4)
    transform[:3, :3], _ = cv2.Rodrigues(adjustment.people_from_markers[:3])
    transform[:3, 3] = adjustment.people_from_markers[3:]
    return Extrinsics(transform, _rms_px(adjustment), adjustment.rms_px, *_deviations(adjustment))


def _noise_px(view: View, camera: CameraModel) -> float:
    """Return the RMS reprojection error of one camera's view alone, at the best pose of the board."""
    candidates = camera.pose_candidates(view)
    return min((rms_px(camera.linearised(view, pose)[0]) for pose in candidates), default=math.inf)


def _mismatch(what: str, noise_px: Sequence[float], calibration: Calibration) -> list[str]:
    """Return a complaint if corners fit a calibration worse than its own ones did: it belongs to another camera."""
    least_px = LEAST_MISMATCH_OF_DIAGONAL * math.hypot(*calibration.image_size)
    made_px = calibration.intrinsics.rms_px if calibration.intrinsics else 2 * least_px / MISMATCH
    limit_px, typical_px = max(MISMATCH * made_px, least_px), float(np.median(noise_px))
    if typical_px <= limit_px:
        return []
    return [
        f"the calibration of the camera that sees {what} does not fit its pictures: {typical_px:.2f} px, at most "
        f"{limit_px:.2f} px are accepted; check that the calibration belongs to this camera at this zoom and "
        "focus, and that the options describe this board"
    ]


def _adjusted(pairs: Sequence[Pair], markers: CameraModel, people: CameraModel, noise_px: float) -> BundleAdjustment:
    """Choose the initial transform among those of single pairs, by the median error over all, then adjust it."""
    in_markers = [markers.pose_candidates(pair.markers) for pair in pairs]
    in_people = [people.pose_candidates(pair.people) for pair in pairs]
    proposals = [
        compose(people_pose, invert(markers_pose))
        for markers_poses, people_poses in zip(in_markers, in_people, strict=True)
        for markers_pose in markers_poses
        for people_pose in people_poses
    ]
    adjuster = BundleAdjuster(markers, people, pairs, ROBUST_SCALE_OF_NOISE * noise_px)

    def likeliest_board(people_from_markers: Array, i: int) -> tuple[float, Array]:
        """Return (error in px, pose in the marker camera) of the best candidate pose of pair i's board."""
        from_people = [compose(invert(people_from_markers), pose) for pose in in_people[i]]
        candidates = [*in_markers[i], *from_people]
        rated = [(adjuster.rms_px(people_from_markers, pose, pairs[i]), pose) for pose in candidates]
        return min(rated, key=lambda one: one[0])

    errors_px = [np.median([likeliest_board(proposal, i)[0] for i in range(len(pairs))]) for proposal in proposals]
    start = proposals[int(np.argmin(errors_px))]
    return adjuster.adjust(start, [likeliest_board(start, i)[1] for i in range(len(pairs))])


def _contradictions(adjustment: BundleAdjustment, pairs: Sequence[Pair], noise_px: Sequence[float]) -> list[str]:
    """Return complaints about the pairs that do not fit the common transform."""
    views: list[View] = [view for pair in pairs for view in (pair.markers, pair.people)]
    least_px = LEAST_OUTLIER_OF_DIAGONAL * max(view.diagonal_px for view in views)
    limits_px = [max(OUTLIER * noise, least_px) for noise in noise_px]
    rated = zip(pairs, adjustment.rms_px, limits_px, strict=True)
    outliers = [
        f"{pair.name} ({error:.1f} px, at most {limit:.1f} px)" for pair, error, limit in rated if error > limit
    ]
    if 2 * len(outliers) > len(pairs):
        return [
            f"no transform fits the pairs: {len(outliers)} of {len(pairs)} contradict each other, RMS "
            f"{_rms_px(adjustment):.2f} px; check that both calibrations belong to these cameras at this size, "
            "zoom and focus, and that nothing moved between the two pictures of a pair; worst pairs: "
            f"{', '.join(outliers)}"
        ]
    if outliers:
        return [
            f"{len(outliers)} of {len(pairs)} pairs contradict the others ({', '.join(outliers)}): a camera moved, "
            "or the board moved between the two pictures. Leave these pairs out; if a camera moved, take all "
            "pairs again"
        ]
    return []


def _undetermined(adjustment: BundleAdjustment) -> list[str]:
    position_mm, rotation_deg = _deviations(adjustment)
    if position_mm <= MOST_POSITION_DEVIATION_MM and rotation_deg <= MOST_ROTATION_DEVIATION_DEG:
        return []
    return [
        f"the transform is not determined: its standard deviation is {position_mm:.1f} mm and {rotation_deg:.2f} "
        f"deg, at most {MOST_POSITION_DEVIATION_MM:g} mm and {MOST_ROTATION_DEVIATION_DEG:g} deg are accepted; "
        "show the board closer, tilted, and at different places in both images"
    ]


def _deviations(adjustment: BundleAdjustment) -> tuple[float, float]:
    """Return the standard deviations of the position (mm) and the rotation (deg), summed over the three axes."""
    variances = np.diag(adjustment.covariance)
    return 1000 * math.sqrt(float(variances[3:].sum())), math.degrees(math.sqrt(float(variances[:3].sum())))


def _rms_px(adjustment: BundleAdjustment) -> float:
    return float(np.sqrt(np.mean(np.square(adjustment.rms_px))))


def with_extrinsics(markers: Calibration, extrinsics: Extrinsics, date: datetime.date) -> Calibration:
    """Add the transform and its quality to the marker camera's calibration."""
    quality = ExtrinsicsQuality(
        date=date,
        pairs=len(extrinsics.rms_of_pairs_px),
        rms_px=round(extrinsics.rms_px, 4),
        position_standard_deviation_mm=round(extrinsics.position_deviation_mm, 3),
        rotation_standard_deviation_deg=round(extrinsics.rotation_deviation_deg, 4),
    )
    numbers = [round(value, 9) for value in geometry.flat(extrinsics.skeleton_from_image)]
    return markers.model_copy(update={"skeleton_from_image": numbers, "extrinsics": quality})
