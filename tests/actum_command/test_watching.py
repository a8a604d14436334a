"""What is said of messages, services and mistakes is printed as it is, whatever looks like markup in it."""

from collections.abc import Callable
from typing import Any

import pytest
import typer
from rich.console import Console, RenderableType

from actum import keys
from actum.messages import ActedObject, Action, Event, Segment
from actum.runtime import Received
from actum_command import context
from actum_command.doctor import Finding, table
from actum_command.watching import describe, line
from empty_messages import action, mark, status

MARKUP = ("[b]", "[/b]", "[a]", "wave[/b]", "a\\")


def event(text: str) -> Event:
    return Event(
        stamp_ns=2,
        sensor="kinect0",
        agent=1,
        segment_id="one",
        start_ns=1,
        end_ns=2,
        action=text,
        confidence=1.0,
        activations={},
        object=ActedObject(id=1, name=text, distance_m=0.1),
        held=None,
        hand=None,
        objects_present=[1],
        distances_m={},
        motion=None,
        result=None,
        sentence=f"Agent 1: {text}",
        frames=1,
        missed=0,
    )


def rejected(text: str) -> Action:
    return action(1, 2).model_copy(update={"valid": False, "reason": text})


def named(text: str) -> Segment:
    return mark("start", 1, segment_id=text)


def answered(text: str) -> Action:
    return action(1, 2).model_copy(update={"action": text, "segment_id": text})


def finding(text: str) -> Finding:
    return Finding(
        service=text,
        instances=1,
        version=text,
        state=text,
        rates=text,
        rejects=text,
        drops=text,
        latency=text,
        problems=(text,),
    )


def printed(renderable: RenderableType) -> str:
    console = Console(width=200, highlight=False)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


@pytest.mark.parametrize("text", MARKUP)
@pytest.mark.parametrize("message", [status, event, rejected, named, answered])
def test_a_message_is_described_with_its_words_as_they_are(message: Callable[[str], Any], text: str) -> None:
    said = message(text)
    assert text in printed(describe(said))
    assert text in printed(line(Received(keys.key_of(said), said, None, 0)))


@pytest.mark.parametrize("text", MARKUP)
def test_a_finding_is_tabulated_with_its_words_as_they_are(text: str) -> None:
    assert printed(table([finding(text)])).count(text) == 7


@pytest.mark.parametrize("text", MARKUP)
def test_failing_and_saying_print_the_words_as_they_are(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    context.say(f"{text} :cat:", style="yellow")
    with pytest.raises(typer.Exit):
        context.fail(f"{text} :cat:")
    told = capsys.readouterr()
    assert f"{text} :cat:\n" in told.out
    assert told.err == f"actum: {text} :cat:\n"
