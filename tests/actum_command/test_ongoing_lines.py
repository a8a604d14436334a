"""What people are doing right now is one line each, which goes when it is over."""

from rich.console import Console

from actum.messages import Action
from actum_command.describing import STALE_S, OngoingLines, describe
from empty_messages import action, skeleton


class Clock:
    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def shown(lines: OngoingLines) -> list[str]:
    console = Console(width=80, highlight=False)
    with console.capture() as capture:
        console.print(lines)
    return [line.rstrip() for line in capture.get().splitlines() if line.strip()]


def going(completeness: float | None, agent: int = 1, name: str = "lift", segment_id: str = "auto-1") -> Action:
    fields = {"completeness": completeness, "agent": agent, "action": name, "confidence": 0.87}
    return action(1, None, segment_id, final=False).model_copy(update=fields)


def test_the_newest_of_each_person_shows_how_far_it_is() -> None:
    lines = OngoingLines(Clock())
    for message in (going(0.2), skeleton(1), going(0.1, agent=2, name="[b]wave"), going(0.62), None):
        lines.receive(message)
    assert shown(lines) == ["agent 1: lift 62 % ▆▆▆▁▁ 0.87", "agent 2: [b]wave 10 % ▁▁▁▁▁ 0.87"]


def test_where_the_model_cannot_tell_how_far_it_is_nothing_is_said_of_it() -> None:
    lines = OngoingLines(Clock())
    lines.receive(going(None))
    assert shown(lines) == ["agent 1: lift 0.87"]


def test_a_line_goes_with_the_answer_and_when_nothing_more_is_heard() -> None:
    clock = Clock()
    lines = OngoingLines(clock)
    lines.receive(going(0.9))
    lines.receive(action(1, 2, "another"))
    assert shown(lines)
    lines.receive(action(1, 2, "auto-1"))
    assert not shown(lines)
    lines.receive(going(0.9))
    clock.now_s += STALE_S
    assert not shown(lines)


def test_a_partial_action_in_a_line_of_its_own_says_how_far_it_is_too() -> None:
    assert describe(going(1.3)) == "auto-1 so far: lift 100 % ▆▆▆▆▆ 0.87, 1 frames"
    assert describe(going(None)) == "auto-1 so far: lift 0.87, 1 frames"


def test_a_final_action_that_may_be_none_of_those_trained_is_said_to_be_unknown() -> None:
    said = describe(action(1, 2, "s").model_copy(update={"action": "lift", "confidence": 0.41, "unknown": True}))
    assert said == "s final: unknown, most like lift 0.41, 1 frames"
