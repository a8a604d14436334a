"""What is said of messages, services and mistakes is printed as it is, whatever looks like markup in it."""

import json
import math
import re
from base64 import urlsafe_b64encode
from collections.abc import Callable
from datetime import datetime
from typing import Any

import numpy as np
import pytest
import typer
from rich.console import Console, RenderableType
from rich.markup import escape
from rich.panel import Panel

import events
from actum import keys
from actum.codec import DecodeError
from actum.messages import Action, Continuation, Event, Message, Objects, PostureAhead, Segment, TrackedObject
from actum.runtime import Received
from actum.skeletons import INDEX
from actum_command.commands import terminal
from actum_command.commands.doctor_command import table
from actum_command.describing import describe, json_line, line
from actum_command.doctor.service_checks import Finding
from empty_messages import action, image, mark, skeleton, status
from people import reaches
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

MARKUP = ("[b]", "[/b]", "[a]", "wave[/b]", "a\\")


def event(text: str) -> Event:
    return events.event("one", f"Agent 1: {text}", action=text, name=text)


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
    terminal.say(f"{text} :cat:", style="yellow")
    with pytest.raises(typer.Exit):
        terminal.fail(f"{text} :cat:")
    told = capsys.readouterr()
    assert f"{text} :cat:\n" in told.out
    assert told.err == f"actum: {text} :cat:\n"


@pytest.mark.parametrize("text", ["\x1b]0;title\x07", "\x1b[2J", "\x9b31m", "over\rwritten", "\x7f\b"])
def test_no_text_commands_the_terminal(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.say(text)
    terminal.console.print(Panel(f"[bold]{escape(text)}[/bold]"))
    with pytest.raises(typer.Exit):
        terminal.fail(text)
    told = capsys.readouterr()
    assert not set(told.out + told.err) & {*map(chr, range(10)), *map(chr, range(11, 32)), *map(chr, range(127, 160))}


def received(message: Message) -> Received:
    return Received(keys.key_of(message), message, None, 0)


EVENING_NS = 1_700_000_000_123_000_000


@pytest.mark.parametrize(
    ("message", "when"),
    [
        (event("wave"), "0.000 s "),
        (event("wave").model_copy(update={"stamp_ns": 12_345_000_000}), "12.345 s "),
        (
            event("wave").model_copy(update={"stamp_ns": EVENING_NS}),
            f"{datetime.fromtimestamp(EVENING_NS / 1e9):%H:%M:%S}.123 ",
        ),
        (mark("start"), "now "),
    ],
)
def test_a_line_begins_with_the_time_of_capture(message: Message, when: str) -> None:
    assert printed(line(received(message))).startswith(when)


@pytest.mark.parametrize("message", [event("wave"), rejected("why"), mark("start", 1, "one"), action(1, 2)])
def test_a_line_names_its_segment(message: Message) -> None:
    assert " one" in printed(line(received(message)))


def test_objects_are_shown_with_their_places() -> None:
    cup = TrackedObject(
        id=3, name="cup", position_m=[0.1, -0.25, 1.5], quaternion_xyzw=[0, 0, 0, 1], confidence=1.0, seen=True
    )
    book = cup.model_copy(update={"id": 4, "name": "book", "seen": False, "followed": True})
    shown = describe(Objects(stamp_ns=1, sensor="kinect0", objects=[cup, book]))
    assert shown == "3 cup (0.10, -0.25, 1.50) m; 4 book (0.10, -0.25, 1.50) m (covered, followed)"
    assert describe(Objects(stamp_ns=1, sensor="kinect0", objects=[])) == "no object"


def test_people_are_shown_with_their_places() -> None:
    assert describe(skeleton(1)) == "nobody"
    (frame,) = reaches(1)
    torso = ", ".join(f"{metres:.2f}" for metres in frame.agents[0].joints[2])
    assert describe(frame) == f"agent 1: torso ({torso}) m, 15 of 15 joints"


def test_a_posture_is_shown_with_where_hips_and_hands_are() -> None:
    (frame,) = reaches(1)
    (posture,) = PosePreprocessor(PoseSettings.defaults()).handle(frame)
    joints = np.array(frame.agents[0].joints)
    told = [
        np.array([float(number) for number in point.split(", ")])
        for point in re.findall(r"\(([-\d., ]+)\)", describe(posture))
    ]
    hips_m, left_m, right_m = told
    assert hips_m == pytest.approx(joints[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0), abs=0.03)
    for hand_m, name in ((left_m, "left_hand"), (right_m, "right_hand")):
        assert np.linalg.norm(hand_m) == pytest.approx(np.linalg.norm(joints[INDEX[name]] - hips_m), abs=0.03)
    lost = posture.model_copy(update={"joints_m": None})
    assert describe(lost) == "agent 1: no joints"


def test_a_continuation_is_described_by_the_hands() -> None:
    joints = [[0.0, 0.0, float(number)] for number in range(14)]
    ahead = [PostureAhead(ahead_s=0.5, joints_m=[*joints, None])]
    hands = "in 0.5 s left hand (0.00, 0.00, 5.00) m, right hand (0.00, 0.00, 8.00) m"
    assert describe(Continuation(stamp_ns=1, sensor="kinect0", agent=1, ahead=ahead)) == f"agent 1: {hands}"


def test_json_has_every_field_on_one_line() -> None:
    said = json_line(received(event("[b]")))
    assert "\n" not in said
    fields = json.loads(said)
    assert fields.pop("key") == "actum/kinect0/event/1"
    assert fields.pop("schema") == "actum.event/1"
    assert Event.model_validate(fields) == event("[b]")


def test_json_takes_bytes_and_what_is_no_number() -> None:
    assert json.loads(json_line(received(image(1))))["data"] == urlsafe_b64encode(b"jpeg").decode()
    (frame,) = reaches(1)
    frame.agents[0].joints[0][0] = math.nan
    assert json.loads(json_line(received(frame)))["agents"][0]["joints"][0][0] is None


def test_json_tells_what_is_no_message() -> None:
    garbage = Received("actum/kinect0/skeleton", None, DecodeError("not_msgpack", "no"), 1)
    assert json.loads(json_line(garbage)) == {"key": "actum/kinect0/skeleton", "error": "not_msgpack: no"}
