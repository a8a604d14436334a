"""The default recogniser answers from a segment's own frames, of either hand, also where joints are missing."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.samples import SegmentSample
from recognisers import in_a_mirror, tiny_model, tiny_samples
from som_classifier.attention import PART_NAMES, attended_part
from som_classifier.convolutions import resampled
from som_classifier.frame_activity import FrameActivity, known_joint_share
from som_classifier.frames import Frame
from som_classifier.handedness import mirrored
from som_classifier.kinematics import averaged, movement_m
from som_classifier.model import Recognition
from som_classifier.pyramid import SCALE, Pyramid
from som_classifier.pyramid_model import PyramidModel

SAMPLES = tiny_samples()
each_sample = pytest.mark.parametrize("sample", SAMPLES[:3], ids=lambda sample: sample.label)


def model() -> PyramidModel:
    found = tiny_model()
    assert isinstance(found, PyramidModel)
    return found


def part_of(sample: SegmentSample, frames: slice) -> SegmentSample:
    names = ("stamps_ns", "joints", "motion", "postures", "velocities")
    return replace(sample, **{name: getattr(sample, name)[frames] for name in names})


def one_after_the_other(*samples: SegmentSample) -> SegmentSample:
    names = ("joints", "motion", "postures", "velocities")
    joined = {name: np.concatenate([getattr(sample, name) for sample in samples]) for name in names}
    lasts = np.cumsum([0, *(np.ptp(sample.stamps_ns) + 10**9 for sample in samples)])
    stamps = [s.stamps_ns - s.stamps_ns[0] + last for s, last in zip(samples, lasts[:-1], strict=True)]
    return replace(samples[0], stamps_ns=np.concatenate(stamps), **joined)


def lacking(sample: SegmentSample, *names: str) -> SegmentSample:
    gone = np.isin(np.arange(15), [INDEX[name] for name in names])[:, None]
    hidden = {name: np.where(gone, np.nan, getattr(sample, name)) for name in ("joints", "postures", "velocities")}
    return replace(sample, **hidden)


def test_every_training_sample_is_learned() -> None:
    answers = [answer(model(), encoded(model(), sample)) for sample in SAMPLES]
    assert [found.label for found in answers] == [sample.label for sample in SAMPLES]
    assert [found.part for found in answers] == ["right_arm", "right_arm", "left_arm"] * 2


def read_by(model: PyramidModel, sample: SegmentSample) -> np.ndarray:
    """Its postures, in a mirror where the left arm acts."""
    in_mirror = model.reads_in_mirror([frame.activity for frame in encoded(model, sample)])
    return mirrored(sample.postures) if in_mirror else sample.postures


@each_sample
def test_an_answer_is_cosines_and_the_share_of_their_softmax(sample: SegmentSample) -> None:
    frames = encoded(model(), sample)
    found = model().recognise(frames, complete=True)
    evidence = model().evidence(frames)
    scores = model().complete_scores(evidence)
    cosines = model().layer3.cosines(model().action_map.activity(scores))
    shares = np.exp(model().metadata.gains[-1] * cosines)
    assert found.activations == dict(zip(model().labels, cosines.tolist(), strict=True))
    assert found.confidence == pytest.approx(shares.max() / shares.sum())
    winner = int(np.argmax(cosines))
    log_error = float(model().first.log_errors(read_by(model(), sample), model().winners(frames)).mean())
    verifier = model().verifier
    likeness = verifier.likeness(winner, evidence.pooled, evidence.features, log_error)
    assert found.familiarity == pytest.approx(verifier.probability(likeness), abs=1e-5)
    assert found.label == model().labels[winner]


@each_sample
def test_a_complete_segment_is_scored_by_maps_and_convolutions(sample: SegmentSample) -> None:
    frames, opinion = encoded(model(), sample), model().opinion
    of_maps = model().scores([frame.activity for frame in frames], [0.0, 0.0, 1.0])
    own = (
        opinion.convolutions.features(resampled(sample.stamps_ns, read_by(model(), sample))) @ opinion.axes
        + opinion.offsets
    )
    expected = (of_maps + opinion.weight * own) / (1 + opinion.weight)
    np.testing.assert_allclose(model().complete_scores(model().evidence(frames)), expected, atol=1e-5)


@settings(deadline=None)
@given(st.integers(0, 5), st.integers(1, 25), st.integers(0, 2))
def test_frames_before_the_segment_do_not_matter(other: int, before: int, which: int) -> None:
    """Not to the last bit: neither how many were summed before nor of whom."""
    prefix = part_of(one_after_the_other(SAMPLES[other], SAMPLES[other]), slice(before))
    joined = encoded(model(), one_after_the_other(prefix, SAMPLES[which]))[before:]
    alone = encoded(model(), SAMPLES[which])
    for complete in (False, True):
        assert model().recognise(joined, complete) == model().recognise(alone, complete)
    np.testing.assert_array_equal(model().trace(joined), model().trace(alone))


@settings(deadline=None)
@given(st.integers(0, 2), st.integers(0, 19))
def test_a_window_is_answered_as_if_the_reading_began_there(which: int, first: int) -> None:
    whole = encoded(model(), SAMPLES[which])[first:]
    alone = encoded(model(), part_of(SAMPLES[which], slice(first, None)))
    assert model().recognise(whole, True) == model().recognise(alone, True)
    np.testing.assert_array_equal(model().trace(whole), model().trace(alone))


def test_the_running_sums_may_wrap_around() -> None:
    frames = encoded(model(), SAMPLES[0])
    wrapped = [replace(frame, activity=begun_at(frame.activity, 2**32 - int(SCALE))) for frame in frames]
    assert any((frame.activity.after < frame.activity.before).any() for frame in wrapped)
    assert model().recognise(wrapped, True) == model().recognise(frames, True)


def begun_at(activity: FrameActivity, begun: int) -> FrameActivity:
    return activity._replace(run=activity.run._replace(sums=activity.run.sums + np.uint32(begun)))


@each_sample
@pytest.mark.parametrize("complete", [False, True])
def test_the_mirror_image_of_who_acts_with_one_arm_is_answered_alike(sample: SegmentSample, complete: bool) -> None:
    one, other = (model().recognise(encoded(model(), each), complete) for each in (sample, in_a_mirror(sample)))
    assert (other.label, other.activations, other.confidence) == (one.label, one.activations, one.confidence)
    assert {one.part, other.part} == {"right_arm", "left_arm"}


def test_left_handed_segments_are_read_in_the_mirror() -> None:
    for sample in SAMPLES[:3]:
        activities = [frame.activity for frame in encoded(model(), sample)]
        side = 1 if sample.label == "swing" else 0
        sums = model().prefix_sums(activities)
        read = np.stack(sums.sums[1:])
        np.testing.assert_array_equal(read, np.stack([activity.after[side] for activity in activities]))


@settings(deadline=None)
@given(st.integers(0, 2), st.integers(0, 15), st.integers(0, 2**32 - 1))
def test_the_part_is_the_one_attended_to(which: int, first: int, seed: int) -> None:
    """Whatever moved before the segment, and however its parts move."""
    motion = np.random.default_rng(seed).uniform(0, 0.03, SAMPLES[which].motion.shape)
    frames = encoded(model(), replace(SAMPLES[which], motion=motion))[first:]
    assert model().recognise(frames, True).part == PART_NAMES[attended_part(motion[first:])]


def each_estimate(frames: Sequence[Frame]) -> list[Recognition]:
    return [model().recognise(frames[:count], False) for count in range(1, len(frames) + 1)]


@each_sample
def test_there_is_an_estimate_from_the_first_frame_on(sample: SegmentSample) -> None:
    estimates = each_estimate(encoded(model(), sample))
    for found in estimates:
        assert set(found.activations) == set(model().labels)
        assert found.label == max(found.activations, key=found.activations.__getitem__)
        assert 1 / len(model().labels) <= found.confidence <= 1
        assert max(map(abs, found.activations.values())) <= 1 + 1e-6
    assert [found.label for found in estimates[-6:]] == [sample.label] * 6


def test_estimates_go_by_the_time_since_the_start_and_final_answers_do_not() -> None:
    frames = encoded(model(), SAMPLES[0])
    slow = [replace(frame, stamp_ns=4 * frame.stamp_ns) for frame in frames]
    later = [replace(frame, stamp_ns=frame.stamp_ns + 100 * SECOND_NS) for frame in frames]
    assert model().recognise(slow, True) == model().recognise(frames, True)
    assert model().recognise(later, False) == model().recognise(frames, False)
    assert model().recognise(slow[:5], False).activations != model().recognise(frames[:5], False).activations


def test_an_estimate_after_the_usual_time_and_more_is_the_final_answer() -> None:
    """But for what only complete segments have: the second opinion and the familiarity."""
    alone = replace(model(), opinion=replace(model().opinion, weight=0.0))
    frames = encoded(alone, SAMPLES[1])
    late = [*frames[:-1], replace(frames[-1], stamp_ns=frames[0].stamp_ns + 60 * SECOND_NS)]
    assert alone.recognise(late, False) == replace(alone.recognise(late, True), familiarity=None)


def test_no_frame_is_an_error() -> None:
    with pytest.raises(ValueError, match="no frame"):
        model().recognise([], True)


@pytest.mark.parametrize(("least", "unknown"), [(-1e9, False), (1e9, True)])
def test_only_a_whole_segment_is_unknown(least: float, unknown: bool) -> None:
    strict = replace(model(), verifier=replace(model().verifier, least_likeness=least))
    frames = encoded(strict, SAMPLES[0])
    assert strict.recognise(frames, True).unknown is unknown
    begun = strict.recognise(frames, False)
    assert (begun.unknown, begun.familiarity) == (False, None)


def with_least_movement(least_m: float) -> PyramidModel:
    return replace(model(), body=replace(model().body, least_m=least_m))


@each_sample
def test_who_moves_half_as_far_as_the_least_is_unknown_and_half_as_sure(sample: SegmentSample) -> None:
    usual = answer(model(), encoded(model(), sample))
    moved_m = movement_m(averaged(sample.stamps_ns, sample.postures))
    found = answer(strict := with_least_movement(2 * moved_m), encoded(strict, sample))
    assert found.unknown and found.familiarity == pytest.approx((usual.familiarity or 0) / 2)
    assert found.confidence == pytest.approx(usual.confidence / 2)
    assert (found.label, found.activations, found.part) == (usual.label, usual.activations, usual.part)


@each_sample
def test_who_moves_as_far_as_the_least_is_answered_as_ever(sample: SegmentSample) -> None:
    enough = with_least_movement(movement_m(averaged(sample.stamps_ns, sample.postures)))
    unmeasured = with_least_movement(0.0)
    frames = encoded(enough, sample)
    assert enough.recognise(frames, True) == unmeasured.recognise(frames, True)


def test_an_action_that_has_only_begun_may_have_moved_little() -> None:
    frames = encoded(model(), SAMPLES[0])
    assert with_least_movement(9.0).recognise(frames, False) == with_least_movement(0.0).recognise(frames, False)


def test_a_stranger_movement_is_less_familiar() -> None:
    rng = np.random.default_rng(0)
    odd = replace(SAMPLES[0], postures=rng.normal(0, 0.5, SAMPLES[0].postures.shape))
    usual = min(answer(model(), encoded(model(), sample)).familiarity or 0 for sample in SAMPLES)
    assert (answer(model(), encoded(model(), odd)).familiarity or 0) < usual


SOME = ("head", "left_foot", "right_foot", "left_knee")


@pytest.mark.parametrize("names", [("right_hand",), SOME, tuple(name for name in INDEX if name != "torso")])
@each_sample
def test_any_joint_may_be_missing(sample: SegmentSample, names: tuple[str, ...]) -> None:
    for found in each_estimate(encoded(model(), lacking(sample, *names))):
        assert np.isfinite([*found.activations.values(), found.confidence, found.familiarity or 0]).all()


def codes_of(sample: SegmentSample) -> list[FrameActivity]:
    return [frame.activity for frame in encoded(model(), sample)]


def test_the_share_of_the_joints_that_was_there() -> None:
    assert known_joint_share(codes_of(SAMPLES[0])) == 1.0
    poor = lacking(SAMPLES[0], *SOME)
    assert known_joint_share(codes_of(poor)) == pytest.approx(11 / 15)
    both = codes_of(one_after_the_other(poor, SAMPLES[0]))
    half = len(poor.stamps_ns)
    assert known_joint_share(both) == pytest.approx(13 / 15)
    assert known_joint_share(both[half:]) == 1.0


def test_the_more_joints_are_missing_the_lower_the_confidence() -> None:
    doubtful = replace(model(), metadata=model().metadata.model_copy(update={"gains": [2.0] * 3}))

    def mean_confidence(*names: str) -> float:
        found = [answer(doubtful, encoded(doubtful, lacking(sample, *names))) for sample in SAMPLES]
        return float(np.mean([recognition.confidence for recognition in found]))

    acting = ("right_elbow", "right_hand", "left_elbow", "left_hand")
    whole, partly, hardly = mean_confidence(), mean_confidence(*SOME), mean_confidence(*SOME, *acting)
    assert whole > partly + 0.01
    assert partly > hardly + 0.01


def test_a_missing_share_takes_as_much_off_the_logits() -> None:
    """Of a segment that says the same all the same."""
    frames = encoded(model(), SAMPLES[0])
    encoder = model().encoder()
    partly = [replace(frame, missing=(0, 11, 14)) for frame in frames]
    found = model().recognise([replace(frame, activity=encoder.encode(frame)) for frame in partly], True)
    logits = model().metadata.gains[-1] * 0.8 * np.array([*found.activations.values()])
    assert found.activations == model().recognise(frames, True).activations
    assert found.confidence == pytest.approx(1 / np.exp(logits - logits.max()).sum())


def test_joints_that_say_nothing_leave_the_answer() -> None:
    answers = [answer(model(), encoded(model(), lacking(sample, *SOME))) for sample in SAMPLES]
    assert [found.label for found in answers] == [sample.label for sample in SAMPLES]


def test_the_trace_is_where_the_postures_won() -> None:
    sample = part_of(SAMPLES[0], slice(0, 8))
    winners = model().first.postures.bmus(sample.postures.reshape(8, -1))
    kept = [winner for i, winner in enumerate(winners) if i == 0 or winner != winners[i - 1]]
    np.testing.assert_array_equal(model().trace(encoded(model(), sample)), model().first.postures.coordinates[kept])


def test_who_acts_with_the_left_arm_leaves_the_trace_of_the_mirror_image() -> None:
    for sample in SAMPLES[:2]:
        right, left = encoded(model(), sample), encoded(model(), in_a_mirror(sample))
        assert model().reads_in_mirror([frame.activity for frame in left])
        np.testing.assert_array_equal(model().trace(left), model().trace(right))


def test_the_maps_show_where_a_segment_was_active() -> None:
    """Each map's most active unit is 1, whatever was summed before."""
    frames = encoded(model(), one_after_the_other(SAMPLES[1], SAMPLES[0]))[len(SAMPLES[1].stamps_ns) :]
    shown = model().maps(frames)
    assert {name: activities.shape for name, activities in shown.items()} == {
        "postures": (6, 6),
        "velocities": (6, 6),
        "arms": (6, 6),
        "actions": (8, 8),
    }
    assert all(activities.min() >= 0 and activities.max() == 1 for activities in shown.values())
    pooled = Pyramid((1,), 0.0).vector(model().prefix_sums([frame.activity for frame in frames])) ** 4
    postures = pooled[:36].reshape(6, 6)
    np.testing.assert_allclose(shown["postures"], postures / postures.max(), rtol=1e-4)
