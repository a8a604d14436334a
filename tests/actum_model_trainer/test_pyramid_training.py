"""The default recogniser's layers learn from the very vectors that it will see."""

from dataclasses import replace

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.som import Som
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.discriminants import Discriminants, fit_discriminants, folds_of
from actum_model_trainer.hand_preference import people_prefer_one_hand
from actum_model_trainer.median_distances import SMALLEST_ERROR2, median_quantization_error2
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from performers import TINY
from recognisers import in_a_mirror
from som_classifier.first_layer import MAP_INPUTS, frame_inputs
from som_classifier.presets import BodyVariation, PyramidPreset
from som_classifier.pyramid_model import PyramidModel

NOBODY = BodyVariation(0, build_sd=0.0, tempo=1.0)
PLAIN = replace(TINY, turns_deg=(), leans_deg=(), others=NOBODY, stages=((1.0,),))


def trained(samples: list[SegmentSample], preset: PyramidPreset = TINY, seed: int = 0) -> PyramidModel:
    model = train(samples, preset, seed)
    assert isinstance(model, PyramidModel)
    return model


def pooled(model: PyramidModel, sample: SegmentSample, fraction: float) -> np.ndarray:
    codes = [frame.activity for frame in encoded(model, sample)]
    return model.pyramid.vector(model.prefix_sums(codes[: round(fraction * len(codes))]))


def assert_fitted(
    model: PyramidModel, samples: list[SegmentSample], fractions: tuple[float, ...], atol: float
) -> Discriminants:
    """The model's first stage scores these shares of the samples as discriminants that were fitted to them."""
    repeated = [sample for sample in samples for _ in fractions]
    vectors = np.stack([pooled(model, sample, fraction) for sample in samples for fraction in fractions])
    indicators = np.eye(len(model.labels))[[model.labels.index(sample.label) for sample in repeated]]
    folds = folds_of([sample.person for sample in repeated], [sample.label for sample in repeated])
    fitted = fit_discriminants(vectors, indicators, folds, PLAIN.shrinkage)
    scores = vectors @ model.stages.axes[0] + model.stages.offsets[0]
    np.testing.assert_allclose(scores, fitted.training_scores, atol=atol)
    return fitted


def without_arms(sample: SegmentSample) -> SegmentSample:
    """The shoulders are hidden in one frame, all else of the arms in the next."""
    gone = np.zeros((len(sample.stamps_ns), 15, 1), dtype=bool)
    gone[::2, [INDEX["right_shoulder"], INDEX["left_shoulder"]]] = True
    gone[1::2, [INDEX[f"{side}_{joint}"] for side in ("right", "left") for joint in ("elbow", "hand")]] = True
    hidden = {name: np.where(gone, np.nan, getattr(sample, name)) for name in ("postures", "velocities")}
    return replace(sample, **hidden)


def test_a_model_of_one_person_knows_what_is_none_of_its_actions(samples: list[SegmentSample]) -> None:
    one = [replace(sample, person="1") for sample in samples]
    model = trained(one)
    assert not any(answer(model, encoded(model, sample)).unknown for sample in one)
    lying = [replace(s, postures=s.postures[:, :, [1, 0, 2]], velocities=s.velocities[:, :, [1, 0, 2]]) for s in one]
    assert all(answer(model, encoded(model, sample)).unknown for sample in lying)


def test_a_model_remembers_what_left_out_samples_were_taken_for(samples: list[SegmentSample]) -> None:
    told = trained(samples).metadata.held_out_answers
    assert sorted(done for done, _ in told) == sorted(sample.label for sample in samples)
    assert np.mean([done == answered for done, answered in told]) > 0.9
    rng = np.random.default_rng(0)
    drawn = rng.choice(["a", "b"], len(samples))
    mixed_up = [replace(s, label=str(name)) if s.label == "lift" else s for s, name in zip(samples, drawn, strict=True)]
    told = trained(mixed_up).metadata.held_out_answers
    assert {("a", "b"), ("b", "a")} & set(told)
    assert not {answered for done, answered in told if done in "ab"} - {"a", "b"}


def test_samples_of_few_people_are_augmented_more(samples: list[SegmentSample]) -> None:
    several = BodyVariation(3, build_sd=0.2, tempo=0.5)
    of_few = replace(PLAIN, others_of_few=several, few_people=2)
    for names in ("11", "12"):
        few = [replace(sample, person=names[k % 2]) for k, sample in enumerate(samples)]
        told = trained(few, of_few), trained(few, replace(PLAIN, others=several, few_people=0))
        np.testing.assert_array_equal(told[0].stages.axes, told[1].stages.axes)
        assert not np.array_equal(told[0].stages.axes, trained(few, replace(PLAIN, few_people=0)).stages.axes)
    usual = trained(samples, of_few), trained(samples, PLAIN)
    assert len({sample.person for sample in samples}) > 2
    np.testing.assert_array_equal(usual[0].stages.axes, usual[1].stages.axes)


def test_each_stage_is_fitted_to_that_share_of_the_action(samples: list[SegmentSample]) -> None:
    model = trained(samples, replace(PLAIN, stages=((0.3, 0.5), (1.0,))))
    assert model.metadata.fractions == pytest.approx([0.4, 1.0])
    assert_fitted(model, samples, (0.3, 0.5), atol=0.05)


def changing_arms(sample: SegmentSample) -> SegmentSample:
    """The left arm begins, the right one acts twice as far."""
    begun, on = in_a_mirror(sample), sample
    names = ("postures", "velocities", "motion", "joints")
    both = {name: np.concatenate([getattr(begun, name)[:8], getattr(on, name)]) for name in names}
    return replace(sample, stamps_ns=np.arange(8 + len(sample.stamps_ns)) * 33_000_000, **both)


def test_what_was_seen_so_far_is_read_by_the_arm_that_acts_so_far(samples: list[SegmentSample]) -> None:
    """As live: nobody knows yet that the other arm will act."""
    changing = [changing_arms(sample) for sample in right_handed(samples)]
    early, late = ({sample.acting_hands[k] for sample in changing} for k in (7, -1))
    assert ("left" in early, late) == (True, {"right"})
    model = trained(changing, replace(PLAIN, stages=((0.2, 0.3), (1.0,))))
    assert_fitted(model, changing, (0.2, 0.3), atol=0.05)


def test_durations_are_those_of_the_samples(samples: list[SegmentSample]) -> None:
    slower = [replace(s, stamps_ns=s.stamps_ns * (1 + i % 4)) for i, s in enumerate(samples)]
    durations_s = np.array([np.ptp(sample.stamps_ns) / SECOND_NS for sample in slower])
    about = trained(slower).metadata
    assert about.log_duration_mean == pytest.approx(np.log(durations_s).mean())
    assert about.log_duration_sd == pytest.approx(np.log(durations_s).std())
    assert trained(samples).metadata.log_duration_sd == pytest.approx(0.1), "however alike they are"


def right_handed(samples: list[SegmentSample]) -> list[SegmentSample]:
    return [in_a_mirror(sample) if sample.label == "swing" else sample for sample in samples]


def with_a_left_hander(samples: list[SegmentSample]) -> list[SegmentSample]:
    """Everybody acts with one hand, person 1 with the left one."""
    return [in_a_mirror(sample) if sample.person == "1" else sample for sample in right_handed(samples)]


def test_where_people_change_hands_the_hand_belongs_to_the_action(samples: list[SegmentSample]) -> None:
    assert {sample.acting_hands[-1] for sample in samples if sample.label == "swing"} == {"left"}
    assert not people_prefer_one_hand(samples)
    assert not trained(samples).metadata.mirrors
    for others in (right_handed(samples), with_a_left_hander(samples), [replace(s, person=s.label) for s in samples]):
        assert people_prefer_one_hand(others)
        assert trained(others).metadata.mirrors


def test_now_and_then_a_person_may_use_the_other_hand(samples: list[SegmentSample]) -> None:
    first, *others = right_handed(samples)
    assert people_prefer_one_hand([in_a_mirror(first), *others])
    assert not people_prefer_one_hand([in_a_mirror(first), *others[:5]])


def test_contrasts_are_relative_to_the_distances_on_the_maps(samples: list[SegmentSample]) -> None:
    mixed = with_a_left_hander(samples)
    half, whole = (trained(mixed, replace(TINY, relative_contrast=contrast)) for contrast in (0.5, 1.0))
    for name in ("posture_contrast", "velocity_contrast", "arm_contrast"):
        assert getattr(whole.metadata, name) == pytest.approx(2 * getattr(half.metadata, name))
    postures = np.concatenate([sample.postures for sample in samples]).reshape(-1, 45)
    plain = trained(mixed, PLAIN)
    acting = np.concatenate([sample.postures for sample in right_handed(samples)])
    distances2 = [np.square(plain.first.postures.weights - x.ravel()).sum(axis=1).min() for x in acting]
    assert len(distances2) == len(postures)
    assert plain.metadata.posture_contrast == pytest.approx(0.5 * np.median(distances2), rel=1e-3)


def test_the_map_of_arms_learns_the_arm_that_acts(samples: list[SegmentSample]) -> None:
    """The right one, and of who acts with the left one that of the mirror image."""
    model = trained(with_a_left_hander(samples), PLAIN)
    acting = right_handed(samples)
    postures, velocities = (
        np.concatenate([getattr(sample, name) for sample in acting]) for name in ("postures", "velocities")
    )
    arms = MAP_INPUTS["arms"].of(frame_inputs(postures, velocities))
    distances2 = [np.square(model.first.maps["arms"].weights - row).sum(axis=1).min() for row in arms]
    assert model.metadata.arm_contrast == pytest.approx(0.5 * np.median(distances2), rel=1e-3)
    assert tuple(model.metadata.arm_shares) == model.first.arm_shares == PLAIN.arm_shares
    assert model.first.maps["arms"].weights.mean(axis=0) == pytest.approx(arms.mean(axis=0), abs=0.1)


def test_where_no_arm_was_ever_seen_from_its_shoulder_its_map_says_nothing(samples: list[SegmentSample]) -> None:
    armless = [without_arms(sample) for sample in samples]
    model = trained(armless, PLAIN)
    assert all(np.isfinite(array).all() for array in model.arrays.values())
    activities = model.first.activities(armless[0].postures, armless[0].velocities).reshape(-1, 4, 36)
    for arm, share in zip((2, 3), PLAIN.arm_shares, strict=True):
        np.testing.assert_allclose(activities[:, arm], share / 36, rtol=1e-5)
    assert [answer(model, encoded(model, sample)).label for sample in armless] == [s.label for s in armless]


def test_mirror_images_teach_the_same_about_whole_actions(samples: list[SegmentSample]) -> None:
    mixed, whole = with_a_left_hander(samples), replace(TINY, stages=((1.0,),))
    one, other = trained(mixed, whole), trained([in_a_mirror(sample) for sample in mixed], whole)
    for name, array in one.arrays.items():
        np.testing.assert_array_equal(array, other.arrays[name])


def test_only_what_the_layers_see_matters(samples: list[SegmentSample]) -> None:
    """Neither the paper's egocentric joints nor files and names."""
    other = [
        replace(s, joints=s.joints + 0.3, file="elsewhere", segment_id="x", stamps_ns=s.stamps_ns + 9) for s in samples
    ]
    one, two = trained(samples), trained(other)
    for name, array in one.arrays.items():
        np.testing.assert_array_equal(array, two.arrays[name])


def test_missing_joints_can_be_learned_from(samples: list[SegmentSample]) -> None:
    gappy = []
    for i, sample in enumerate(samples):
        gone = np.zeros((len(sample.stamps_ns), 15, 1), dtype=bool)
        gone[i % 5 :: 3, [0, 11, 14]] = True
        postures, velocities = (np.where(gone, np.nan, values) for values in (sample.postures, sample.velocities))
        gappy.append(replace(sample, postures=postures, velocities=velocities))
    model = trained(gappy)
    assert all(np.isfinite(array).all() for array in model.arrays.values())
    assert [answer(model, encoded(model, each)).label for each in gappy] == [sample.label for sample in samples]
    assert [answer(model, encoded(model, each)).label for each in samples] == [sample.label for sample in samples]


def test_what_was_taught_is_likelier_true_than_what_was_taught_as_another_action(samples: list[SegmentSample]) -> None:
    model = trained(samples)
    for sample in samples:
        frames = encoded(model, sample)
        activities = [frame.activity for frame in frames]
        of_each = [model.likeness(action, model.evidence(frames), activities) for action in range(len(model.labels))]
        assert model.labels[int(np.argmax(of_each))] == sample.label
        assert answer(model, frames).familiarity == model.verifier.probability(max(of_each)) > 0.5


def test_at_most_the_share_meant_to_be_unknown_is(samples: list[SegmentSample]) -> None:
    model = trained(samples)
    unknown = [answer(model, encoded(model, sample)).unknown for sample in samples]
    assert np.mean(unknown) <= 1 - TINY.known_share


def test_labels_at_random_make_a_model_that_is_not_sure(samples: list[SegmentSample]) -> None:
    rng, labels = np.random.default_rng(0), [sample.label for sample in samples]
    drawn = [rng.permutation(labels) for _ in range(3)]
    at_random = [[replace(s, label=str(name)) for s, name in zip(samples, names, strict=True)] for names in drawn]
    assert np.mean([mean_confidence(learned) for learned in at_random]) < 0.5
    assert mean_confidence(samples) > 0.9


def mean_confidence(samples: list[SegmentSample]) -> float:
    """Of a model in its own training samples."""
    model = trained(samples)
    return float(np.mean([answer(model, encoded(model, sample)).confidence for sample in samples]))


@pytest.mark.parametrize(
    ("rows", "expected"),
    [([[1.0], [2.0], [3.0]], 4.0), ([[1.0, np.nan, 1.0]], 3.0), ([[0.0, 0.0, 0.0]] * 4, SMALLEST_ERROR2)],
    ids=["of 1, 4 and 9", "two of three components known: 1 + 1 stands for 3", "never zero"],
)
def test_median_quantization_error_by_hand(rows: list[list[float]], expected: float) -> None:
    """One unit at 0."""
    assert median_quantization_error2(Som(1, 1, np.zeros((1, len(rows[0])))), np.array(rows)) == expected


@pytest.mark.parametrize("friends", [1, 2])
def test_an_action_that_one_person_alone_did_is_judged_by_samples_left_out(
    samples: list[SegmentSample], friends: int
) -> None:
    """That person cannot be left out; scores of samples that were learnt from would take most for unknown."""
    mine = [replace(sample, person="me") for sample in samples if sample.person != "3"]
    lifts = [replace(sample, person="friend") for sample in samples if sample.person == "3" and sample.label == "lift"]
    model = trained(mine + lifts[:friends])
    answers = [answer(model, encoded(model, sample)) for sample in samples]
    assert [found.label for found in answers] == [sample.label for sample in samples]
    assert np.mean([found.confidence for found in answers]) > 0.85


@pytest.mark.parametrize("counts", [(1, 2), (2, 1), (1, 1)])
def test_a_handful_of_samples_is_enough(samples: list[SegmentSample], counts: tuple[int, int]) -> None:
    named = [[sample for sample in samples if sample.label == label] for label in ("lift", "push")]
    few = [sample for own, count in zip(named, counts, strict=True) for sample in own[:count]]
    for people in (["1"] * len(few), [str(k) for k in range(len(few))]):
        model = trained([replace(sample, person=person) for sample, person in zip(few, people, strict=True)])
        assert [answer(model, encoded(model, sample)).label for sample in few] == [sample.label for sample in few]


def test_samples_that_all_move_alike_are_refused(samples: list[SegmentSample]) -> None:
    alike = [replace(samples[0], label=label, person=person) for label in "ab" for person in "xy"]
    with pytest.raises(TrainingError, match="cannot be distinguished"):
        trained(alike, PLAIN)
