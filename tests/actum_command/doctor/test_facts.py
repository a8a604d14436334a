"""What doctor prints that is no problem: who serves whom, and how long a hop takes."""

from actum import keys
from actum_command.doctor.diagnosis import who_serves_whom
from actum_command.doctor.heard import Heard, Watched, shared
from actum_command.doctor.stream_checks import FEWEST_PAIRS, hops

MILLISECOND_NS = 1_000_000
FRAME_NS = 33 * MILLISECOND_NS


def member(sensor: str, instance: str) -> str:
    return keys.claim_key(keys.Claim("member", instance, "ab12"), sensor, "som_classifier")


def test_each_shared_sensor_has_a_line_with_who_serves_it_and_who_stands_by() -> None:
    tokens = [member(sensor, name) for sensor in ("door", "window") for name in ("north", "south")]
    tokens += [keys.alive("door", "som_classifier", "south"), keys.alive("door", "action_fusion", "alone")]
    lines = list(who_serves_whom(Heard({}, [], {}, {}, shared(tokens))))
    assert lines == [
        "som_classifier of door: served by south; standing by: north",
        "som_classifier of window: served by nobody yet; standing by: north, south",
    ]


def test_a_hop_is_measured_between_messages_of_one_stamp() -> None:
    streams = {topic: Watched() for topic in (keys.SKELETON, keys.POSTURE, keys.ACTION)}
    for number in range(FEWEST_PAIRS):
        stamp_ns, late_ns = number * FRAME_NS, (2 if number else 9) * MILLISECOND_NS
        streams[keys.SKELETON].stamps_ns.append(stamp_ns)
        streams[keys.SKELETON].arrivals_ns.append(stamp_ns)
        streams[keys.POSTURE].stamps_ns.append(stamp_ns)
        streams[keys.POSTURE].arrivals_ns.append(stamp_ns + late_ns)
    [line] = hops(streams)
    assert line.startswith("skeleton → posture: p50 2.0 ms, p99 7.7 ms")
