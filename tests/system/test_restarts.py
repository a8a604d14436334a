"""A service that is started again goes on with what comes, and does not say once more what was said."""

import shutil
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
from benchmarks.rig.tcp_proxy import TcpProxy

from action_fusion.node import WAIT_NS
from actum import keys
from actum.messages import Action, Event, Message, Segment, Status
from actum.node import SECOND_NS
from actum.runtime import Client, Listening
from fusion_with_short_history import HISTORY_S
from live import Running, System, collect, wait_until
from people import marks, postures
from scenes import acting_on, action, at, later

PUSH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))
SCENE = [*PUSH.postures(), *PUSH.sightings(), action("push")]
LONG_S = 60.0
FUSION = Path(__file__).parents[1] / "fusion_with_short_history.py"
pytestmark = pytest.mark.system


def put_all(client: Client, messages: Sequence[Message]) -> None:
    assert client.wait_for_subscriber(keys.OBJECTS, 10.0)
    for message in messages:
        client.put(message)


def wait_until_heard(client: Client, *topics: keys.Topic) -> None:
    """Wait until the service has handled messages of these topics."""
    statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
    wanted = {topic.leaf.partition("/")[0] for topic in topics}
    collect(statuses, Status, lambda found: bool(found) and wanted <= {key.split("/")[2] for key in found[-1].handled})


def events_of(client: Client) -> Listening:
    return client.listen(keys.pattern(keys.EVENT, client.sensor))


@contextmanager
def killed(running: System, service: Running, client: Client) -> Iterator[None]:
    """Kill a service without warning; it is away within the context, and nobody says any more that it is alive."""
    service.process.kill()
    service.process.wait()
    wait_until(lambda: not client.alive(), "it is gone")
    yield


@pytest.fixture
def state(tmp_path: Path) -> tuple[str, str]:
    """The flag by which a service keeps its answers."""
    return "--state", str(tmp_path / "state")


def test_a_fusion_started_anew_does_not_answer_old_segments_again(running: System) -> None:
    """Publishers keep their last messages for those who come late: those of the last seconds, and not for ever."""
    running.start_router()
    fusion = running.start_script(FUSION)
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = events_of(client)
        put_all(client, SCENE)
        assert [event.segment_id for event in collect(events, Event, bool)] == ["s1"]
        answered_s = time.monotonic()
        wait_until(lambda: time.monotonic() > answered_s + HISTORY_S + 0.5, "the answer is old")
        fusion.terminate()
        running.start_script(FUSION)
        running.wait_for_services(client, "action_fusion")
        put_all(client, [later(m) for m in SCENE])
        found = collect(events, Event, lambda found: any(event.segment_id != "s1" for event in found))
    assert [event.segment_id for event in found] == ["later"]


def test_who_takes_over_does_not_answer_again_what_was_just_answered(running: System) -> None:
    running.start_router()
    fusion = running.start_script(FUSION, "--instance", "one")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = events_of(client)
        put_all(client, SCENE)
        assert [event.segment_id for event in collect(events, Event, bool)] == ["s1"]
        running.start_script(FUSION, "--instance", "two", "--take-over")
        wait_until(lambda: fusion.process.poll() is not None, "the first has left")
        running.wait_for_services(client, "action_fusion")
        there_s = time.monotonic()
        wait_until(lambda: time.monotonic() > there_s + HISTORY_S + 0.5, "whatever it was told again is answered")
        assert events.receive() is None


def test_late_subscribers_get_the_events_of_a_fusion_that_was_killed(running: System, state: tuple[str, str]) -> None:
    """The same ones, and who has heard them does not hear them again."""
    running.start_router()
    fusion = running.start("action_fusion", *state)
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = events_of(client)
        put_all(client, SCENE)
        (event,) = collect(events, Event, bool)
        with killed(running, fusion, client):
            running.start("action_fusion", *state)
        running.wait_for_services(client, "action_fusion")
        put_all(client, [later(m) for m in SCENE])
        heard = collect(events, Event, bool)
        kept = collect(
            client.listen_back(keys.pattern(keys.EVENT, client.sensor), LONG_S), Event, lambda found: len(found) == 2
        )
    assert [(each.segment_id, each.seq) for each in heard] == [("later", 1)], "its numbers go on"
    assert sorted(kept, key=lambda each: each.stamp_ns) == [event, *heard]


def test_actions_put_while_the_fusion_was_away_get_their_events(running: System, state: tuple[str, str]) -> None:
    """The object where its streams are still kept, else a rejection that says that it was not there."""
    running.start_router()
    fusion = running.start("action_fusion", *state)
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = events_of(client)
        put_all(client, SCENE)
        assert [event.segment_id for event in collect(events, Event, bool)] == ["s1"]
        with killed(running, fusion, client):
            for message in [*PUSH.postures(-11.0), *PUSH.sightings(-11.0)]:
                client.put(later(message))
            client.put(later(action("push", -10.0, -8.0), "lost"))
            client.put(later(action("push"), "kept"))
            running.start("action_fusion", *state)
        found = collect(events, Event, lambda found: len(found) == 2)
    answered = {event.segment_id: event for event in found}
    assert answered["kept"].valid and answered["kept"].object is not None
    assert "the fusion started late: its first posture is" in (answered["lost"].reason or "")


def test_an_event_written_down_and_not_put_reaches_those_who_wait_for_it(
    running: System, state: tuple[str, str], tmp_path: Path
) -> None:
    """As where the fusion is killed between the two: its journal says more than anybody has heard."""
    running.start_router()
    fusion = running.start("action_fusion", *state)
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        put_all(client, SCENE)
        collect(client.listen_back(keys.pattern(keys.EVENT, client.sensor), LONG_S), Event, bool)
        with killed(running, fusion, client):
            shutil.copytree(state[1], tmp_path / "copy")
        with running.client() as unheard:
            waiting = unheard.listen_back(keys.pattern(keys.EVENT, client.sensor), LONG_S)
            assert waiting.receive() is None
            running.start("action_fusion", "--state", str(tmp_path / "copy"))
            (event,) = collect(waiting, Event, bool)
    assert event.segment_id == "s1"


@pytest.fixture
def classifier_flags(scene_model: Path, state: tuple[str, str]) -> tuple[str, ...]:
    return ("--model", str(scene_model), "--segments", "marks", *state)


def test_marks_put_while_the_classifier_was_away_are_answered(
    running: System, classifier_flags: tuple[str, ...]
) -> None:
    """Recognised where the frames are still kept, else rejected with the reason; what was answered is not again."""
    running.start_router()
    classifier = running.start("som_classifier", *classifier_flags)
    frames = postures(0.0, 21.0)
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        assert client.wait_for_subscriber(keys.SEGMENT, 10.0)
        for message in [*frames[:90], *marks("before", 0.0, 2.0)]:
            client.put(message)
        first = collect(actions, Action, lambda found: any(each.final for each in found))[-1]
        with killed(running, classifier, client):
            for message in [*marks("lost", 3.0, 5.0), *frames[90:], *marks("kept", 16.0, 18.0)]:
                client.put(message)
            running.start("som_classifier", *classifier_flags)
        final = [each for each in collect(actions, Action, _answered("lost", "kept")) if each.final]
        answers = {each.segment_id: each for each in final}
        kept = client.listen_back(keys.pattern(keys.ACTION, client.sensor), LONG_S)
        again = collect(kept, Action, _answered("before", "lost", "kept"))
    assert len(final) == 2
    of_it = [frame for frame in frames if 16 * SECOND_NS <= frame.stamp_ns <= 18 * SECOND_NS]
    assert answers["kept"].valid and answers["kept"].frames == len(of_it) and answers["kept"].missed == 0
    assert "the classifier started late: its first frame is" in (answers["lost"].reason or "")
    assert [each for each in again if each.segment_id == "before"] == [first], "word for word"


def _answered(*names: str):
    return lambda found: {each.segment_id for each in found if each.final} >= set(names)


def test_a_mark_without_a_stamp_from_before_its_start_is_rejected(
    running: System, classifier_flags: tuple[str, ...]
) -> None:
    running.start_router()
    classifier = running.start("som_classifier", *classifier_flags)
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        for message in [*postures(0.0, 3.0), *marks("before", 0.0, 2.0)]:
            client.put(message)
        collect(actions, Action, _answered("before"))
        with killed(running, classifier, client):
            client.put(Segment(sensor="kinect0", kind="start", segment_id="now"))
            running.start("som_classifier", *classifier_flags)
        (rejected,) = [each for each in collect(actions, Action, _answered("now")) if each.final]
    assert rejected.reason == "the classifier had only just started, so it could not date a mark without a stamp"


def test_a_fusion_that_is_stopped_for_seconds_goes_on_as_if_nothing_had_been(running: System) -> None:
    """It first reads what has come meanwhile, before it gives up waiting for it."""
    running.start_router()
    fusion = running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = events_of(client)
        put_all(client, [m for m in SCENE if m.stamp_ns < at(1.0)])
        client.put(SCENE[-1])
        fusion.process.send_signal(signal.SIGSTOP)
        for message in SCENE[:-1]:
            if message.stamp_ns >= at(1.0):
                client.put(message)
        stopped_s = time.monotonic()
        wait_until(lambda: time.monotonic() > stopped_s + 1.1 * WAIT_NS / SECOND_NS, "it has been stopped for long")
        fusion.process.send_signal(signal.SIGCONT)
        (event,) = collect(events, Event, bool)
    assert event.valid and event.result == "0.20 m away"


def test_what_was_put_while_a_link_was_cut_arrives_once_it_is_back(running: System, state: tuple[str, str]) -> None:
    """Frames as well as marks: a segment that was cut off for seconds is answered from all of its frames."""
    running.start_router()
    port = int(running.settings.connect.rpartition(":")[2])
    with TcpProxy(port) as link:
        running.start_script(FUSION, "--connect", f"tcp/127.0.0.1:{link.port}", *state)
        with running.client() as client:
            running.wait_for_services(client, "action_fusion")
            events = events_of(client)
            put_all(client, [m for m in SCENE if m.stamp_ns < at(0.5)])
            wait_until_heard(client, keys.POSTURE, keys.OBJECTS)
            link.cut()
            wait_until(lambda: not client.alive(), "the link is cut")
            for message in [m for m in SCENE if at(0.5) <= m.stamp_ns < at(3.0)]:
                client.put(message)
            cut_s = time.monotonic()
            wait_until(lambda: time.monotonic() > cut_s + HISTORY_S + 0.5, "it has been cut for long")
            link.mend()
            wait_until(lambda: bool(client.alive()), "the link is back")
            for message in [m for m in SCENE if m.stamp_ns >= at(3.0)]:
                client.put(message)
            (event,) = collect(events, Event, bool)
    assert event.valid and event.missed == 0 and event.result == "0.20 m away"


def test_a_router_that_is_killed_and_started_again_loses_nothing(running: System, state: tuple[str, str]) -> None:
    router = running.start_router_process()
    running.start("action_fusion", *state)
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = client.listen_back(keys.pattern(keys.EVENT, client.sensor), LONG_S)
        put_all(client, [m for m in SCENE if m.stamp_ns < at(0.5)])
        wait_until_heard(client, keys.POSTURE, keys.OBJECTS)
        router.process.kill()
        wait_until(lambda: not client.connected(), "the router is gone")
        for message in [m for m in SCENE if at(0.5) <= m.stamp_ns < at(3.0)]:
            client.put(message)
        running.start_router_process()
        running.wait_for_services(client, "action_fusion")
        for message in [m for m in SCENE if m.stamp_ns >= at(3.0)]:
            client.put(message)
        (event,) = collect(events, Event, bool)
    assert event.valid and event.missed == 0 and event.result == "0.20 m away"
