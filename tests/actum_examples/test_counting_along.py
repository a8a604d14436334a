"""Repetitions are counted while they are done, until the take ends by itself."""

from collections.abc import Iterator

import pytest

from actum.messages import Skeleton, Truth
from actum.node import SECOND_NS
from actum_examples.cutting.counting import RepetitionCounter
from repeating import Stream, five_waves, rest
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.settings import Settings

ACTOR = 20
"""A simulated person whom the sensor sees with more noise than most."""
WAIT_FRAMES = 150
LONGEST_FRAMES = 1800


def performed(action: str, times: int) -> Iterator[Skeleton | Truth]:
    """Yield what the simulated person does: stand for five seconds, act, and stand again."""
    simulator = DrivenSimulator(Settings(driven=True, actor=ACTOR, seed=ACTOR, image_hz=0), SECOND_NS)
    for number, messages in zip(range(LONGEST_FRAMES), simulator.frames(), strict=False):
        yield from (message for message in messages if isinstance(message, Skeleton | Truth))
        if number == WAIT_FRAMES and times:
            simulator.commands[0].obey({"actions": [action] * times, "object_id": 1})


def counted_along(messages: Iterator[Skeleton | Truth], asked: int) -> tuple[RepetitionCounter, list[int]]:
    """Count until the take ends by itself, or the messages do; return the counter, and the middles of the actions."""
    counter, marks_ns = RepetitionCounter(asked), list[int]()
    for message in messages:
        if isinstance(message, Truth):
            marks_ns.append(message.stamp_ns)
        elif counter.receive(message) and counter.finished:
            break
    return counter, [(start + end) // 2 for start, end in zip(marks_ns[::2], marks_ns[1::2], strict=False)]


@pytest.mark.parametrize(("action", "asked"), [("pull", 5), ("point", 5), ("point", 1)])
def test_what_the_simulated_person_does_ends_its_take_with_the_right_number(action: str, asked: int) -> None:
    counter, middles_ns = counted_along(performed(action, asked), asked)
    assert counter.finished
    cuts = counter.cuts()
    assert cuts is not None and len(middles_ns) == asked
    for each, middle_ns in zip(cuts.repetitions, middles_ns, strict=True):
        assert each.start_ns <= middle_ns <= each.end_ns


@pytest.mark.thorough
def test_where_the_simulated_person_only_stands_nothing_is_counted_and_that_is_explained() -> None:
    counter, _ = counted_along(performed("", 0), 5)
    assert (counter.count, counter.finished, counter.cuts()) == (0, False, None)
    assert "the movement was no larger than the noise" in counter.why_none


def test_five_of_five_are_not_doubted_though_another_number_might_explain_them() -> None:
    counter = RepetitionCounter(5)
    for each in five_waves().then(rest(4)).skeletons(noise_m=0.015):
        counter.receive(each)
    cuts = counter.cuts()
    assert cuts is not None and len(cuts.repetitions) == 5
    assert [doubt for doubt in cuts.doubted if doubt.repetition is None] == []


@pytest.mark.parametrize("noise_m", [0.003, 0.01, 0.02])
def test_stillness_is_no_repetition_however_noisy_the_sensor(noise_m: float) -> None:
    counter = RepetitionCounter(3)
    for each in Stream().then(rest(20)).skeletons(noise_m):
        counter.receive(each)
    assert counter.cuts() is None
