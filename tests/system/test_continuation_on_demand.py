"""A live classifier continues postures only while somebody listens, and then as a replay does, to the value."""

from collections.abc import Iterator
from itertools import cycle
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Action, Continuation, Posture
from actum.node import replay
from actum.runtime import Client, Listening
from actum_deployer.roles import PREPROCESSOR, identity
from continued import at_this_speed
from deployments import BARE_ROUTER, deployed
from live import PATIENCE_S, System, collect, wait_until
from people import FRAME_NS, reaches
from performers import mark
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings
from som_classifier.node import SomClassifier
from wire import without_seq

pytestmark = pytest.mark.system
ANOTHER = 9
"""The number of a second person."""
FRAMES = 60


def postures() -> list[Posture]:
    node = PosePreprocessor(Settings.defaults())
    outputs = [output for each in reaches(FRAMES) for output in node.handle(each)]
    return [output for output in outputs if isinstance(output, Posture)]


@pytest.fixture
def client(running: System, tmp_path: Path) -> Iterator[Client]:
    """Somebody who puts postures for a classifier."""
    at_this_speed().save(tmp_path / "model.npz")
    running.start_router()
    running.start("som_classifier", "--model", str(tmp_path / "model.npz"))
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
        yield client


def continuations(listening: Listening) -> Iterator[Continuation]:
    """What has come so far."""
    while (received := listening.receive()) is not None:
        assert isinstance(received.message, Continuation)
        yield received.message


def first_of_another(client: Client, listening: Listening) -> Continuation:
    """Let another person reach again and again until that is continued; return how."""
    heard: list[Continuation] = []
    frames = enumerate(cycle(postures()))

    def is_continued() -> bool:
        number, posture = next(frames)
        moved = {"agent": ANOTHER, "agents": [ANOTHER], "stamp_ns": number * FRAME_NS, "session_id": "anew"}
        client.put(posture.model_copy(update=moved))
        heard.extend(continuations(listening))
        return bool(heard)

    wait_until(is_continued, "a continuation is put")
    return heard[0]


def test_what_is_put_is_what_a_replay_puts(client: Client) -> None:
    expected = list(replay(SomClassifier(at_this_speed()), [(each.stamp_ns, each) for each in postures()]))
    assert len(expected) > FRAMES // 2
    listening = client.listen(keys.pattern(keys.CONTINUATION, client.sensor))
    first_of_another(client, listening)
    for posture in postures():
        client.put(posture)
    put: list[Continuation] = []

    def all_came() -> bool:
        put.extend(each for each in continuations(listening) if each.agent != ANOTHER)
        return len(put) >= len(expected)

    wait_until(all_came, "all continuations are put")
    assert without_seq([*put]) == without_seq(expected)


def test_none_is_put_before_somebody_listens(client: Client) -> None:
    """Messages are numbered as they are put."""
    answers = client.listen(keys.pattern(keys.ACTION, client.sensor))
    for posture in postures():
        client.put(posture.model_copy(update={"agent": ANOTHER, "agents": [ANOTHER]}))
    client.put(mark("start", 0, "one"))
    client.put(mark("end", (FRAMES - 1) * FRAME_NS, "one"))
    collect(answers, Action, lambda found: any(each.final for each in found))
    listening = client.listen(keys.pattern(keys.CONTINUATION, client.sensor))
    first = first_of_another(client, listening)
    assert first.seq is not None and first.seq < FRAMES // 4


def test_where_routers_ask_who_may_what_a_viewer_on_another_host_gets_them(tmp_path: Path) -> None:
    """A classifier learns by the rules of access control, too, that somebody listens."""
    at_this_speed().save(tmp_path / "model.npz")
    preprocessor = identity(PREPROCESSOR, "kinect0")
    with deployed(tmp_path / "deployed", BARE_ROUTER, passwords=True) as running:
        running.start("som_classifier", "compute", "--model", str(tmp_path / "model.npz"))
        with running.client("viewer", "camera") as viewer, running.client(preprocessor, "compute") as client:
            first_of_another(client, viewer.listen(keys.pattern(keys.CONTINUATION, viewer.sensor)))
