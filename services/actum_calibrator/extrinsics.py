"""Where the camera that sees people sees the one that sees markers, from pairs of pictures of one board."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum import geometry
from actum.calibration import Calibration, ExtrinsicsQuality
from actum_calibrator.board import Array
from actum_calibrator.intrinsics import PoorSetError
from actum_calibrator.joint import Adjuster, Adjustment, Eye, composed, inverted, rms_px
from actum_calibrator.pairs import Pair
from actum_calibrator.views import View

FEWEST_PAIRS = 3
SCALE_OF_NOISE = 2.0
FOREIGN, LEAST_FOREIGN_OF_DIAGONAL = 3.0, 2.5e-4
OUTLYING, LEAST_OUTLYING_OF_DIAGONAL = 3.0, 5e-4
MOST_POSITION_DEVIATION_MM, MOST_ROTATION_DEVIATION_DEG = 5.0, 0.5


@dataclass(frozen=True)
class Extrinsics:
    """The transform (4, 4; m) from the marker camera's frame to the people camera's, and how well the pairs fit it."""

    skeleton_from_image: Array
    rms_px: float
    rms_of_pairs_px: list[float]
    position_deviation_mm: float
    rotation_deviation_deg: float


def find_extrinsics(pairs: Sequence[Pair], markers: Calibration, people: Calibration) -> Extrinsics:
    """Fit one transform to all pairs, minimising the reprojection error in both cameras.

    Raises:
        PoorSetError: too few pairs, pairs that contradict each other, or that do not determine the transform.
        CalibrationError: a picture has another size than its camera's calibration.
    """
    if len(pairs) < FEWEST_PAIRS:
        raise PoorSetError(
            [f"too few pairs: {len(pairs)} usable, at least {FEWEST_PAIRS} are needed; 6 to 10 are good: take more"]
        )
    for pair in pairs:
        markers.check_size(*pair.markers.size, pair.markers.name)
        people.check_size(*pair.people.size, pair.people.name)
    eyes = Eye.of(markers), Eye.of(people)
    near_px = [_noise_px(pair.markers, eyes[0]) for pair in pairs]
    far_px = [_noise_px(pair.people, eyes[1]) for pair in pairs]
    if reasons := [*_foreign("markers", near_px, markers), *_foreign("people", far_px, people)]:
        raise PoorSetError(reasons)
    noise_px = [math.sqrt((near**2 + far**2) / 2) for near, far in zip(near_px, far_px, strict=True)]
    found = _adjusted(pairs, *eyes, float(np.median(noise_px)))
    if reasons := _contradictions(found, pairs, noise_px) or _undetermined(found):
        raise PoorSetError(reasons)
    return _extrinsics(found)


def _noise_px(view: View, eye: Eye) -> float:
    """How badly corners fit where one camera alone may see the board anywhere."""
    return min((rms_px(eye.residuals_px(view, pose)) for pose in eye.poses(view)), default=math.inf)


def _foreign(what: str, noise_px: Sequence[float], calibration: Calibration) -> list[str]:
    """Say that a calibration is not the camera's: corners fit it worse than those that it was made from."""
    least_px = LEAST_FOREIGN_OF_DIAGONAL * math.hypot(*calibration.image_size)
    made_px = calibration.intrinsics.rms_px if calibration.intrinsics else 2 * least_px / FOREIGN
    limit_px, typical_px = max(FOREIGN * made_px, least_px), float(np.median(noise_px))
    if typical_px <= limit_px:
        return []
    return [
        f"the calibration of the camera that sees {what} does not fit its pictures: {typical_px:.2f} px, at most "
        f"{limit_px:.2f}: is it this camera's, at this zoom and focus, and is the board that of the options?"
    ]


def _adjusted(pairs: Sequence[Pair], markers: Eye, people: Eye, noise_px: float) -> Adjustment:
    """Start from the transform that single pairs propose and that suits most pairs, then adjust to all."""
    near = [markers.poses(pair.markers) for pair in pairs]
    far = [people.poses(pair.people) for pair in pairs]
    proposals = [composed(b, inverted(a)) for nears, fars in zip(near, far, strict=True) for a in nears for b in fars]

    def board(transform: Array, place: int) -> tuple[float, Array]:
        """The likeliest pose of a pair's board, as either camera has it, with the error in both."""
        from_people = [composed(inverted(transform), pose) for pose in far[place]]
        rated = [(_error_px(transform, a, pairs[place], markers, people), a) for a in [*near[place], *from_people]]
        return min(rated, key=lambda one: one[0])

    errors = [np.median([board(transform, place)[0] for place in range(len(pairs))]) for transform in proposals]
    start = proposals[int(np.argmin(errors))]
    adjuster = Adjuster(markers, people, pairs, SCALE_OF_NOISE * noise_px)
    return adjuster.adjust(start, [board(start, place)[1] for place in range(len(pairs))])


def _error_px(transform: Array, board: Array, pair: Pair, markers: Eye, people: Eye) -> float:
    near = markers.residuals_px(pair.markers, board)
    far = people.residuals_px(pair.people, composed(transform, board))
    return rms_px(np.vstack([near, far]))


def _contradictions(found: Adjustment, pairs: Sequence[Pair], noise_px: Sequence[float]) -> list[str]:
    """Name the pairs that the transform of the others does not suit."""
    least_px = LEAST_OUTLYING_OF_DIAGONAL * _diagonal_px(pairs)
    limits_px = [max(OUTLYING * noise, least_px) for noise in noise_px]
    rated = zip(pairs, found.rms_px, limits_px, strict=True)
    outlying = [f"{pair.name} ({error:.1f} px, at most {limit:.1f})" for pair, error, limit in rated if error > limit]
    if 2 * len(outlying) > len(pairs):
        return [
            f"the pairs fit no transform: {len(outlying)} of {len(pairs)} contradict each other, RMS "
            f"{_rms_px(found):.2f} px: are the two calibrations these cameras', at this size, zoom and focus, and did "
            f"nothing move between the two pictures of a pair? {', '.join(outlying)}"
        ]
    if outlying:
        return [
            f"{len(outlying)} of {len(pairs)} pairs contradict the others: {', '.join(outlying)}: a camera moved, or "
            "the board moved between the two pictures. Leave these out; if a camera moved for good, take all pairs anew"
        ]
    return []


def _undetermined(found: Adjustment) -> list[str]:
    position_mm, rotation_deg = _deviations(found)
    if position_mm <= MOST_POSITION_DEVIATION_MM and rotation_deg <= MOST_ROTATION_DEVIATION_DEG:
        return []
    return [
        f"not determined: standard deviation {position_mm:.1f} mm and {rotation_deg:.2f} deg, at most "
        f"{MOST_POSITION_DEVIATION_MM:g} mm and {MOST_ROTATION_DEVIATION_DEG:g} deg: show the board nearer, tilted, "
        "and at different places in both images"
    ]


def _extrinsics(found: Adjustment) -> Extrinsics:
    transform = np.eye(4)
    transform[:3, :3], _ = cv2.Rodrigues(found.people_from_markers[:3])
    transform[:3, 3] = found.people_from_markers[3:]
    return Extrinsics(transform, _rms_px(found), found.rms_px, *_deviations(found))


def _deviations(found: Adjustment) -> tuple[float, float]:
    """Standard deviations of the position (mm) and of the rotation (deg), over all three axes."""
    variances = np.diag(found.covariance)
    return 1000 * math.sqrt(float(variances[3:].sum())), math.degrees(math.sqrt(float(variances[:3].sum())))


def _rms_px(found: Adjustment) -> float:
    return float(np.sqrt(np.mean(np.square(found.rms_px))))


def _diagonal_px(pairs: Sequence[Pair]) -> float:
    views: list[View] = [view for pair in pairs for view in (pair.markers, pair.people)]
    return max(view.diagonal_px for view in views)


def with_extrinsics(markers: Calibration, found: Extrinsics, date: datetime.date) -> Calibration:
    """Return the marker camera's calibration with the transform in it."""
    quality = ExtrinsicsQuality(
        date=date,
        pairs=len(found.rms_of_pairs_px),
        rms_px=round(found.rms_px, 4),
        position_standard_deviation_mm=round(found.position_deviation_mm, 3),
        rotation_standard_deviation_deg=round(found.rotation_deviation_deg, 4),
    )
    numbers = [round(value, 9) for value in geometry.flat(found.skeleton_from_image)]
    return markers.model_copy(update={"skeleton_from_image": numbers, "extrinsics": quality})
