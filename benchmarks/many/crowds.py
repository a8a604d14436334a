"""Crowds before several sensors, live: latency of partial actions, what is dropped, and labels beside those offline."""

import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from threading import Thread

import numpy as np
import psutil
from benchmarks.latency.running import STARTING_S

from actum import keys
from actum.codec import Frame, encode
from actum.messages import Action, Message, Status
from actum.node import Numbering
from actum.runtime import Client
from actum.runtime.inbox import Received
from actum.settings import NodeSettings
from actum_command import processes
from actum_command.supervising import Supervisor
from som_classifier.model_loading import load_model

from .scenes import Answer, answer, answers, crowd

SENSORS = tuple(f"sensor{number}" for number in range(1, 6))
SETTINGS = NodeSettings(connect="tcp/127.0.0.1:7467", sensor=",".join(SENSORS))
SECONDS = 30.0
"""Length of a run (s): several actions of everybody."""
SETTLING_S = 5.0
"""How long answers may take after the last frame (s)."""
SERVICES = ("pose_preprocessor", "som_classifier")


class Watch:
    """Notes when skeletons are put, when partial actions arrive, and what final ones say."""

    def __init__(self) -> None:
        self.put_s: dict[tuple[str, int], float] = {}
        self.latencies_ms: list[float] = []
        self.answers: defaultdict[str, dict[str, Answer]] = defaultdict(dict)
        self.twice = 0
        self.drops: dict[tuple[str, str], dict[str, int]] = {}
        self.rejects: dict[tuple[str, str], dict[str, int]] = {}

    def hear(self, received: Received) -> None:
        """Take one message."""
        now_s = time.perf_counter()
        match received.message:
            case Action(final=True) as message:
                self.twice += message.segment_id in self.answers[message.sensor]
                self.answers[message.sensor][message.segment_id] = answer(message)
            case Action() as message:
                self.latencies_ms.append(1e3 * (now_s - self.put_s[message.sensor, message.stamp_ns]))
            case Status() as message:
                self.drops[message.sensor, message.service] = message.drops
                self.rejects[message.sensor, message.service] = message.rejects


def live(people: int, model: Path) -> Iterator[str]:
    """Show `people` before five sensors to one preprocessor and one classifier; yield a row of the table."""
    scenes = {sensor: crowd(sensor, people, 20 * n, SECONDS) for n, sensor in enumerate(SENSORS)}
    expected = {sensor: answers(scene, load_model(model)) for sensor, scene in scenes.items()}
    encoded = {sensor: _encoded(scene) for sensor, scene in scenes.items()}
    watch = Watch()
    with ExitStack() as stack:
        programs = [each for each in processes.services(SETTINGS, model, {}) if each.name in SERVICES]
        first = SETTINGS.of_each_sensor[0]
        supervisor = stack.enter_context(Supervisor(model.with_name("many.log")))
        for program in (processes.router(first), *programs):
            supervisor.start(program)
        client = stack.enter_context(Client(first, wait_s=STARTING_S))
        for topic in (keys.ACTION, keys.STATUS):
            client.follow(keys.pattern(topic), watch.hear)
        _wait_for_all(stack)
        began_s = time.perf_counter() + 1.0
        putting = [  # each sensor's frames come at another time of the thirtieth of a second
            Thread(target=_put, args=(client, sensor, frames, watch, began_s + number / (30 * len(SENSORS))))
            for number, (sensor, frames) in enumerate(encoded.items())
        ]
        before_s = _cpu_s(supervisor)
        for thread in putting:
            thread.start()
        for thread in putting:
            thread.join()
        time.sleep(SETTLING_S)
        cores = {name: (after_s - before_s[name]) / SECONDS for name, after_s in _cpu_s(supervisor).items()}
    yield _row(people, watch, expected, cores)


def _row(people: int, watch: Watch, expected: dict[str, dict[str, Answer]], cores: dict[str, float]) -> str:
    p50, p99 = np.percentile(watch.latencies_ms, [50, 99])
    asked = [(sensor, name) for sensor, each in expected.items() for name in each]
    alike = sum(watch.answers[sensor].get(name) == expected[sensor][name] for sensor, name in asked)
    lost = Counter[str]()
    for counts in (*watch.drops.values(), *watch.rejects.values()):
        lost.update(counts)
    return (
        f"| {people * len(SENSORS)} | {p50:.1f} | {p99:.1f} | {len(watch.latencies_ms)} | {sum(lost.values())} | "
        f"{alike} of {len(asked)} | {watch.twice} | {', '.join(f'{name} {share:.2f}' for name, share in cores.items())} |"
    )


def _cpu_s(supervisor: Supervisor) -> dict[str, float]:
    """Return the CPU time of each program so far (s)."""
    times = {name: psutil.Process(pid).cpu_times() for pid, name in supervisor.pids().items()}
    return {name: each.user + each.system for name, each in times.items()}


def _wait_for_all(stack: ExitStack) -> None:
    for own in SETTINGS.of_each_sensor:
        client = stack.enter_context(Client(own, wait_s=STARTING_S))
        for topic in (keys.SKELETON, keys.SEGMENT):
            assert client.wait_for_subscriber(topic, STARTING_S), f"nobody reads {topic.leaf} of {own.sensor}"


def _encoded(scene: Sequence[Message]) -> list[tuple[int, Frame]]:
    """Return each message of a scene, encoded, with its stamp."""
    numbering = Numbering()
    return [(message.stamp_ns or 0, encode(message, seq=numbering.number(message))) for message in scene]


def _put(client: Client, sensor: str, scene: Sequence[tuple[int, Frame]], watch: Watch, began_s: float) -> None:
    """Put a scene as it is captured."""
    for stamp_ns, frame in scene:
        time.sleep(max(began_s + stamp_ns / 1e9 - time.perf_counter(), 0.0))
        watch.put_s[sensor, stamp_ns] = time.perf_counter()
        client.put_raw(frame.key, frame.payload, frame.encoding, frame.attachment)
