"""What doctor prints that is no problem: who serves whom, and how long a hop takes."""

from actum import keys
from actum_command.doctor.diagnosis import who_serves
from actum_command.doctor.heard import Heard, Watched
from actum_command.doctor.stream_checks import FEWEST_PAIRS, hops

MILLISECOND_NS = 1_000_000
FRAME_NS = 33 * MILLISECOND_NS


def test_a_line_says_who_serves_a_shared_sensor_and_who_stands_by() -> None:
    tokens, members = {"som_classifier": ["south"]}, {"som_classifier": ["south", "north"], "action_fusion": ["north"]}
    assert list(who_serves(Heard(tokens, [], {}, {}, members))) == [
        "action_fusion, which is shared: nobody yet serves this sensor; standing by: north",
        "som_classifier, which is shared: south serves this sensor; standing by: north",
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
