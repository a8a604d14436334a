"""What the demo without marks says: each event beside what was done then, and what was told of nothing."""

import pytest

from actum.messages import Action, Agent, Event, Skeleton, Status, Truth
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.states import State
from actum_command.demo.performance import Doing, Performance
from actum_command.demo.unmarked import PersonWitness, summary, table
from scene_simulator.simulator import GATEWAY

NAMES = {1: "cup", 2: "box"}
FRAME_S = 0.1
LENGTH_S = 20.0
DOINGS = (Doing("drink", 8 * SECOND_NS, 10 * SECOND_NS), Doing("walk_away", 14 * SECOND_NS, 16 * SECOND_NS))
FIRST_NS = 5 * SECOND_NS
"""The sensor's clock at the scene's first frame: stamps do not begin with zero."""


def at(second: float) -> int:
    return FIRST_NS + round(second * SECOND_NS)


def skeleton(second: float, seen: bool = True) -> Skeleton:
    agent = Agent(agent=1, joints=[[0.0, 0.0, 2.0]] * len(INDEX), confidence=[1.0] * len(INDEX))
    return Skeleton(stamp_ns=at(second), sensor="kinect0", agents=[agent] if seen else [], session_id="s")


def truth(kind: str, second: float, name: str, action: str, object_id: int) -> Truth:
    message = {
        "stamp_ns": at(second), "sensor": "kinect0", "kind": kind, "segment_id": name, "agent": 1, "hand": "right",
        "action": action, "object_id": object_id, "object_name": NAMES[object_id], "displacement_m": None,
    }  # fmt: skip
    return Truth.model_validate(message)


def told(start_s: float, end_s: float, action: str, object_id: int | None) -> list[Action | Event]:
    """The final action and the event of a segment, put 0.2 s after its end."""
    message = {
        "stamp_ns": at(end_s), "sensor": "kinect0", "agent": 1, "segment_id": f"auto-{start_s}",
        "start_ns": at(start_s), "end_ns": at(end_s), "action": action, "confidence": 0.9, "activations": {},
        "hand": None, "frames": 9, "missed": 0,
    }  # fmt: skip
    named = None if object_id is None else {"id": object_id, "name": NAMES[object_id], "distance_m": 0.1}
    of_event = {
        "object": named, "held": None, "motion": None, "objects_present": [], "distances_m": {}, "result": None,
        "sentence": f"told {action}",
    }  # fmt: skip
    return [Action.model_validate(message | {"final": True, "part": None}), Event.model_validate(message | of_event)]


def status(state: str) -> Status:
    message = {
        "stamp_ns": 1, "sensor": "kinect0", "service": GATEWAY, "instance": "i", "uptime_s": 1.0, "rates": {},
        "handled": {}, "drops": {}, "rejects": {}, "last_error": None, "latency_ms": {}, "state": state,
    }  # fmt: skip
    return Status.model_validate(message)


DONE = [(2.0, 4.0, "push", 1), (5.0, 7.0, "lift", 2), (11.0, 13.0, "put", 1)]


def heard(*segments: tuple[float, float, str, int | None], done: list = DONE) -> tuple[list[str], Performance]:
    """The lines and the performance of a scene in which these segments are told, each 0.2 s after its end."""
    performance = Performance("person 1", len(done), DOINGS)
    witness = PersonWitness(performance, 0, len(done), LENGTH_S)
    messages = [(second * FRAME_S, skeleton(second * FRAME_S)) for second in range(round(LENGTH_S / FRAME_S))]
    for number, (start_s, end_s, action, object_id) in enumerate(done):
        messages.append((start_s, truth("start", start_s, str(number), action, object_id)))
        messages.append((end_s, truth("end", end_s, str(number), action, object_id)))
    messages += [(segment[1] + 0.25, message) for segment in segments for message in told(*segment)]
    in_order = [message for _, message in sorted(messages, key=lambda each: each[0])]
    return [
        line for message in [*in_order, status(State.SOURCE_ENDED)] for line in witness.receive(message)
    ], performance


def plain(line: str) -> str:
    for markup in ("[green]", "[/green]", "[red]", "[/red]", "[bold]", "[/bold]"):
        line = line.replace(markup, "")
    return " ".join(line.split())


def test_each_event_stands_beside_the_action_that_was_done_then() -> None:
    lines, _ = heard((2.2, 4.1, "push", 1), (5.0, 7.0, "lift", 1), (11.1, 12.8, "pull", 1))
    assert list(map(plain, lines)) == [
        '1/3 push 1 "cup" action ✓ object ✓ told push',
        '2/3 lift 2 "box" action ✓ object ✗ told lift',
        '3/3 put 1 "cup" action ✗ object ✓ told pull',
    ]


def test_an_event_of_nothing_is_a_false_alarm_and_says_what_was_done_instead() -> None:
    lines, _ = heard((8.2, 9.5, "lift", None), (17.0, 18.0, "push", 2), done=[])
    assert list(map(plain, lines)) == ["(drink) false alarm told lift", "(at rest) false alarm told push"]


def test_an_action_that_is_told_twice_is_right_once() -> None:
    lines, performance = heard((2.0, 4.0, "push", 1), (3.5, 4.4, "push", 1), done=DONE[:1])
    assert list(map(plain, lines)) == [
        '1/1 push 1 "cup" action ✓ object ✓ told push',
        "(at rest) false alarm told push",
    ]
    assert "found by itself: 1 of 1 actions" in summary([performance], "nothing", 1)


def test_an_action_that_nothing_was_told_of_is_said_in_its_place() -> None:
    lines, _ = heard((2.0, 4.0, "push", 1), (11.0, 13.0, "put", 1))
    assert [plain(line)[:18] for line in lines] == ['1/3 push 1 "cup" a', '2/3 lift 2 "box" n', '3/3 put 1 "cup" ac']
    assert lines[1].endswith("[red]not found[/red]")


def test_the_summary_counts_what_was_found_mistaken_missed_and_told_of_nothing() -> None:
    _, performance = heard(
        (2.0, 4.0, "push", 1), (5.0, 7.0, "point", 2), (8.2, 9.5, "lift", 2), (14.0, 15.0, "pull", 1)
    )
    text = summary([performance], "4 minutes of 3 people", 9)
    assert "found by itself: 1 of 3 actions" in text
    assert "1 told as another action, 1 not found" in text
    assert "false alarms: 2 in 0.2 minutes of everything else (8.6 a minute): drink 1, walk away 1" in text
    assert "told 0.2 s after the end of the action (median)" in text
    assert "objects that the action alone would tell: 3 of 3" in text
    assert "learned from 4 minutes of 3 people, tested on 9 others" in text


def test_the_table_counts_every_action_that_was_done() -> None:
    _, performance = heard((2.0, 4.0, "push", 1), (5.0, 7.0, "point", 2))
    columns = {str(column.header): list(column.cells) for column in table([performance]).columns[4:]}
    assert columns["here: tests"] == ["1", "0", "1", "1", "0", "3"]
    assert columns["action"][-1] == "1 (33.3%)"
    assert columns["object"][-1] == "2 (66.7%)"


def test_a_scene_is_over_once_its_source_has_ended_and_each_final_action_is_an_event() -> None:
    performance = Performance("person 1", actions=1)
    final, event = told(2.0, 4.0, "push", 1)
    performance.receive(status(State.SOURCE_ENDED))
    performance.receive(truth("start", 2.0, "0", "push", 1))
    performance.receive(truth("end", 4.0, "0", "push", 1))
    assert not performance.over, "it was the scene before that had ended"
    performance.receive(final)
    performance.receive(status(State.SOURCE_ENDED))
    assert not performance.over, "the event has not come"
    performance.receive(event)
    assert performance.over


@pytest.mark.parametrize(("away_s", "seen_s"), [(0.5, 20), (6.0, 14)])
def test_background_is_when_somebody_is_seen_and_does_none_of_the_actions(away_s: float, seen_s: float) -> None:
    performance = Performance("person 1", actions=0)
    for second in range(200):
        performance.receive(skeleton(second * FRAME_S, seen=not 10 < second * FRAME_S < 10 + away_s))
    seen_ns = sum(stretch.end_ns - stretch.start_ns for stretch in performance.found.seen)
    assert seen_ns / SECOND_NS == pytest.approx(seen_s, abs=0.3)
