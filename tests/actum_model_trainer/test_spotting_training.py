"""The search is trained on what it looks at live, and works or says why where recordings show little."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import Segment, Skeleton
from actum.node import SECOND_NS
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream, Samples
from actum_model_trainer.spotting.common_head import mixed_heads, with_common
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.heads_training import fit_heads
from actum_model_trainer.spotting.logistic_regression import logistic_fit
from actum_model_trainer.spotting.scanning import ScannedStream
from actum_model_trainer.spotting.spotting_training import _chosen
from actum_model_trainer.spotting.training_windows import (
    live_windows,
    overlap_ratio,
    training_windows,
    true_completeness,
)
from actum_model_trainer.training import train_to_spot
from performers import TINY, TINY_PAPER, performance
from som_classifier.frames import Frame
from som_classifier.kinematics import GAP_NS
from som_classifier.model import Model
from som_classifier.pyramid import SCALE
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.pyramid_spotter import FEWEST_FRAMES, PyramidSpotter
from som_classifier.spotting.spotted import SpottingOptions
from som_classifier.spotting.spotting_model import (
    CompletenessHeads,
    PyramidSpottingMetadata,
    SpottingModel,
    completeness_of_iou,
)
from unmarked import Scene, bounds_ns, encoded_live, recorded, scene, spotting_model, taught

LABELS = ["lift", "push", "swing"]
METADATA = PyramidSpottingMetadata(
    interval_s=0.1, lag_s=0.2, overlap=0.0, duration_weight=0.0, window_durations_s=[1.0], log_duration_means=[0.0] * 3,
    log_duration_sds=[0.3] * 3, thresholds=[0.45], false_alarms_per_min=[], recalls=[], precisions=[1.0],
    threshold=0.45, probability=[1.0, 0.0], background_s=0.0,
)  # fmt: skip


def stream_of(folder: Path, of: Scene, lost: frozenset[int] = frozenset()) -> LabelledStream:
    kept = [each for i, each in enumerate(of.skeletons()) if i not in lost]
    (stream,) = samples_from([recorded(folder, "one", [*kept, *of.marks()])]).streams
    return stream


LOST = frozenset([*range(50, 57), *range(100, 118), *range(200, 400, 3)])


@pytest.fixture(scope="module", params=[frozenset(), LOST], ids=["whole", "frames lost"])
def both(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[LabelledStream, list[Frame]]:
    """A stream as it is trained on, and as it is live."""
    of = scene(seed=4)
    return stream_of(tmp_path_factory.mktemp("one"), of, request.param), encoded_live(
        spotting_model(), of, request.param
    )


def test_a_recordings_stream_holds_the_frames_of_the_live_classifier(
    both: tuple[LabelledStream, list[Frame]],
) -> None:
    stream, frames = both
    assert stream.stamps_ns.tolist() == [frame.stamp_ns for frame in frames]
    for n, frame in enumerate(frames):
        assert frame.kinematics is not None
        np.testing.assert_array_equal(stream.postures[n], frame.kinematics.posture)
        np.testing.assert_array_equal(stream.velocities[n], frame.kinematics.velocity)


def test_the_vector_of_any_window_is_that_of_the_live_model(
    both: tuple[LabelledStream, list[Frame]],
) -> None:
    """But for single quantisation steps: activities of many frames at once round otherwise than those of one."""
    stream, frames = both
    model, rng = spotting_model(), np.random.default_rng(0)
    firsts = rng.integers(0, len(frames) - 5, 50)
    windows = np.stack([firsts, np.minimum(firsts + rng.integers(3, 59, 50), len(frames) - 1)], axis=1)
    vectors = np.empty((50, model.stages.axes.shape[1]), np.float32)
    EncodedStream(model, stream, windows).pool(0, 50, vectors)
    for vector, (first, last) in zip(vectors, windows.tolist(), strict=True):
        window = frames[first : last + 1]
        mean_activities = [v.astype(np.float64) ** 4 for v in (vector, *model.pooled(window, [0]))]
        np.testing.assert_allclose(*mean_activities, rtol=3e-5, atol=2 / SCALE)


class Looking:
    """A model that notes at what its spotter looks."""

    def __init__(self, model: PyramidModel) -> None:
        self.model, self.seen = model, [(0, 0)]

    def pooled(self, frames: Sequence[Frame], firsts: Sequence[int]) -> np.ndarray:
        self.seen += [(frames[first].stamp_ns, frames[-1].stamp_ns) for first in firsts]
        return self.model.pooled(frames, firsts)


def test_training_counts_false_alarms_over_the_windows_that_the_live_search_looks_at(
    both: tuple[LabelledStream, list[Frame]],
) -> None:
    stream, frames = both
    model = spotting_model()
    assert model.heads is not None and model.metadata.spotting is not None
    metadata, looking = model.metadata.spotting, Looking(model)
    spotter = PyramidSpotter(looking.pooled, model.labels, SpottingModel(model.heads, metadata), SpottingOptions())
    for frame in frames:
        spotter.step(frame)
    durations_ns = np.rint(np.array(metadata.window_durations_s) * SECOND_NS).astype(np.int64)
    windows = live_windows(stream.stamps_ns, durations_ns, round(metadata.interval_s * SECOND_NS))
    expected = [(stream.stamps_ns[first], stream.stamps_ns[last]) for first, last in windows]
    assert len(expected) > 200
    assert sorted(looking.seen[1:]) == sorted(expected)


def test_segments_belong_to_the_stream_of_who_did_them(tmp_path: Path) -> None:
    """The second person stands behind and does nothing: a mark that names nobody is of the nearest."""
    of, still = scene(("lift", "push"), seed=5), scene((), seed=6)
    frames = []
    for i, each in enumerate(of.skeletons()):
        (actor,) = each.agents
        other = still.skeletons()[i % len(still.joints)].agents[0]
        behind = other.model_copy(update={"agent": 2, "joints": [[x, y, z + 1.0] for x, y, z in other.joints]})
        frames.append(each.model_copy(update={"agents": [actor, behind]}))
    streams = samples_from([recorded(tmp_path, "two", [*frames, *of.marks()])]).streams
    assert {stream.agent: stream.segments for stream in streams} == {1: tuple(bounds_ns(of.acts)), 2: ()}
    assert [len(stream.stamps_ns) for stream in streams] == [len(of.joints)] * 2


def test_an_overlap_is_the_common_time_over_the_time_of_both() -> None:
    starts_ns, ends_ns = np.array([0, 0, 5, 20, 0]), np.array([10, 5, 15, 30, 20])
    np.testing.assert_allclose(overlap_ratio(starts_ns, ends_ns, 0, 10), [1.0, 0.5, 1 / 3, 0.0, 0.5])


@given(seed=st.integers(0, 1000))
@settings(max_examples=20)
def test_training_windows_lie_within_the_stream_and_say_how_complete_each_action_is(seed: int) -> None:
    stream = taught().streams[seed % 2]
    drawn = training_windows(stream, LABELS, np.array([0.5, 1.0, 2.0]), np.random.default_rng(seed))
    first, last = drawn.frames.T
    assert (first >= 0).all() and (last < len(stream.stamps_ns)).all() and (last - first + 1 >= FEWEST_FRAMES).all()
    expected = np.zeros_like(drawn.completeness)
    for n, (a, b) in enumerate(zip(stream.stamps_ns[first], stream.stamps_ns[last], strict=True)):
        for start, end, label in stream.segments:
            iou = max(min(b, end) - max(a, start), 0) / (max(b, end) - min(a, start))
            action = LABELS.index(label)
            expected[n, action] = max(expected[n, action], completeness_of_iou(np.array(iou)))
    np.testing.assert_allclose(drawn.completeness, expected)
    assert (drawn.completeness == 1.0).sum() >= len(stream.segments)
    assert ((drawn.completeness == 0).all(axis=1)).sum() > 10
    assert (np.count_nonzero(drawn.completeness, axis=1) <= 1).mean() > 0.95


def test_a_stream_without_actions_gives_background_and_one_without_time_nothing() -> None:
    rng, stream = np.random.default_rng(0), replace(taught().streams[0], segments=())
    idle = training_windows(stream, LABELS, np.array([0.5, 1.0]), rng)
    assert len(idle.frames) >= 16 and not idle.completeness.any()
    short = replace(stream, stamps_ns=stream.stamps_ns[:3])
    assert training_windows(short, LABELS, np.array([0.5, 1.0]), rng).frames.shape == (0, 2)


def test_actions_that_the_model_does_not_know_are_background() -> None:
    stream = taught().streams[0]
    windows = np.array([[np.searchsorted(stream.stamps_ns, ns) for ns in stream.segments[0][:2]]])
    assert true_completeness(stream, windows, ["swing"]).tolist() == [[0.0]]
    assert true_completeness(stream, windows, ["swing", stream.segments[0][2]]).tolist() == [[0.0, 1.0]]


def windows_of(seed: int, n: int = 40) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.random((n, 60)).astype(np.float32), rng.random((n, 3)), rng.integers(0, 3, n)


def ridge(vectors: np.ndarray, targets: np.ndarray, mean: np.ndarray, penalty: float) -> tuple[np.ndarray, np.ndarray]:
    """By the normal equations of the primal form, about the mean of all windows."""
    x, y = vectors.astype(np.float64) - mean, targets - targets.mean(axis=0)
    axes = np.linalg.solve(x.T @ x + penalty * np.eye(x.shape[1]), x.T @ y)
    return axes, targets.mean(axis=0) - mean @ axes


@pytest.mark.parametrize("seed", range(3))
def test_heads_without_a_fold_are_those_fitted_on_the_rest(seed: int) -> None:
    vectors, targets, folds = windows_of(seed)
    mean, left_out = vectors.mean(axis=0, dtype=np.float64), [None, 0, 1, 2, 3]  # the last fold holds no window
    penalty = 0.4 * np.square(vectors - mean).sum(axis=1).mean()
    for fold, of_rest in zip(left_out, fit_heads(vectors, targets, folds, left_out, 0.4), strict=True):
        kept = folds != fold if fold is not None else folds >= 0
        axes, offsets = ridge(vectors[kept], targets[kept], mean, penalty)
        np.testing.assert_allclose(of_rest.axes, axes, atol=1e-4)
        np.testing.assert_allclose(of_rest.offsets, offsets, atol=1e-4)


def test_heads_without_the_only_fold_answer_nothing_and_equal_windows_their_mean() -> None:
    vectors, targets, _ = windows_of(0)
    (without,) = fit_heads(vectors, targets, np.zeros(40, np.intp), [0], 0.4)
    assert not without.axes.any() and not without.offsets.any()
    (same,) = fit_heads(np.ones((4, 6), np.float32), targets[:4], np.array([0, 1, 0, 1]), [None], 0.4)
    np.testing.assert_allclose(same.completeness(np.ones((1, 6), np.float32))[0], targets[:4].mean(axis=0), rtol=1e-5)


@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.0, 1.0))
@settings(max_examples=20, deadline=None)
def test_a_mixed_head_is_the_one_that_mixed_targets_give(seed: int, share: float) -> None:
    """Least squares are linear in what is to be answered."""
    rng = np.random.default_rng(seed)
    vectors, own = rng.normal(size=(30, 6)).astype(np.float32), rng.random((30, 3))
    folds = rng.integers(2, size=30)
    heads = mixed_heads(fit_heads(vectors, with_common(own), folds, [None], 0.1)[0], share)
    any_action = own.max(axis=1, keepdims=True)
    (expected,) = fit_heads(vectors, (1 - share) * own + share * any_action, folds, [None], 0.1)
    np.testing.assert_allclose(heads.axes, expected.axes, atol=1e-4)
    np.testing.assert_allclose(heads.offsets, expected.offsets, atol=1e-4)


@pytest.mark.parametrize(
    ("own", "common_in_background", "share"),
    [(0.2, 0.0, 0.5), (0.8, 0.9, 0.0)],
    ids=["only what is common tells actions from none", "it tells nothing"],
)
def test_the_share_of_the_common_head_is_the_one_with_which_most_is_found(
    own: float, common_in_background: float, share: float
) -> None:
    """One window a second, every third of them an action."""
    stamps_ns = np.arange(200) * SECOND_NS // 10
    frames = np.array([[10 * second, 10 * second + 9] for second in range(20)])
    done = {second: LABELS[second % len(LABELS)] for second in range(1, 18, 3)}
    segments = tuple((*stamps_ns[frames[second]].tolist(), label) for second, label in done.items())
    answers = [
        [*(own * (done.get(second) == label) for label in LABELS), 0.9 if second in done else common_in_background]
        for second in range(20)
    ]
    nothing = np.zeros((200, 15, 3))
    stream = LabelledStream(stamps_ns, np.zeros((200, 5)), nothing, nothing, segments, "somebody", "file", 1)
    scanned = ScannedStream(stream, frames, np.array(answers, np.float32))
    learned = SpottingModel(CompletenessHeads(np.zeros((1, 3), np.float32), np.zeros(3, np.float32)), METADATA)
    search = replace(TINY.spotting, common_shares=(0.0, 0.3, 0.5), thresholds=(0.45,))
    assert _chosen([scanned], learned, LABELS, replace(TINY, spotting=search))[0] == share


def test_a_logistic_regression_finds_the_slope_and_intercept_that_made_the_outcomes() -> None:
    rng = np.random.default_rng(0)
    answers = rng.uniform(-0.5, 1.5, 20_000)
    right = rng.random(20_000) < 1 / (1 + np.exp(-(5 * answers - 2)))
    assert logistic_fit(answers, right) == pytest.approx((5, -2), rel=0.05)


@pytest.mark.parametrize("right", [np.array([0, 0, 1, 1]), np.zeros(4), np.ones(4)], ids=["parted", "none", "all"])
def test_it_stays_finite_where_outcomes_are_parted_by_the_answers(right: np.ndarray) -> None:
    slope, intercept = logistic_fit(np.array([0.0, 0.1, 0.9, 1.0]), right.astype(bool))
    assert np.isfinite([slope, intercept]).all()


def taught_by(folder: Path, *scenes: list[Skeleton | Segment], people: int | None = None) -> Samples:
    named = [str(n % (people or len(scenes))) for n in range(len(scenes))]
    return samples_from([recorded(folder, f"{n}", each, named[n]) for n, each in enumerate(scenes)])


def shown(*actions: str, seed: int = 0) -> list[Skeleton | Segment]:
    of = scene(actions, seed)
    return [*of.skeletons(), *of.marks()]


def clip(action: str, seed: int) -> list[Skeleton | Segment]:
    """One action and not a frame before or after it."""
    skeletons, marks = performance([action], seed=seed)
    return [*skeletons[:20], *marks]


def spotting_of(samples: Samples) -> Model:
    return train_to_spot(samples.usable, samples.streams, TINY)


def reported(samples: Samples) -> list[tuple[str, int]]:
    """What a training reports: each stage, and how much of it is done."""
    stages: list[tuple[str, int]] = []
    train_to_spot(samples.usable, samples.streams, TINY, progress=lambda stage, done, _: stages.append((stage, done)))
    return stages


def found_in(model: Model, of: Scene) -> list[tuple[int, int, str]]:
    spotter = model.spotter(SpottingOptions())
    assert spotter is not None
    return [(s.start_ns, s.end_ns, s.label) for f in encoded_live(model, of) for s in spotter.step(f).segments]


def test_one_person_is_enough(tmp_path: Path) -> None:
    model = spotting_of(taught_by(tmp_path, shown(*LABELS * 3)))
    assert [label for *_, label in found_in(model, scene(seed=9))] == [act.action for act in scene(seed=9).acts]


def test_whole_clips_teach_a_search_that_says_that_it_has_seen_no_background(tmp_path: Path) -> None:
    clips = [clip(action, seed) for seed in range(4) for action in LABELS]
    model = spotting_of(taught_by(tmp_path, *clips, people=2))
    assert model.background_s == 0.0
    found_in(model, scene(seed=9))


def test_heads_are_trained_again_on_false_alarms_only_where_there_is_background(tmp_path: Path) -> None:
    clips = taught_by(tmp_path / "clips", *(clip(action, seed) for seed in range(4) for action in LABELS), people=2)
    streams = taught_by(tmp_path / "streams", *(shown(*LABELS * 2, seed=seed) for seed in range(2)))
    for samples, times in ((clips, 1), (streams, 2)):
        begun = [stage for stage, done in reported(samples) if stage == "windows of streams" and done == 0]
        assert len(begun) == times


def test_the_fewer_people_the_nearer_the_threshold_is_to_the_priors() -> None:
    high = replace(TINY, prior=replace(TINY.prior, threshold=0.9))
    own = replace(TINY, prior=replace(TINY.prior, threshold=0.9, people=1e-9))
    one = [replace(stream, person="the same") for stream in taught().streams]
    chosen = threshold_of(train_to_spot(taught().usable, taught().streams, own))
    assert threshold_of(train_to_spot(taught().usable, one, high)) == pytest.approx(0.9)
    two = threshold_of(train_to_spot(taught().usable, taught().streams, high))
    assert two == pytest.approx((4 * 0.9 + chosen) / 5, abs=1e-6)


def threshold_of(model: Model) -> float:
    assert isinstance(model, PyramidModel) and model.spotting is not None
    return model.spotting.threshold


def test_a_stream_without_any_action_is_background_alone() -> None:
    whole = taught().streams[0]
    idle = replace(whole, segments=(), person="idle", file="idle")
    before, model = (train_to_spot(taught().usable, streams, TINY) for streams in ([whole], [whole, idle]))
    lasts_s = (whole.stamps_ns[-1] - whole.stamps_ns[0]) / SECOND_NS
    assert before.background_s is not None
    assert model.background_s == pytest.approx(before.background_s + lasts_s)


@pytest.mark.parametrize("streams", ["none", "no actions", "three frames"])
def test_without_a_stream_that_shows_an_action_a_model_answers_marks_alone(streams: str) -> None:
    whole = taught().streams[0]
    short = replace(whole, stamps_ns=whole.stamps_ns[:3], segments=())
    given_ = {"none": [], "no actions": [replace(whole, segments=())], "three frames": [short]}[streams]
    model = train_to_spot(taught().usable, given_, TINY)
    assert model.spotter(SpottingOptions()) is None and model.background_s is None


def test_a_single_action_is_too_little_and_said_to_be(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match="two"):
        spotting_of(taught_by(tmp_path, shown(*["lift"] * 6)))


def test_an_action_shown_once_beside_another_is_enough(tmp_path: Path) -> None:
    model = spotting_of(taught_by(tmp_path, shown("lift", "push", "lift", "lift")))
    assert model.spotter(SpottingOptions()) is not None


def test_a_person_who_is_seen_too_shortly_for_any_window_spoils_nothing(tmp_path: Path) -> None:
    """Also where that person is the last of as many as there are folds."""
    samples = taught_by(tmp_path, shown(*LABELS * 2), shown(*LABELS * 2, seed=2))
    whole = samples.streams[0]
    n = 22
    brief = replace(
        whole, person="z", segments=(), stamps_ns=whole.stamps_ns[:n], motion=whole.motion[:n],
        postures=whole.postures[:n], velocities=whole.velocities[:n],
    )  # fmt: skip
    model = train_to_spot(
        samples.usable, [*samples.streams, brief], replace(TINY, spotting=replace(TINY.spotting, folds=3))
    )
    assert model.spotter(SpottingOptions()) is not None


def test_streams_with_a_gap_in_every_action_teach_no_search(tmp_path: Path) -> None:
    """A live search looks across no gap, so that nobody can say what its answers would mean."""
    whole = replace(TINY, spotting=replace(TINY.spotting, windows=1))
    skeletons, marks = performance(LABELS * 2)
    frames = [each for n, each in enumerate(skeletons) if n % 25 in (0, 1, 18, 19)]
    samples = taught_by(tmp_path, [*frames, *marks])
    assert (np.diff(samples.streams[0].stamps_ns) > GAP_NS).sum() == 6 and len(samples.usable) == 6
    assert train_to_spot(samples.usable, samples.streams, whole).spotter(SpottingOptions()) is None


def test_presets_that_have_no_search_train_as_ever() -> None:
    model = train_to_spot(taught().usable, taught().streams, TINY_PAPER)
    assert model.spotter(SpottingOptions()) is None


def test_the_same_streams_and_seed_make_the_same_search() -> None:
    again = train_to_spot(taught().usable, taught().streams, TINY)
    assert again.id == spotting_model().id
    assert train_to_spot(taught().usable, taught().streams, TINY, seed=1).id != again.id


def test_what_is_answered_to_marks_is_that_of_a_model_without_a_search() -> None:
    without = train_to_spot(taught().usable, [], TINY)
    with_search = spotting_model().arrays
    assert set(with_search) - set(without.arrays) == {"completeness_axes", "completeness_offsets"}
    for name, array in without.arrays.items():
        np.testing.assert_array_equal(array, with_search[name])
