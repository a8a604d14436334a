"""The node answers as its model does, whichever kind that is, and whenever it came."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from actum.messages import Action, Message, Posture, Segment, Skeleton
from actum.node import Tick, replay
from actum.skeletons import INDEX
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.samples import SegmentSample
from people import FRAME_NS, lacking, skeleton
from performers import FRAMES, HAND_PATHS, PAUSE_FRAMES, TINY, TINY_OF_EACH_KIND, TINY_PAPER, mark, performance
from pose_preprocessor.bridging import BRIDGED_NS
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model, tiny_samples
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.node import POLL_TICKS, SomClassifier
from som_classifier.presets import Preset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.search import NO_SEARCH, Search
from som_classifier.stream import Stream
from spotters import Box
from wire import Wire, without_seq

each_preset = pytest.mark.parametrize("preset", TINY_OF_EACH_KIND, ids=lambda preset: preset.name)
SAMPLES = tiny_samples()
BESIDE_M = np.array([1.0, 0.0, 1.0])


def postures_of(skeletons: Iterable[Message]) -> list[Posture]:
    node = PosePreprocessor(PoseSettings.defaults())
    return [p for frame in skeletons for p in node.handle(frame) if isinstance(p, Posture)]


def scene() -> list[Message]:
    """What the samples were cut out of: each mark where it belongs."""
    skeletons, marks = performance([*HAND_PATHS] * 2)
    unlabelled = [each.model_copy(update={"label": None}) for each in marks]
    return sorted([*postures_of(skeletons), *unlabelled], key=lambda m: (m.stamp_ns, not starts(m), ends(m)))


def starts(message: Message) -> bool:
    return isinstance(message, Segment) and message.kind == "start"


def ends(message: Message) -> bool:
    return isinstance(message, Segment) and message.kind == "end"


def live(node: SomClassifier, messages: Iterable[Message | Tick]) -> list[Action]:
    """Message by message, through bytes, as a service gets them."""
    wire = Wire(node)
    put = [output for m in messages for output in (wire.handle(m) if isinstance(m, Tick) else wire.send(m))]
    return [action for action in put if isinstance(action, Action)]


@cache
def always(preset: Preset) -> list[Action]:
    """What a node with the model from the start says of the scene."""
    return live(SomClassifier(tiny_model(preset)), scene())


def finals(actions: Iterable[Action]) -> list[Action]:
    return [action for action in actions if action.final]


@each_preset
def test_live_and_replayed_it_puts_the_same_to_the_last_bit(preset: Preset) -> None:
    replayed = list(replay(SomClassifier(tiny_model(preset)), [(m.stamp_ns, m) for m in scene()]))
    assert len(finals(m for m in replayed if isinstance(m, Action))) == len(SAMPLES)
    assert without_seq(replayed) == without_seq([*always(preset)])


@each_preset
def test_final_answers_are_those_of_the_model_to_the_sample(preset: Preset) -> None:
    """To the last bit: what training sees is what runs."""
    model = tiny_model(preset)
    answers = finals(always(preset))
    for action, sample in zip(answers, SAMPLES, strict=True):
        expected = answer(model, encoded(model, sample))
        assert (action.action, action.activations, action.part) == (expected.label, expected.activations, expected.part)
        assert (action.confidence, action.familiarity) == (expected.confidence, expected.familiarity)
        assert (action.unknown, action.missing_joints, action.frames) == (expected.unknown, [], FRAMES)


@each_preset
def test_each_frame_from_the_third_on_has_its_estimate(preset: Preset) -> None:
    model = tiny_model(preset)
    estimates = [action for action in always(preset) if not action.final]
    assert len(estimates) == len(SAMPLES) * (FRAMES - model.min_frames + 1)
    for sample in SAMPLES[:3]:
        frames = encoded(model, sample)
        own = [action for action in estimates if action.segment_id == sample.segment_id]
        for count, action in enumerate(own, start=model.min_frames):
            expected = model.recognise(frames[:count], complete=False)
            assert (action.activations, action.confidence) == (expected.activations, expected.confidence)
            assert (action.frames, action.unknown, action.familiarity) == (count, False, None)


def test_a_segment_is_answered_once_after_its_last_estimate() -> None:
    actions = always(TINY)
    for number in range(len(SAMPLES)):
        assert [a.final for a in actions if a.segment_id == str(number)] == [False] * (FRAMES - 2) + [True]


@each_preset
def test_maps_and_trace_come_with_final_answers_where_asked_for(preset: Preset) -> None:
    model = tiny_model(preset)
    for action in live(SomClassifier(model, publish_maps=True), scene()):
        assert (action.maps is not None, action.trace is not None) == (action.final, action.final)
        for tensor in (action.maps or {}).values():
            assert len(tensor.data) == 4 * np.prod(tensor.shape)
    expected = model.maps(encoded(model, SAMPLES[-1]))
    assert action.maps is not None
    for name, activities in expected.items():
        put = np.frombuffer(action.maps[name].data, action.maps[name].dtype).reshape(action.maps[name].shape)
        np.testing.assert_array_equal(put, activities.astype(np.float32))
    assert all(action.maps is action.trace is None for action in always(preset))


def frames_of(model: Model, postures: Sequence[Posture]) -> list[Frame]:
    stream = Stream(lambda: model.encoder().encode, Search(postures[0], NO_SEARCH))
    return [frame for posture in postures if (frame := stream.add(posture)[1]) is not None]


def test_an_end_before_the_usual_time_ends_the_action_all_the_same() -> None:
    """The final answer is to a whole segment, the estimate of the same frames to a part of one."""
    start, _, *postures = gappy([], slice(0))
    end = mark("end", 9 * FRAME_NS, start.segment_id)
    *_, estimate, final = live(SomClassifier(tiny_model()), [start, *postures[:10], end])
    frames = frames_of(tiny_model(), postures[:10])
    expected = [tiny_model().recognise(frames, complete) for complete in (False, True)]
    assert estimate.frames == final.frames == 10
    assert [action.activations for action in (estimate, final)] == [found.activations for found in expected]
    assert estimate.activations != final.activations


@each_preset
@pytest.mark.parametrize(("seen", "to_its_end"), [(30, False), (50, True)], ids=["half", "nearly all"])
def test_of_somebody_who_leaves_in_the_middle_the_beginning_of_an_action_is_judged(
    preset: Preset, seen: int, to_its_end: bool
) -> None:
    model, (skeletons, marks) = tiny_model(preset), performance(["lift"], frames=60)
    whole = postures_of(skeletons)
    left = postures_of(skeleton(frame.stamp_ns) for frame in skeletons[seen:])
    messages = [*marks[:1], *whole[:seen], *left, *marks[1:]]
    *_, final = finals(replay(SomClassifier(model), [(m.stamp_ns or 0, m) for m in messages]))
    expected = model.recognise(frames_of(model, whole[:seen]), to_its_end)
    assert (final.valid, final.frames, final.action) == (True, seen, expected.label)
    assert (final.confidence, final.familiarity) == (expected.confidence, expected.familiarity)


def test_what_is_unfamiliar_is_told_at_the_end() -> None:
    model = tiny_model()
    assert isinstance(model, PyramidModel)
    strict = replace(model, verifier=replace(model.verifier, least_likeness=1e9))
    actions = live(SomClassifier(strict), scene())
    assert [action.unknown for action in actions] == [action.final for action in actions]
    assert all((action.familiarity is None) != action.final for action in actions)


class Reload:
    """A scene in the midst of which a node gets another model."""

    def __init__(self, at: int, model: Model, first: Model | None) -> None:
        box = Box()
        node = SomClassifier(first, box)
        self.before = live(node, scene()[:at])
        box.model = model
        for tick in range(POLL_TICKS):
            assert list(node.handle(Tick(tick))) == []
        self.after = live(node, scene()[at:])


@pytest.mark.thorough
@pytest.mark.parametrize("first", [None, TINY, TINY_PAPER], ids=["none", "tiny", "tiny paper"])
@each_preset
@pytest.mark.parametrize("at", [1, 12, 33])
def test_a_new_model_answers_an_open_segment_as_if_it_had_been_there_from_the_start(
    at: int, preset: Preset, first: Preset | None
) -> None:
    """To the last bit: the frames remembered are read anew."""
    reload = Reload(at, tiny_model(preset), tiny_model(first) if first else None)
    assert len(reload.after) > len(SAMPLES)
    assert without_seq([*reload.after]) == without_seq([*always(preset)[-len(reload.after) :]])


def test_until_there_is_a_model_segments_are_refused_and_then_recognised() -> None:
    reload = Reload(30, tiny_model(), None)
    assert [(a.final, a.reason) for a in reload.before] == [(True, "no model")]
    assert [a.reason for a in finals(reload.after)] == [None] * 5


def gappy(names: Sequence[str], frames: slice) -> list[Message]:
    """A push with some joints missing in some frames."""
    skeletons, marks = performance(["push"])
    within = range(FRAMES)[frames]
    shown = [
        skeleton(i * FRAME_NS, lacking(joints, *names) if i in within else joints)
        for i, joints in enumerate(joints_of(skeletons))
    ]
    start, end = (each.model_copy(update={"label": None}) for each in marks)
    return [start, end, *postures_of(shown)]


@each_preset
def test_missing_joints_are_named_in_their_usual_order(preset: Preset) -> None:
    """From when on they are away for longer than is bridged."""
    actions = live(SomClassifier(tiny_model(preset)), gappy(["right_foot", "head", "left_foot"], slice(4, 18)))
    names, gone = ["head", "left_foot", "right_foot"], 4 + BRIDGED_NS // FRAME_NS
    assert [a.missing_joints for a in actions] == [[]] * (gone - 2) + [names] * (FRAMES - gone)
    assert actions[-1].final
    assert (actions[-1].action, actions[-1].frames) == ("push", FRAMES)


@each_preset
def test_what_hangs_on_a_missing_joint_is_missing_with_it(preset: Preset) -> None:
    actions = live(SomClassifier(tiny_model(preset)), gappy(["left_elbow"], slice(0, FRAMES)))
    assert actions[-1].missing_joints == ["left_elbow", "left_hand"]
    assert actions[-1].valid


@each_preset
@pytest.mark.parametrize(
    "names", [["right_hand"], ["right_elbow"], ["left_hip", "right_hip"], ["left_shoulder", "right_shoulder"]]
)
def test_whatever_is_missing_gets_an_answer(preset: Preset, names: list[str]) -> None:
    for frames in (slice(0, FRAMES), slice(5, 15), slice(0, FRAMES, 2)):
        (final,) = finals(live(SomClassifier(tiny_model(preset)), gappy(names, frames)))
        assert (final.valid, final.frames) == (True, FRAMES)


@each_preset
@pytest.mark.parametrize("fields", [("joints",), ("upright",), ("joints", "upright")])
def test_a_posture_without_any_joint_is_none(preset: Preset, fields: tuple[str, ...]) -> None:
    node = SomClassifier(tiny_model(preset))
    start, end, *postures = gappy([], slice(0))
    marks = [each.model_copy(update={"agent": 1}) for each in (start, end)]
    blank = [p.model_copy(update=dict.fromkeys(fields, [None] * 15)) for p in postures]
    (final,) = finals(live(node, [*marks, *blank]))
    assert (final.reason, final.frames) == ("no usable frame", 0)
    assert node.counters.rejects["bad_posture"] == FRAMES + PAUSE_FRAMES


@each_preset
def test_joints_that_come_and_go_far_from_the_action_change_no_label(preset: Preset) -> None:
    for sample in (SAMPLES[0], SAMPLES[1]):
        hidden = some_lacking(sample, "left_foot", "left_knee", "right_foot")
        assert answer(tiny_model(preset), encoded(tiny_model(preset), hidden)).label == sample.label


def some_lacking(sample: SegmentSample, *names: str) -> SegmentSample:
    """Every other frame without some joints."""
    gone = np.zeros((FRAMES, 15, 1), dtype=bool)
    gone[::2, [INDEX[name] for name in names]] = True
    fields = ("joints", "postures", "velocities")
    return replace(sample, **{name: np.where(gone, np.nan, getattr(sample, name)) for name in fields})


@each_preset
def test_two_people_are_answered_as_if_each_were_alone(preset: Preset) -> None:
    (swinging, marks), (pushing, _) = performance(["swing"], seed=3), performance(["push"])
    pairs = zip(joints_of(swinging), joints_of(pushing), strict=True)
    both = postures_of(skeleton(i * FRAME_NS, one, other + BESIDE_M) for i, (one, other) in enumerate(pairs))
    of_each = {
        agent: [each.model_copy(update={"agent": agent, "segment_id": f"{agent}", "label": None}) for each in marks]
        for agent in (1, 2)
    }
    together = finals(live(SomClassifier(tiny_model(preset)), [*of_each[1], *of_each[2], *both]))
    for agent, own_marks in of_each.items():
        own = [posture for posture in both if posture.agent == agent]
        expected = finals(live(SomClassifier(tiny_model(preset)), [*own_marks, *own]))
        assert without_seq([a for a in together if a.agent == agent]) == without_seq([*expected])
    assert {a.agent: a.action for a in together} == {1: "swing", 2: "push"}


def joints_of(skeletons: Iterable[Skeleton]) -> list[np.ndarray]:
    return [np.array(frame.agents[0].joints, dtype=np.float64) for frame in skeletons]
