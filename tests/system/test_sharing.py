"""Several processes share sensors: each sensor has one of them, another soon after that one died."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Action, Message, Segment
from actum.node import SECOND_NS, replay
from actum.runtime import Client, Listening
from actum.runtime.rendezvous import server_of
from live import PATIENCE_S, Running, System, collect, wait_until
from people import marks, postures
from recognisers import tiny_model
from som_classifier.node import SomClassifier

pytestmark = pytest.mark.system
SENSORS = ("door", "window", "table", "shelf")
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


def finals(found: Sequence[Action], name: str) -> bool:
    return any(each.final and each.segment_id == name for each in found)


def test_each_segment_has_one_answer_as_alone_though_its_process_is_killed(running: System, start) -> None:
    processes = {name: start(name) for name in NAMES}
    with ExitStack() as stack:
        clients = [stack.enter_context(running.client(sensor)) for sensor in SENSORS]
        wait_until(lambda: all(serving(c) == server_of(c.sensor, NAMES) for c in clients), "each serves its share")
        assert {serving(client) for client in clients} == set(NAMES)
        assert (
            f"{serving(clients[0])} serves this sensor; standing by: "
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
            answers = {each.segment_id: each for each in found if each.final}
            assert len([each for each in found if each.final]) == len(answers) == len(SEGMENTS)
            for name, expected in alone().items():
                same = {"action", "valid", "start_ns", "end_ns", "frames", "missed"}
                assert answers[name].model_dump(include=same) == expected.model_dump(include=same)


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
        assert serving(busy) == "north"
        put(busy, 4.0, 10.0, [end_mark])
        collect(actions, Action, lambda found: finals(found, "cut"))
        wait_until(lambda: serving(busy) == "south", "it follows at the segment's end")
