"""Events outlive the router: a service of its own stores them, whatever ends meanwhile."""

import json
from contextlib import suppress
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Message, Status
from actum.recording import Recording, RecordingError
from actum.runtime import Client
from empty_messages import action, mark
from events import event
from live import PATIENCE_S, Running, System, collect, wait_until

pytestmark = pytest.mark.system


def started(running: System, folder: Path, *arguments: str) -> Running:
    return running.start("actum_command", "record", str(folder), "--events", *arguments)


def stored(folder: Path) -> list[Message]:
    with suppress(RecordingError):  # a file that is just being begun
        return [message for file in sorted(folder.glob("*.mcap*")) for message in Recording(file).messages()]
    return []


def events_in(folder: Path) -> list[str]:
    return [message.segment_id for message in stored(folder) if isinstance(message, Event)]


def put(client: Client, *names: str) -> None:
    assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
    for name in names:
        client.put(mark("start", 1, name))
        client.put(action(1, 2, name))
        client.put(event(name, f"pushed the cup in {name}"))


def test_what_happened_is_kept_and_read_like_what_happens(running: System, tmp_path: Path) -> None:
    folder = tmp_path / "history"
    recorder = started(running, folder)
    wait_until(lambda: "waiting for a router" in recorder.said(), "it waits for the router")
    running.start_router()
    with running.client() as client:
        running.wait_for_services(client, "event_recorder")
        put(client, "one", "two")
        wait_until(lambda: len(stored(folder)) == 6, "all stands in the file while it is written")
        shown = running.actum("watch", "event", "segment", "--from", str(folder), "--json")
    fields = [json.loads(line) for line in shown.stdout.splitlines()]
    assert sorted((each["schema"], each["segment_id"]) for each in fields) == [
        ("actum.event/1", "one"), ("actum.event/1", "two"), ("actum.segment/1", "one"), ("actum.segment/1", "two"),
    ]  # fmt: skip
    recorder.terminate()
    assert recorder.process.returncode == 0
    [file] = folder.iterdir()
    assert file.suffix == ".mcap" and not Recording(file).truncated
    assert "pushed the cup in two" in running.actum("watch", "--from", str(file)).stdout


def test_a_killed_one_leaves_what_it_was_told_and_the_next_goes_on(running: System, tmp_path: Path) -> None:
    folder = tmp_path / "history"
    running.start_router()
    killed = started(running, folder)
    with running.client() as client:
        running.wait_for_services(client, "event_recorder")
        put(client, "before")
        wait_until(lambda: events_in(folder) == ["before"], "it is written")
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "event_recorder"))
        collect(statuses, Status, bool)
        killed.process.kill()
        killed.process.wait()
        started(running, folder)
        wait_until(lambda: ".mcap" in {file.suffix for file in folder.iterdir()}, "what was left is finished")
        running.wait_for_services(client, "event_recorder")
        put(client, "after")
        wait_until(lambda: events_in(folder)[-1:] == ["after"], "it goes on")
        wait_until(lambda: len(stored(folder)) >= 6, "of both segments mark, action and event are stored")
    assert events_in(folder) == ["before", "after"]
    assert len(stored(folder)) == 6, "what the next is told once more is stored once"
    assert len(list(folder.iterdir())) == 2


def test_the_router_may_go_and_come_back(running: System, tmp_path: Path) -> None:
    folder = tmp_path / "history"
    router = running.start_router_process()
    recorder = started(running, folder)
    with running.client() as client:
        running.wait_for_services(client, "event_recorder")
        put(client, "before")
        wait_until(lambda: events_in(folder) == ["before"], "it is written")
        router.process.kill()
        wait_until(lambda: "the connection to the router" in recorder.said(), "it notices")
        running.start_router_process()
        wait_until(client.connected, "the router is back")
        running.wait_for_services(client, "event_recorder")
        put(client, "after")
        wait_until(lambda: {*events_in(folder)} == {"before", "after"}, "it goes on")


def test_it_is_a_service_that_says_how_it_does(running: System, tmp_path: Path) -> None:
    running.start_router()
    started(running, tmp_path / "history", "--history-file-mb", "0.01")
    with running.client() as client:
        running.wait_for_services(client, "event_recorder")
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "event_recorder"))
        put(client, *(f"s{number}" for number in range(8)))
        finished = collect(statuses, Status, lambda found: any(status.counts.get("files") for status in found))
        assert finished[-1].state == "running"
        second = started(running, tmp_path / "elsewhere")
        assert second.process.wait(timeout=PATIENCE_S) == 3
        assert "another event_recorder already runs for sensor kinect0" in second.said()
    assert not (tmp_path / "elsewhere").exists()


def test_a_file_is_no_folder(running: System, tmp_path: Path) -> None:
    refused = running.actum("record", str(tmp_path / "a.mcap"), "--events")
    assert refused.returncode == 2
    assert "looks like a file, but --events writes several files: give a folder" in refused.stderr
