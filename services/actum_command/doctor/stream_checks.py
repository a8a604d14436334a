"""What is wrong with a sensor's streams, in words: too slow, stopped, repeated, or not reaching who reads them."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

from actum import keys
from actum.keys import Topic
from actum.messages import Info, Status
from actum.states import State
from actum_command.doctor.heard import Heard, Watched

SENSOR = "sensor_gateway"
"""The service that puts skeletons and images."""
READERS: Mapping[str, tuple[Topic, ...]] = {
    "pose_preprocessor": (keys.SKELETON,),
    "marker_tracker": (keys.COLOR,),
    "som_classifier": (keys.POSTURE,),
    "action_fusion": (keys.POSTURE, keys.OBJECTS),
}
"""The streams that each service reads all the time."""
SLOW = 0.6
"""Share of a rate below which it is told: a busy machine delays frames, and they come all the same."""
FEWEST_HZ = 2.0
"""Least rate (Hz) of which missing messages are told: of a slower stream two seconds show too little."""
MEASURED_S = 1.0
"""Least time (s) between two statuses from which rates are measured."""

Statuses = Mapping[str, Sequence[Status]]
"""The statuses that each service has sent meanwhile, in their order."""


def problems(infos: Sequence[Info], statuses: Statuses, streams: Mapping[Topic, Watched]) -> Iterator[str]:
    """Yield what is wrong with the streams of a sensor."""
    topics = (keys.SKELETON, keys.COLOR, *chain(*READERS.values()))
    put_hz = {topic: _put_hz(topic, statuses, streams) for topic in topics}
    yield from _slow_source(infos, put_hz[keys.SKELETON] or streams[keys.COLOR].rate_hz, streams[keys.SKELETON])
    yield from _stopped(statuses)
    yield from _frozen(streams)
    yield from _readers(statuses, put_hz)


def hops(heard: Heard) -> Iterator[str]:
    """Yield how long each hop takes: as the page's service measured it; if there is no page, as heard here."""
    reported = [status.hops for statuses in heard.statuses.values() for status in statuses[-1:] if status.hops]
    where = "in the last minute, measured by web_dashboard" if reported else "measured where doctor runs"
    for hop in reported[0] if reported else heard.hops:
        yield (
            f"latency from {hop.cause} to {hop.effect}: p50 {hop.p50_ms:.1f} ms, p99 {hop.p99_ms:.1f} ms ({hop.count} "
            f"messages {where})"
        )


def handled_hz(statuses: Sequence[Status], topic: Topic) -> float | None:
    """Return how many messages of a topic a service has handled a second; None where it is too early to say."""
    same = [status for status in statuses if status.instance == statuses[-1].instance]
    elapsed_s = same[-1].uptime_s - same[0].uptime_s if same else 0.0
    if elapsed_s < MEASURED_S:
        return None
    return (_handled(same[-1], topic) - _handled(same[0], topic)) / elapsed_s


def _handled(status: Status, topic: Topic) -> int:
    """Return how many messages of a topic were handled since the start, of all people together."""
    prefix = keys.pattern(topic, status.sensor).removesuffix("*")
    return sum(count for key, count in status.handled.items() if key.startswith(prefix))


def _put_hz(topic: Topic, statuses: Statuses, streams: Mapping[Topic, Watched]) -> float:
    """Return how many messages of a topic are put a second: as its source says, or as they come here."""
    said = handled_hz(statuses.get(SENSOR, ()), topic) if topic in (keys.SKELETON, keys.COLOR) else None
    return max(said or 0.0, streams[topic].rate_hz if topic in streams else 0.0)


def _slow_source(infos: Sequence[Info], put_hz: float, skeletons: Watched) -> Iterator[str]:
    for info in infos:
        if info.service == SENSOR and info.rate_hz and 0 < put_hz < SLOW * info.rate_hz:
            yield (
                f"{SENSOR} publishes {put_hz:.0f} frames per second, but its source is set to {info.rate_hz:g} frames "
                "per second. Possible causes: a busy machine, a room that is too dark for short exposures, or a slow "
                "camera cable"
            )
    if 0 < skeletons.rate_hz < SLOW * skeletons.stamped_hz:
        yield (
            f"{skeletons.rate_hz:.0f} skeletons arrive per second, but their time stamps show that the sensor captured "
            f"{skeletons.stamped_hz:.0f} per second: the sensor service or the network is too slow"
        )


def _stopped(statuses: Statuses) -> Iterator[str]:
    gateway = statuses.get(SENSOR, ())
    for topic in (keys.SKELETON, keys.COLOR) if gateway and State.of(gateway[-1].state) is State.RUNNING else ():
        if handled_hz(gateway, topic) == 0 and _handled(gateway[-1], topic):
            yield (
                f"{SENSOR} stopped publishing {topic.leaf} after {_handled(gateway[-1], topic)} messages: restart "
                f"{SENSOR}"
            )


def _frozen(streams: Mapping[Topic, Watched]) -> Iterator[str]:
    for topic, samples in ((keys.SKELETON, "skeletons"), (keys.COLOR, "images")):
        if streams[topic].stands_still:
            yield (
                f"the time stamps of the {samples} do not increase, so services refuse all {samples} but the first: "
                "restart the sensor service"
            )
        elif streams[topic].repeats:
            yield f"all {samples} are identical, so the camera is frozen: unplug the camera and plug it in again"


def _readers(statuses: Statuses, put_hz: Mapping[Topic, float]) -> Iterator[str]:
    for service, topics in READERS.items():
        for topic in topics:
            got_hz, all_hz = handled_hz(statuses.get(service, ()), topic), put_hz[topic]
            if got_hz is None or all_hz < FEWEST_HZ:
                continue
            name = topic.leaf.removesuffix("/{}")
            if got_hz == 0:
                yield (
                    f"{service} receives none of the {all_hz:.0f} messages per second on the topic {name}: check that "
                    f"the role of {service} is allowed to read this topic, and that all routers are connected to each "
                    "other"
                )
            elif got_hz < SLOW * all_hz and topic is not keys.COLOR:
                yield (
                    f"{service} receives only {got_hz:.0f} of the {all_hz:.0f} messages per second on the topic "
                    f"{name}: the machine that runs {service}, or the network, may be too slow"
                )
