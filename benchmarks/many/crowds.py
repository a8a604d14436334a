"""Crowds before several sensors, live: latency of partial actions, what is dropped, and labels beside those offline."""

import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from threading import Thread

import msgpack
import numpy as np
import psutil
import zenoh
from benchmarks.latency.running import STARTING_S

from actum import keys
from actum.codec import Frame, encode
from actum.messages import Message, Status
from actum.node import Numbering
from actum.runtime import Client, Received
from actum.settings import NodeSettings
from actum_command import processes
from actum_command.supervising import Program, Supervisor
from som_classifier.model_loading import load_model

from .scenes import Answer, answers, crowd

SENSORS = tuple(f"sensor{number}" for number in range(1, 6))
SETTINGS = NodeSettings(connect="tcp/127.0.0.1:7467", sensor=",".join(SENSORS))
SECONDS = 30.0
"""Length of a run (s): several actions of everybody."""
SETTLING_S = 5.0
"""How long answers may take after the last frame (s)."""
CROWDS = ((1, 1), (5, 1), (10, 1), (10, 2))
"""People before each sensor, and classifiers."""
HEAD = (
    "| people | classifiers | p50 (ms) | p99 (ms) | dropped or rejected | answers as offline | answered twice "
    "| processors used |\n"
    "|---:|---:|---:|---:|---:|---:|---:|---|"
)
Answers = dict[str, dict[str, Answer]]
"""What is answered, by sensor and segment."""
PREPROCESSOR, CLASSIFIER = "pose_preprocessor", "som_classifier"


class Watch:
    """Notes when skeletons are put, when partial actions arrive, and what final ones say."""

    def __init__(self) -> None:
        self.put_s: dict[tuple[str, int], float] = {}
        self.latencies_ms: list[float] = []
        self.answers: defaultdict[str, dict[str, Answer]] = defaultdict(dict)
        self.twice = 0
        self.drops: dict[tuple[str, str], dict[str, int]] = {}
        self.rejects: dict[tuple[str, str], dict[str, int]] = {}

    def hear_action(self, sample: zenoh.Sample) -> None:
        """Note how late a partial action comes, without the cost of validating it, or what a final one says."""
        now_s, payload = time.perf_counter(), sample.payload.to_bytes()
        fields = msgpack.unpackb(payload)
        if not fields["final"]:
            self.latencies_ms.append(1e3 * (now_s - self.put_s[fields["sensor"], fields["stamp_ns"]]))
            return
        said = self.answers[fields["sensor"]]
        self.twice += fields["segment_id"] in said
        said[fields["segment_id"]] = Answer(*(fields[name] for name in Answer._fields))

    def hear_status(self, received: Received) -> None:
        """Note what a service has lost so far."""
        match received.message:
            case Status() as status:
                self.drops[status.sensor, status.service] = status.drops
                self.rejects[status.sensor, status.service] = status.rejects


def crowds(model: Path) -> Iterator[str]:
    """Yield a table of crowds of several sizes."""
    yield (
        f"{len(SENSORS)} sensors at 30 frames/s for {SECONDS:.0f} s, and one preprocessor for all. One classifier "
        "serves all sensors, or two share them (`--share`). Each action of everybody is marked, and the search for "
        "unmarked actions is on. Latencies are those from the put of a skeleton to the partial action that follows "
        "from it. An answer is as offline if its action, its confidence and its number of frames are those that the "
        "same steps give without any transport."
    )
    rows = [_row(people * len(SENSORS), count, *_live(people, count, model)) for people, count in CROWDS]
    yield "\n".join((HEAD, *rows))


def _live(people: int, classifiers: int, model: Path) -> tuple["Watch", Answers, dict[str, float]]:
    """Show so many people before each sensor; return what was heard, the answers offline, and each program's cores."""
    scenes = {sensor: crowd(sensor, people, 20 * n, SECONDS) for n, sensor in enumerate(SENSORS)}
    expected = {sensor: answers(scene, load_model(model)) for sensor, scene in scenes.items()}
    encoded = {sensor: _encoded(scene) for sensor, scene in scenes.items()}
    watch, first = Watch(), SETTINGS.of_each_sensor[0]
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(model.with_name("crowds.log")))
        supervisor.start(processes.router(first), *_programs(classifiers, model))
        client = stack.enter_context(Client(first, wait_s=STARTING_S))
        client.tap(keys.pattern(keys.ACTION), watch.hear_action)
        client.follow(keys.pattern(keys.STATUS), watch.hear_status)
        _wait_for_all(stack)
        before_s = _cpu_s(supervisor)
        _put_all(client, encoded, watch)
        time.sleep(SETTLING_S)
        cores = {name: (after_s - before_s[name]) / SECONDS for name, after_s in _cpu_s(supervisor).items()}
    return watch, expected, cores


def _programs(classifiers: int, model: Path) -> list[Program]:
    """Return a preprocessor for all sensors, and one classifier for all or several that share them."""
    by_name = {each.name: each for each in processes.services(SETTINGS, model, {})}
    alone = by_name[CLASSIFIER]
    if classifiers == 1:
        return [by_name[PREPROCESSOR], alone]
    names = [f"{CLASSIFIER}-{number}" for number in range(1, classifiers + 1)]
    shared = [replace(alone, name=name, arguments=[*alone.arguments, "--share", "--instance", name]) for name in names]
    return [by_name[PREPROCESSOR], *shared]


def _row(people: int, classifiers: int, watch: Watch, expected: Answers, cores: dict[str, float]) -> str:
    p50, p99 = np.percentile(watch.latencies_ms, [50, 99])
    asked = [(sensor, name) for sensor, each in expected.items() for name in each]
    alike = sum(watch.answers[sensor].get(name) == expected[sensor][name] for sensor, name in asked)
    lost = sum(sum(counts.values()) for counts in (*watch.drops.values(), *watch.rejects.values()))
    used = ", ".join(f"{name} {share:.2f}" for name, share in cores.items())
    cells = (people, classifiers, f"{p50:.1f}", f"{p99:.1f}", lost, f"{alike} of {len(asked)}", watch.twice, used)
    return f"| {' | '.join(map(str, cells))} |"


def _cpu_s(supervisor: Supervisor) -> dict[str, float]:
    """Return the CPU time of each program so far (s)."""
    times = {name: psutil.Process(pid).cpu_times() for pid, name in supervisor.pids().items()}
    return {name: each.user + each.system for name, each in times.items()}


def _wait_for_all(stack: ExitStack) -> None:
    for own in SETTINGS.of_each_sensor:
        client = stack.enter_context(Client(own, wait_s=STARTING_S))
        for topic in (keys.SKELETON, keys.SEGMENT):
            assert client.wait_for_subscriber(topic, STARTING_S), f"nobody reads {topic.leaf} of {own.sensor}"


def _put_all(client: Client, scenes: dict[str, list[tuple[int, Frame]]], watch: Watch) -> None:
    """Put all scenes; each sensor's frames come at another time of the thirtieth of a second."""
    began_s = time.perf_counter() + 1.0
    putting = [
        Thread(target=_put, args=(client, sensor, frames, watch, began_s + number / (30 * len(SENSORS))))
        for number, (sensor, frames) in enumerate(scenes.items())
    ]
    for thread in putting:
        thread.start()
    for thread in putting:
        thread.join()


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
