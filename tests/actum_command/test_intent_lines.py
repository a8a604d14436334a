"""Of the intents, which come with every posture, `actum watch` prints those that say something new."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from actum.messages import Intent, Message
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum_command.__main__ import app
from actum_command.describing import describe
from actum_command.intent_lines import IntentLines
from empty_messages import action, contact, intent

FRAME_NS = SECOND_NS // 30


def reach(*probabilities: float | None, object_id: int = 2, first: int = 0, agent: int = 1) -> list[Intent]:
    """Intents of one reach, a frame apart; None ends it."""
    return [
        intent((first + i) * FRAME_NS, *([contact(p, object_id=object_id)] if p is not None else []), agent=agent)
        for i, p in enumerate(probabilities)
    ]


def printed(*messages: Message) -> list[Message]:
    lines = IntentLines()
    return [message for message in messages if lines.include(message)]


def test_a_reach_has_a_line_at_its_beginning_at_each_level_and_at_its_end() -> None:
    messages = reach(0.2, 0.3, 0.5, 0.6, 0.91, 0.95, 0.1, None)
    assert printed(*messages) == [messages[i] for i in (1, 2, 4, 7)]


def test_what_is_never_probable_has_no_line() -> None:
    assert printed(*reach(0.1, 0.2, 0.1, None)) == []


def test_a_probability_that_falls_and_rises_again_has_no_line_again() -> None:
    messages = reach(0.6, 0.4, 0.6, 0.95, 0.5, 0.95)
    assert printed(*messages) == [messages[0], messages[3]]


def test_another_likeliest_object_has_a_line() -> None:
    cup, box = reach(0.6, 0.6), reach(0.55, 0.6, object_id=3, first=2)
    assert printed(*cup, *box) == [cup[0], box[0]]


def test_of_two_people_each_has_lines_of_their_own() -> None:
    one, other = reach(0.6, 0.6, None), reach(0.6, 0.6, None, agent=2)
    both = [message for pair in zip(one, other, strict=True) for message in pair]
    assert printed(*both) == [one[0], other[0], one[2], other[2]]


def test_a_reach_after_its_person_was_lost_from_view_begins_anew() -> None:
    before, after = reach(0.6, 0.6), reach(0.6, 0.6, None, first=30)
    assert printed(*before, *after) == [before[0], after[0], after[2]]


def test_messages_of_other_kinds_all_have_a_line() -> None:
    messages = [action(1, 2), action(1, 2)]
    assert printed(*messages) == messages


def test_a_line_names_probability_object_hand_and_time() -> None:
    assert describe(intent(1, contact(0.618, contact_s=0.481))) == (
        "0.62  reaches for cup (2) with the right hand, contact in 0.48 s ± 0.15"
    )
    assert "the reach is over" in describe(intent(1))
    assert r"\[b]" in describe(intent(1, contact(0.6, object_name="[b]")))


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "reach.mcap"
    with Recorder(path, person="1", source="live") as recorder:
        for message in reach(0.3, 0.4, 0.6, 0.95, None):
            recorder.write(message, message.stamp_ns)
    return path


def test_watch_prints_the_lines_and_with_json_every_message(recording: Path) -> None:
    watched = CliRunner().invoke(app, ["watch", "intent", "--from", str(recording)]).stdout.splitlines()
    assert len(watched) == 4
    assert watched[0].endswith("0.30  reaches for cup (2) with the right hand, contact in 0.50 s ± 0.15")
    as_json = CliRunner().invoke(app, ["watch", "intents", "--json", "--from", str(recording)]).stdout.splitlines()
    assert [len(json.loads(each)["intended"]) for each in as_json] == [1, 1, 1, 1, 0]
