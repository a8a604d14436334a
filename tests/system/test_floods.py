"""Floods at real services: they cost a bounded amount of memory and time, are told, and what comes after is handled."""

import os
from pathlib import Path

import pytest

from actum import keys
from actum.limits import MOST_OPEN_SEGMENTS
from actum.messages import Message, Posture, Segment, Status
from actum.runtime import Client, Listening
from live import Running, System, collect
from node_cases import CASES, NOON_NS

MARKS = 10_000
PREPROCESSOR, CLASSIFIER = CASES[0], CASES[1]
pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory and time are read from /proc"),
]


def resident_bytes(service: Running) -> int:
    return int(Path(f"/proc/{service.process.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def busy_s(service: Running) -> float:
    """How long a process has run on a core."""
    user, system = Path(f"/proc/{service.process.pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def status_after(statuses: Listening, told: int, topic: keys.Topic) -> Status:
    """Wait until a service has told of so many messages of a topic, as handled, lost or not decodable."""

    def accounted(status: Status) -> int:
        key = keys.key(topic, status.sensor)
        bad = status.rejects.get("not_msgpack", 0) + status.rejects.get("too_large", 0)
        return status.handled.get(key, 0) + status.drops.get(key, 0) + bad

    found: list[Status] = collect(statuses, Status, lambda found: bool(found) and accounted(found[-1]) >= told)
    return found[-1]


def put_all(client: Client, messages: list[Message]) -> None:
    for message in messages:
        client.put(message)


def test_ten_thousand_starts_are_answered_or_told_as_lost_in_little_memory(running: System) -> None:
    running.start_router()
    classifier = running.start("som_classifier")
    with running.client() as client:
        running.wait_for_services(client, "som_classifier")
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "som_classifier"))
        assert client.wait_for_subscriber(keys.SEGMENT, 10.0)
        put_all(client, [m for m in CLASSIFIER.messages() if isinstance(m, Posture)])
        begun_bytes, begun_s = resident_bytes(classifier), busy_s(classifier)
        starts = (Segment(stamp_ns=NOON_NS, sensor="kinect0", kind="start", segment_id=f"s{i}") for i in range(MARKS))
        put_all(client, list(starts))
        status = status_after(statuses, MARKS, keys.SEGMENT)
        handled = status.handled[keys.key(keys.SEGMENT, client.sensor)]
        assert status.rejects["too_many_segments"] == handled - MOST_OPEN_SEGMENTS > 0
        assert resident_bytes(classifier) - begun_bytes < 60_000_000
        assert busy_s(classifier) - begun_s < 30
        answers = client.listen(keys.pattern(keys.ACTION, client.sensor))
        client.put(Segment(stamp_ns=NOON_NS, sensor="kinect0", kind="end", segment_id="after"))
        assert collect(answers, Message, bool)[-1].segment_id == "after"
        said = running.actum("doctor").stdout
    assert "som_classifier received more than its limits allow (too_many_segments" in " ".join(said.split())


def test_large_payloads_by_the_thousand_fill_no_memory(running: System) -> None:
    """Those up to twice as long as admitted are counted; longer ones are dropped before they wait in a ring."""
    running.start_router()
    preprocessor = running.start("pose_preprocessor")
    key, most = keys.key(keys.SKELETON, "kinect0"), keys.SKELETON.max_bytes
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "pose_preprocessor"))
        assert client.wait_for_subscriber(keys.SKELETON, 10.0)
        begun_bytes = resident_bytes(preprocessor)
        for _ in range(300):
            client.put_raw(key, b"\xc1" * (10 * most))
        for _ in range(300):
            client.put_raw(key, b"\xc1" * (2 * most))
        client.put_raw(key, b"\xc1")

        def told(found: list[Status]) -> bool:
            return bool(found) and found[-1].rejects.get("not_msgpack", 0) == 1

        status = collect(statuses, Status, told)[-1]
        assert 0 < status.rejects["too_large"] <= 300
        assert resident_bytes(preprocessor) - begun_bytes < 256 * 2 * most + 50_000_000
        postures = client.listen(keys.pattern(keys.POSTURE, client.sensor))
        put_all(client, PREPROCESSOR.messages())
        assert collect(postures, Posture, bool)[0].valid
