"""Several processes share sensors: each sensor has one of them, another soon after that one died."""

import signal
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Action, Event, Message, Segment, Status
from actum.node import SECOND_NS, replay
from actum.runtime import Client, Listening
from actum.runtime.rendezvous import server_of
from actum.runtime.reporting import REPORT_S
from live import PATIENCE_S, Running, System, collect, wait_until
from people import marks, postures
from recognisers import tiny_model
from scenes import acting_on, action, later
from som_classifier.node import SomClassifier

pytestmark = pytest.mark.system
SENSORS = ("door", "window", "table", "shelf")
LONGEST_WAIT_S = 3.0
"""Longer (s) than a classifier waits for the last frames of a segment."""
NAMES = ("north", "south")
SEGMENTS = {"before": (0.0, 2.0), "cut": (3.0, 5.5), "after": (7.0, 9.0)}
FRAMES = postures(0.0, 10.0)


@pytest.fixture
def start(running: System, tmp_path: Path):
    """Start a classifier that shares all sensors."""
    tiny_model().save(tmp_path / "model.npz")
    running.start_router()

    def started(name: str) -> Running:
        flags = ("--model", str(tmp_path / "model.npz"), "--segments", "marks", "--share", "--instance", name)
        return running.start("som_classifier", "--sensor", ",".join(SENSORS), *flags)

    return started


def serving(client: Client) -> str | None:
    """The instance that serves a sensor, if there is one alone."""
    names = [key.split("/")[-1] for key in client.alive()]
    return names[0] if len(names) == 1 else None


def of_sensor(client: Client, messages: Sequence[Message]) -> list[Message]:
    return [message.model_copy(update={"sensor": client.sensor}) for message in messages]


def put(client: Client, from_s: float, to_s: float, marked: Sequence[Segment]) -> None:
    """Put the frames between two times, and marks before them."""
    between = [frame for frame in FRAMES if from_s * SECOND_NS <= frame.stamp_ns < to_s * SECOND_NS]
    assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
    for message in of_sensor(client, [*marked, *between]):
        client.put(message)


def alone() -> dict[str, Action]:
    """What a classifier that nobody kills answers."""
    node = SomClassifier(tiny_model())
    marked = [mark for name, bounds in SEGMENTS.items() for mark in marks(name, *bounds)]
    stream = sorted([*FRAMES, *marked], key=lambda each: (each.stamp_ns or 0, isinstance(each, Segment)))
    answers = replay(node, [(each.stamp_ns or 0, each) for each in stream])
    return {each.segment_id: each for each in answers if isinstance(each, Action) and each.final}


def wait_for_reports(client: Client, seconds: float) -> None:
    """Wait until the serving process reports that it has run for so long since it last reported."""
    statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
    collect(statuses, Status, lambda found: found and found[-1].uptime_s - found[0].uptime_s >= seconds)


def finals(found: Sequence[Action], name: str) -> bool:
    return any(each.final and each.segment_id == name for each in found)


def test_each_segment_has_one_answer_as_alone_though_its_process_is_killed(running: System, start) -> None:
    processes = {name: start(name) for name in NAMES}
    with ExitStack() as stack:
        clients = [stack.enter_context(running.client(sensor)) for sensor in SENSORS]
        wait_until(lambda: all(serving(c) == server_of(c.sensor, NAMES) for c in clients), "each serves its share")
        assert {serving(client) for client in clients} == set(NAMES)
        assert (
            f"{serving(clients[0])} serves the sensor; standing by: "
            in running.actum("doctor", "--sensor", SENSORS[0]).stdout
        )
        actions: list[tuple[Listening, list[Action]]] = [
            (client.listen(keys.pattern(keys.ACTION, client.sensor)), []) for client in clients
        ]
        for client, (listening, found) in zip(clients, actions, strict=True):
            first, second = marks("before", *SEGMENTS["before"]), marks("cut", *SEGMENTS["cut"])
            put(client, 0.0, 4.0, [*first, second[0]])
            found.extend(collect(listening, Action, lambda heard: any(each.segment_id == "cut" for each in heard)))
        processes["north"].process.kill()
        wait_until(lambda: all(serving(client) == "south" for client in clients), "all sensors have a process again")
        for client, (listening, found) in zip(clients, actions, strict=True):
            put(client, 4.0, 10.0, [marks("cut", *SEGMENTS["cut"])[1], *marks("after", *SEGMENTS["after"])])
            found.extend(collect(listening, Action, lambda heard: finals(heard, "after") and finals(heard, "cut")))
        wait_for_reports(clients[0], LONGEST_WAIT_S)
        for listening, found in actions:
            found.extend(collect(listening, Action, lambda _: True))
            answers = {each.segment_id: each for each in found if each.final}
            assert len([each for each in found if each.final]) == len(answers) == len(SEGMENTS)
            for name, expected in alone().items():
                same = {"action", "valid", "start_ns", "end_ns", "frames", "missed"}
                assert answers[name].model_dump(include=same) == expected.model_dump(include=same)


@pytest.mark.thorough
def test_a_process_that_was_paused_does_not_answer_what_another_has_answered(running: System, start) -> None:
    processes = {name: start(name) for name in NAMES}
    sensor = next(sensor for sensor in SENSORS if server_of(sensor, NAMES) == "south")
    with running.client(sensor) as client:
        wait_until(lambda: serving(client) == "south", "south serves its share")
        actions = client.listen(keys.pattern(keys.ACTION, sensor))
        start_mark, end_mark = marks("cut", *SEGMENTS["cut"])
        put(client, 0.0, 4.0, [start_mark])
        found = collect(actions, Action, bool)
        processes["south"].process.send_signal(signal.SIGSTOP)
        wait_until(lambda: serving(client) == "north", "north takes over")
        put(client, 4.0, 10.0, [end_mark])
        found += collect(actions, Action, lambda heard: finals(heard, "cut"))
        processes["south"].process.send_signal(signal.SIGCONT)
        wait_until(lambda: serving(client) == "south", "south serves again")
        wait_for_reports(client, LONGEST_WAIT_S)
        found += collect(actions, Action, lambda _: True)
    assert len([each for each in found if each.final]) == 1


def test_another_fusion_goes_on_where_one_was_killed(running: System) -> None:
    running.start_router()
    push = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))
    scene = [*push.postures(), *push.sightings()]
    with running.client() as client:
        fusions = {name: running.start("action_fusion", "--share", "--instance", name) for name in NAMES}
        first = server_of(client.sensor, NAMES)
        wait_until(lambda: serving(client) == first, "the sensor has a fusion")
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        assert client.wait_for_subscriber(keys.OBJECTS, PATIENCE_S)
        for message in [*scene, action("push")]:
            client.put(message)
        assert [each.segment_id for each in collect(events, Event, bool)] == ["s1"]
        for message in [later(each) for each in scene]:
            client.put(message)
        fusions[str(first)].process.kill()
        wait_until(lambda: serving(client) not in (None, first), "the other one serves")
        client.put(later(action("push")))
        found = collect(events, Event, bool)
        wait_for_reports(client, LONGEST_WAIT_S)
        found += collect(events, Event, lambda _: True)
    assert [(each.segment_id, each.valid) for each in found] == [("later", True)]


def test_a_new_process_gets_its_share_once_no_segment_is_under_way(running: System, start) -> None:
    start("north")
    with ExitStack() as stack:
        clients = [stack.enter_context(running.client(sensor)) for sensor in SENSORS]
        wait_until(lambda: all(serving(client) == "north" for client in clients), "the first serves all")
        busy = next(client for client in clients if server_of(client.sensor, NAMES) == "south")
        start_mark, end_mark = marks("cut", *SEGMENTS["cut"])
        actions = busy.listen(keys.pattern(keys.ACTION, busy.sensor))
        put(busy, 0.0, 4.0, [start_mark])
        collect(actions, Action, bool)
        start("south")
        others = [client for client in clients if client is not busy]
        wait_until(lambda: all(serving(c) == server_of(c.sensor, NAMES) for c in others), "the second has its share")
        wait_for_reports(busy, 2 * REPORT_S)
        assert serving(busy) == "north"
        put(busy, 4.0, 10.0, [end_mark])
        collect(actions, Action, lambda found: finals(found, "cut"))
        wait_until(lambda: serving(busy) == "south", "it follows at the segment's end")
