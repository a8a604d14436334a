"""The benchmark of continuations compares predictions with the frames that follow, and with three assumptions."""

from collections.abc import Sequence

import numpy as np
import pytest
from benchmarks.continuation.errors import BASELINES, EVERY_NS, FIRST_NS, Array, as_measured, errors_of, starts

from actum.node import SECOND_NS
from people import STANDING
from som_classifier.continuation import HORIZONS_S
from som_classifier.frames import Frame
from som_classifier.kinematics import LAG_TIME_CONSTANT_S, Kinematics

POSTURE = STANDING - STANDING[2]
SPEED_MPS = 0.3
BEHIND_M = 0.02


def moving(seconds: float = 4.0) -> list[Frame]:
    """Somebody whose joints all move at one speed; what is smoothed lags behind by 2 cm."""
    frames, velocity = [], np.tile([SPEED_MPS * LAG_TIME_CONSTANT_S, 0.0, 0.0], (15, 1))
    for stamp_ns in range(0, round(seconds * SECOND_NS), SECOND_NS // 30):
        measured = POSTURE + np.array([SPEED_MPS * stamp_ns / SECOND_NS, 0.0, 0.0])
        smooth = Kinematics(measured - np.array([BEHIND_M, 0.0, 0.0]), velocity)
        frames.append(Frame(stamp_ns, None, (), 0, 0.0, measured, np.zeros(5), smooth, upright=measured))
    return frames


def test_the_errors_of_the_assumptions_are_those_by_hand() -> None:
    gone_m = SPEED_MPS * np.array(HORIZONS_S)
    expected = gone_m, gone_m + BEHIND_M, np.full(3, BEHIND_M)
    for predict, errors_m in zip(BASELINES.values(), expected, strict=True):
        assert errors_of(predict, [moving()], as_measured) == pytest.approx(errors_m, abs=1e-6)


def test_predictions_are_made_every_fifth_of_a_second_once_there_is_a_velocity() -> None:
    stamps_ns = np.array([frame.stamp_ns for frame in moving()])
    at_ns = stamps_ns[list(starts(stamps_ns))]
    assert at_ns[0] >= FIRST_NS
    assert (np.diff(at_ns) >= EVERY_NS).all()


def test_a_prediction_is_given_no_later_frame() -> None:
    """The newest frame is the one that the time ahead counts from."""
    given: list[int] = []

    def predict(frames: Sequence[Frame]) -> Array:
        given.append(frames[-1].stamp_ns)
        return (
            np.stack([as_measured(frames[-1])] * 3) + np.array([SPEED_MPS, 0, 0]) * np.array(HORIZONS_S)[:, None, None]
        )

    assert errors_of(predict, [moving()], as_measured) == pytest.approx(np.zeros(3), abs=1e-6)
    assert given == sorted(given) and given


def test_nothing_is_predicted_across_a_break() -> None:
    frames = moving()
    del frames[40:80]
    assert errors_of(BASELINES["stays as measured"], [frames], as_measured) == pytest.approx(
        SPEED_MPS * np.array(HORIZONS_S), abs=1e-6
    )
