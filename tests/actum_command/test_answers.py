"""The switch on the keyboard shows what its own actions were answered with."""

from collections.abc import Iterator

import pytest
from rich.text import Text
from typer.testing import CliRunner

from actum import keys
from actum.messages import Action, Event, Message, Segment
from actum.runtime import Received
from actum_command.__main__ import app
from actum_command.commands import segment_commands
from empty_messages import action
from events import event


class Stream:
    """A subscription that hears what it is told."""

    def __init__(self) -> None:
        self.coming: list[Message] = []

    def receive(self) -> Received | None:
        if not self.coming:
            return None
        message = self.coming.pop(0)
        return Received(keys.key_of(message), message, None, 0)


class Live:
    """A client whose end marks are answered by what `answer` makes of their segment."""

    sensor, run = "kinect0", "now"

    def __init__(self) -> None:
        self.streams: dict[str, Stream] = {}
        self.put_marks: list[Segment] = []
        self.answered_by: dict[int, list[type[Message]]] = {}

    def __enter__(self) -> "Live":
        return self

    def __exit__(self, *_: object) -> None: ...

    def listen(self, pattern: str) -> Stream:
        return self.streams.setdefault(pattern.split("/")[2], Stream())

    def wait_for_subscriber(self, *_: object) -> bool:
        return True

    def put(self, mark: Segment) -> None:
        self.put_marks.append(mark)
        if mark.kind == "end":
            self.answer(mark.segment_id, *self.answered_by.get(len(self.put_marks) // 2, [Action, Event]))

    def answer(self, segment_id: str, *kinds: type[Message]) -> None:
        if Action in kinds:
            partial = action(1, None, segment_id, final=False).model_copy(update={"action": "pull"})
            self.streams["action"].coming += [partial, action(1, 2, segment_id)]
        if Event in kinds:
            self.streams["event"].coming += [event("other", "of another's segment"), event(segment_id, "push cup")]


@pytest.fixture
def live(monkeypatch: pytest.MonkeyPatch) -> Iterator[Live]:
    client = Live()
    monkeypatch.setattr(segment_commands, "connect", lambda: client)
    monkeypatch.setattr(segment_commands, "ANSWER_S", 0.1)
    return client


def toggled(presses: int) -> str:
    done = CliRunner().invoke(app, ["segment", "toggle"], input="\n" * presses)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_each_action_is_followed_by_its_own_event(live: Live) -> None:
    said = toggled(4)
    assert "toggle-now-1: push cup" in said
    assert "toggle-now-2: push cup" in said
    assert said.index("toggle-now-1: push cup") < said.index("start toggle-now-2")
    assert "another's" not in said
    assert "pull" not in said


def test_a_rejected_action_says_why(live: Live) -> None:
    live.answered_by[1] = []
    live.listen("actum/kinect0/event/*").coming.append(event("toggle-now-1", "", reason="no person"))
    assert "toggle-now-1 rejected: no person" in toggled(2)


def test_without_the_fusion_the_final_action_is_said(live: Live) -> None:
    live.answered_by[1] = [Action]
    assert "toggle-now-1 final: push 1.00, 1 frames; no event arrived: check that action_fusion runs" in toggled(2)


def test_where_no_answer_comes_it_is_said_and_the_switch_goes_on(live: Live) -> None:
    live.answered_by[1] = []
    said = toggled(4)
    assert "toggle-now-1: no answer within 0.1 s: run 'actum doctor'" in said
    assert "toggle-now-2: push cup" in said


def test_who_does_not_wait_is_told_with_the_next_answer(live: Live) -> None:
    switch = segment_commands.Answers(live)  # type: ignore[arg-type]
    assert list(switch.until("a", interrupted=lambda: True)) == []
    live.answer("a", Event)
    live.answer("b", Event)
    told = switch.until("b", interrupted=lambda: False)
    assert [Text.from_markup(line).plain for line in told] == ["a: push cup", "b: push cup"]


def test_an_action_that_is_left_open_is_ended_and_answered(live: Live) -> None:
    assert "toggle-now-1: push cup" in toggled(1)
