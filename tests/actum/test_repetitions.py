import pytest

from actum.codec import encode
from actum.messages import Message, Segment
from actum.runtime import step_service
from actum.runtime.step_service import Repetitions
from scenes import action


def has(repetitions: Repetitions, message: Message) -> bool:
    return repetitions.has(message, encode(message).payload)


def test_an_answer_that_is_the_same_byte_for_byte_is_a_repetition() -> None:
    known = Repetitions()
    first = action("push", seq=3)
    assert [has(known, first), has(known, first), has(known, first.model_copy(update={"seq": 4}))] == [
        False, True, False,
    ]  # fmt: skip


@pytest.mark.parametrize(
    "message",
    [
        action("push"),
        action("push", final=False, seq=3),
        Segment(sensor="kinect0", kind="start", segment_id="a", seq=3),
    ],
    ids=["without a number", "partial", "a mark"],
)
def test_others_are_handed_on_each_time(message: Message) -> None:
    known = Repetitions()
    assert [has(known, message), has(known, message)] == [False, False]


def test_the_last_ones_are_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(step_service, "REMEMBERED", 2)
    known = Repetitions()
    numbered = [action("push", seq=seq) for seq in range(3)]
    assert [has(known, each) for each in numbered] == [False] * 3
    assert [has(known, each) for each in (numbered[2], numbered[0])] == [True, False]
