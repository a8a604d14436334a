"""A posture goes on as postures went on in training, whatever kind of model continues it."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum_model_trainer.training import with_continuation
from continued import KINDS, continuation_of, continued, postures_at, standing_stream, without_continuation
from handmade import paper_model, pyramid_model
from som_classifier.continuation import HORIZONS_S, smooth_posture_at
from som_classifier.frames import Frame
from som_classifier.kinematics import LAG_TIME_CONSTANT_S
from som_classifier.model import Model
from som_classifier.model_loading import load_model
from unmarked import encoded_live, scene

HAND = INDEX["right_hand"]


@cache
def encoded(kind: str) -> tuple[Frame, ...]:
    return tuple(encoded_live(continued(kind), scene(seed=9)))


@pytest.mark.parametrize("kind", KINDS)
def test_what_others_did_goes_on_nearer_to_the_truth_than_at_rest_and_at_its_speed(kind: str) -> None:
    """The scene is one that was not trained on; errors are means over joints, half a second ahead."""
    frames, continuation, errors_m = encoded(kind), continuation_of(continued(kind)), []
    for newest in range(30, len(frames) - 30, 3):
        [truth] = postures_at(frames, [frames[newest].stamp_ns + SECOND_NS // 2])
        kinematics, measured = frames[newest].kinematics, frames[newest].upright
        assert kinematics is not None and measured is not None
        moving = measured + 0.5 * kinematics.velocity / LAG_TIME_CONSTANT_S
        answers = continuation.ahead(frames[: newest + 1])[1], measured, kinematics.posture, moving
        errors_m.append([float(np.linalg.norm(answer - truth, axis=1).mean()) for answer in answers])
    ours, *baselines = np.mean(errors_m, axis=0)
    assert ours < min(baselines)


@pytest.mark.parametrize("kind", KINDS)
def test_a_posture_that_never_changed_stays_as_it_is(kind: str) -> None:
    model, newest = without_continuation(kind), encoded(kind)[10]
    assert newest.kinematics is not None
    still = with_continuation(model, [standing_stream(newest.kinematics.posture)])
    ahead = continuation_of(still).ahead([replace(newest, upright=newest.kinematics.posture)])
    assert ahead == pytest.approx(np.tile(newest.kinematics.posture, (3, 1, 1)), abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_depends_on_later_frames(kind: str) -> None:
    model, whole = continued(kind), scene(seed=9)
    until = replace(whole, joints=whole.joints[:100])
    all_frames, first_frames = encoded(kind), encoded_live(model, until)
    count = len(first_frames)
    continuation = continuation_of(model)
    assert np.array_equal(continuation.ahead(first_frames), continuation.ahead(all_frames[:count]))


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_depends_on_frames_more_than_a_step_old(kind: str) -> None:
    frames, continuation = encoded(kind)[:100], continuation_of(continued(kind))
    assert continuation.ahead(frames[-9:]) == pytest.approx(continuation.ahead(frames), abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_saved_model_continues_alike(kind: str, tmp_path: Path) -> None:
    model, frames = continued(kind), encoded(kind)[:60]
    model.save(tmp_path / "model.npz")
    loaded = load_model(tmp_path / "model.npz")
    assert loaded.id == model.id
    assert np.array_equal(continuation_of(loaded).ahead(frames), continuation_of(model).ahead(frames))


@pytest.mark.parametrize("model", [paper_model(), pyramid_model()], ids=KINDS)
def test_a_file_without_a_continuation_has_none(model: Model, tmp_path: Path) -> None:
    model.save(tmp_path / "model.npz")
    assert load_model(tmp_path / "model.npz").continuation is None


@pytest.mark.parametrize("kind", KINDS)
def test_the_continuation_is_a_part_of_the_id(kind: str) -> None:
    without, model = without_continuation(kind), continued(kind)
    assert model.id != without.id
    assert replace(model, continuation=None).id == without.id  # type: ignore[type-var]


@pytest.mark.parametrize("kind", KINDS)
def test_a_missing_joint_stays_missing_alone(kind: str) -> None:
    whole = scene(seed=9)
    joints = whole.joints.copy()
    joints[:, HAND] = np.nan
    frames = encoded_live(continued(kind), replace(whole, joints=joints))
    ahead = continuation_of(continued(kind)).ahead(frames[:60])
    assert np.isnan(ahead[:, HAND]).all() and np.isfinite(np.delete(ahead, HAND, axis=1)).all()


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_frame_of_a_person_can_be_continued(kind: str) -> None:
    assert continuation_of(continued(kind)).ahead(encoded(kind)[:1]).shape == (len(HORIZONS_S), 15, 3)


def test_an_earlier_posture_is_interpolated() -> None:
    frames = encoded("paper")[40:43]
    middle_ns = (frames[0].stamp_ns + frames[1].stamp_ns) // 2
    first, second = (frame.kinematics.posture for frame in frames[:2] if frame.kinematics is not None)
    assert smooth_posture_at(frames, middle_ns) == pytest.approx((first + second) / 2, abs=1e-6)
    assert np.array_equal(smooth_posture_at(frames, frames[1].stamp_ns), second)
    assert np.array_equal(smooth_posture_at(frames, frames[0].stamp_ns - SECOND_NS), first)
