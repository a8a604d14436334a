"""The search itself, with heads whose answers are written down: what is told when, from where to where."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
import pytest
from numpy.typing import NDArray

from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.spotting.pyramid_spotter import PyramidSpotter
from som_classifier.spotting.spotted import NOTHING, Ongoing, Spotted, SpottedSegment, SpottingOptions
from som_classifier.spotting.spotting_model import CompletenessHeads, PyramidSpottingMetadata, SpottingModel

MS = SECOND_NS // 1000
Answers = Mapping[tuple[int, int], float]
"""What the head of `wave` answers to windows, by their first and last stamp (ms); 0 to all others."""
METADATA = PyramidSpottingMetadata(
    interval_s=0.1, lag_s=0.2, overlap=0.15, duration_weight=0.0, window_durations_s=[0.5, 1.0],
    log_duration_means=[0.0], log_duration_sds=[0.3], thresholds=[0.5], false_alarms_per_min=[], recalls=[1.0],
    precisions=[1.0], threshold=0.5, probability=[8.0, -4.0], background_s=60.0,
)  # fmt: skip


class Scripted:
    """A model of one action whose pyramid vector is the answer itself."""

    def __init__(self, answers: Answers) -> None:
        self._answers = answers

    def pooled(self, frames: Sequence[Frame], firsts: Sequence[int]) -> NDArray[np.float32]:
        bounds = [(frames[first].stamp_ns // MS, frames[-1].stamp_ns // MS) for first in firsts]
        return np.array([[self._answers.get(each, 0.0)] for each in bounds], np.float32)


def spotted(
    answers: Answers,
    stamps_ms: Iterable[int],
    invalid: Iterable[int] = (),
    durations_s: Sequence[float] = (0.5, 1.0),
    learned: Mapping[str, list[float]] = MappingProxyType({}),
    accepted_per_min: float | None = None,
) -> list[Spotted]:
    """What each frame shows; those with stamps among `invalid` hold no posture."""
    heads = CompletenessHeads(np.eye(1, dtype=np.float32), np.zeros(1, np.float32))
    metadata = METADATA.model_copy(update={"window_durations_s": [*durations_s], **learned})
    options = SpottingOptions(accepted_per_min)
    spotter = PyramidSpotter(Scripted(answers).pooled, ["wave"], SpottingModel(heads, metadata), options)
    lost = set(invalid)
    return [
        spotter.step(Frame(ms * MS, None, (1,), 0, 2.0, None if ms in lost else np.zeros((15, 3)), np.zeros(5)))
        for ms in stamps_ms
    ]


def told(answers: Answers, stamps_ms: Sequence[int], **more: object) -> list[tuple[int, int, int]]:
    """Stamp (ms) of the frame with which each segment is told, and its bounds."""
    shown = zip(stamps_ms, spotted(answers, stamps_ms, **more), strict=True)  # type: ignore[arg-type]
    segments = [(now, segment) for now, each in shown for segment in each.segments]
    assert all(segment.label == "wave" for _, segment in segments)
    return [(now, segment.start_ns // MS, segment.end_ns // MS) for now, segment in segments]


WAVE = {(1000, 2000): 0.9}
TENTHS = list(range(0, 4001, 100))


def test_an_action_is_told_with_its_bounds_when_the_lag_is_over() -> None:
    assert told(WAVE, TENTHS) == [(2200, 1000, 2000)]


@pytest.mark.parametrize("late_ms", [0, 10, 33, 66, 99])
def test_a_decision_that_comes_a_little_after_the_lag_cuts_nothing_off(late_ms: int) -> None:
    """At ten decisions a second each may."""
    assert told(WAVE, [*range(0, 2001, 100), *range(2100 + late_ms, 4001, 100)]) == [(2200 + late_ms, 1000, 2000)]


@pytest.mark.parametrize("next_ms", [2201, 2300, 2499, 2500])
def test_frames_lost_before_the_decision_cut_nothing_off(next_ms: int) -> None:
    assert told(WAVE, [*range(0, 2001, 100), *range(next_ms, 4001, 100)]) == [(next_ms, 1000, 2000)]


def test_one_that_waited_for_others_is_told_whole() -> None:
    """A second, worth more, hides the first; a third, which hides the second, brings it back."""
    answers = {(1000, 2000): 0.9, (1850, 2100): 2.2}
    stamps_ms = list(range(0, 4001, 50))
    assert told(answers, stamps_ms, durations_s=(0.25, 1.0)) == [(2300, 1850, 2100)]
    assert told(answers | {(2050, 2300): 1.5}, stamps_ms, durations_s=(0.25, 1.0)) == [
        (2300, 1000, 2000), (2500, 2050, 2300),
    ]  # fmt: skip


def test_after_a_gap_nothing_is_told_of_what_went_on_before_it() -> None:
    assert told(WAVE, [*range(0, 2101, 100), *range(2700, 5001, 100)]) == []
    assert told(WAVE | {(3700, 4700): 0.9}, [*range(0, 2101, 100), *range(2700, 5001, 100)]) == [(4900, 3700, 4700)]


def test_half_a_second_of_invalid_frames_is_no_gap_and_a_longer_one_is() -> None:
    assert told(WAVE, TENTHS, invalid=range(2001, 2401)) == [(2500, 1000, 2000)]
    assert told(WAVE, TENTHS, invalid=range(2001, 2501)) == []


def test_while_the_heads_say_so_an_action_is_going_on_until_they_do_not() -> None:
    beginning = {(2000, 2500): 0.5, (1600, 2600): 0.6, (2100, 2600): 0.2}
    shown = spotted(beginning, TENTHS)
    ongoing = {ms: each.ongoing for ms, each in zip(TENTHS, shown, strict=True) if each.ongoing is not None}
    assert list(ongoing) == [2500, 2600]
    assert ongoing[2600] == Ongoing(1600 * MS, "wave", pytest.approx(1 / (1 + np.exp(-0.8))), pytest.approx(0.61))


def test_between_two_decisions_the_same_is_going_on() -> None:
    stamps_ms = list(range(0, 3001, 50))
    shown = spotted({(2000, 2500): 0.5}, stamps_ms)
    assert [ms for ms, each in zip(stamps_ms, shown, strict=True) if each.ongoing] == [2500, 2550]


def test_of_frames_that_hold_no_posture_nothing_is_said() -> None:
    shown = spotted({(2000, 2500): 0.5}, TENTHS, invalid=range(2501, 3501))
    assert [ms for ms, each in zip(TENTHS, shown, strict=True) if each.ongoing] == [2500]
    assert all(each == NOTHING for each in shown[26:])


def test_where_too_few_frames_are_left_to_look_at_nothing_goes_on() -> None:
    """Frames are lost, though without a gap."""
    stamps_ms = [*range(0, 2501, 100), 2990, 3040, 3080]
    shown = spotted({(2000, 2500): 0.5}, stamps_ms, durations_s=[0.5])
    assert [ms for ms, each in zip(stamps_ms, shown, strict=True) if each.ongoing] == [2500]


def test_what_was_decided_is_not_going_on_any_more() -> None:
    shown = spotted(WAVE | {(1300, 2300): 0.9}, TENTHS)
    assert [ms for ms, each in zip(TENTHS, shown, strict=True) if each.ongoing] == [2000]
    assert [each.segments for each in shown if each.segments] == [(SpottedSegment(1000 * MS, 2000 * MS, "wave"),)]


@pytest.mark.parametrize(("accepted_per_min", "precision"), [(None, 0.6), (1.0, 0.6), (0.1, 0.9)])
def test_what_is_found_says_how_often_an_action_is_done_in_what_the_threshold_in_use_finds(
    accepted_per_min: float | None, precision: float
) -> None:
    counted = {"thresholds": [0.5, 0.7], "false_alarms_per_min": [1.0, 0.1], "precisions": [0.6, 0.9]}
    shown = spotted(WAVE, TENTHS, learned=counted, accepted_per_min=accepted_per_min)
    assert [segment.precision for each in shown for segment in each.segments] == [precision]


@pytest.mark.parametrize(("accepted_per_min", "is_found"), [(1.0, True), (0.1, False)])
def test_how_many_false_alarms_are_accepted_may_be_changed_in_the_middle_of_an_action(
    accepted_per_min: float, is_found: bool
) -> None:
    counted = {"false_alarms_per_min": [1.0, 0.1], "recalls": [1.0, 0.5], "precisions": [1.0, 1.0]}
    metadata = METADATA.model_copy(update={"thresholds": [0.5, 0.95], **counted})
    learned = SpottingModel(CompletenessHeads(np.eye(1, dtype=np.float32), np.zeros(1, np.float32)), metadata)
    spotter = PyramidSpotter(Scripted(WAVE).pooled, ["wave"], learned, SpottingOptions())
    shown = []
    for ms in TENTHS:
        if ms == 1500:
            spotter.use(SpottingOptions(accepted_per_min))
        shown += spotter.step(Frame(ms * MS, None, (1,), 0, 2.0, np.zeros((15, 3)), np.zeros(5))).segments
    assert [(each.start_ns // MS, each.end_ns // MS) for each in shown] == [(1000, 2000)] * is_found
