"""Latency per hop at the sensor's pace beside a bare Zenoh chain in the same run, and throughput (make bench).

Router, preprocessor, classifier and fusion run as processes. This program puts the simulated scene's skeletons at 30
frames/s with objects at 15 a second, 40 ms late as a tracker's are, and marks; halfway between two frames it puts a
payload of the same size into a chain of as many bare relays. All times are taken by this process's clock.
"""

import heapq
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from pathlib import Path

import msgpack
import numpy as np
import zenoh
from rich.console import Console
from rich.table import Table
from throughput import frames_per_second

from actum import codec, keys
from actum.messages import Action, Event, Message, Objects, Segment, Skeleton, TrackedObject, Truth
from actum.recording import Recording
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.scene_marks import write_examples
from actum_command.supervising import Supervisor
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.presets import DEFAULT

SETTINGS = ServiceSettings(connect="tcp/127.0.0.1:7457")
REPETITIONS = 6
MILLISECOND_NS = 1_000_000
MARK_AFTER_NS, BARE_AFTER_NS, OBJECTS_AFTER_NS = 8 * MILLISECOND_NS, 17 * MILLISECOND_NS, 40 * MILLISECOND_NS
LEAD_IN_S, PATIENCE_S = 1.0, 5.0
BARE_SIZES = {
    "bench/frame/0": "skeleton",
    "bench/frame/1": "posture",
    "bench/frame/2": "action",
    "bench/mark/0": "segment",
    "bench/mark/1": "action",
    "bench/mark/2": "event",
}
ROWS = (
    ("skeleton → posture", "frame posture", "bench/frame/1"),
    ("skeleton → partial action", "frame action", "bench/frame/2"),
    ("end mark → final action", "mark action", "bench/mark/1"),
    ("end mark → event, without the wait below", "mark event", "bench/mark/2"),
    ("  of which waiting for the objects stream", "wait", None),
)
Times = dict[str, list[float]]


class Stopwatch:
    """When what was put, and how long it took to arrive; milliseconds on one clock."""

    def __init__(self) -> None:
        self.took_ms: Times = defaultdict(list)
        self._put_ns: dict[tuple[str, object], int] = {}
        self._final_ns: dict[str, int] = {}
        self._lock = threading.Lock()

    def put(self, what: str, name: object) -> None:
        """Note that something is put now."""
        self._put_ns[what, name] = time.perf_counter_ns()

    def arrived(self, sample: zenoh.Sample) -> None:
        """Note what arrives, by its key."""
        now_ns = time.perf_counter_ns()
        key = str(sample.key_expr)
        with self._lock:
            if key.startswith("bench/"):
                number = msgpack.unpackb(sample.attachment.to_bytes())
                self._since(key, "/".join(key.split("/")[:2]), number, now_ns)
            else:
                self._ours(codec.decode(key, sample.payload.to_bytes(), str(sample.encoding)), now_ns)

    def _ours(self, message: Message, now_ns: int) -> None:
        match message:
            case Action(final=True):
                self._since("mark action", "mark", message.segment_id, now_ns)
                self._final_ns[message.segment_id] = now_ns
            case Event():
                self._event(message, now_ns)
            case _:
                name = keys.address_of(message).topic.leaf.removesuffix("/{}")
                self._since(f"frame {name}", "frame", message.stamp_ns, now_ns)

    def _event(self, event: Event, now_ns: int) -> None:
        reached_ns = min(
            put for (what, stamp), put in self._put_ns.items() if what == "objects" and stamp >= event.end_ns
        )
        wait_ms = max(reached_ns - self._final_ns.get(event.segment_id, reached_ns), 0) / 1e6
        self.took_ms["wait"].append(wait_ms)
        total_ms = (now_ns - self._put_ns["mark", event.segment_id]) / 1e6
        self.took_ms["mark event"].append(total_ms - wait_ms)

    def _since(self, row: str, what: str, name: object, now_ns: int) -> None:
        if (what, name) in self._put_ns:
            self.took_ms[row].append((now_ns - self._put_ns[what, name]) / 1e6)


def main() -> None:
    """Run everything and print the tables."""
    console = Console(highlight=False, width=110)
    os.environ.update(processes.common(SETTINGS))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = trained(folder)
        sizes = payload_sizes(model)
        watch = live(folder, sizes)
    frames, segments = len(watch.took_ms["bench/frame/2"]), len(watch.took_ms["mark event"])
    console.print(f"{frames} frames at 30/s, {segments} actions; payloads in bytes: {sizes}")
    console.print(latency_table(watch.took_ms))
    rate = frames_per_second(stream(), PosePreprocessor(PoseSettings.defaults()), SomClassifier(model))
    console.print(
        "preprocessor + classifier on one core, codec included, a partial estimate in every frame of a segment:"
    )
    console.print(f"{rate:,.0f} frames/s (aim: 1,500)")


def trained(folder: Path) -> Model:
    """Train the demo's model and leave it as `model.npz`."""
    write_examples(folder / "examples.mcap", repetitions=12, actor=0, seed=1)
    model = train(samples_from([Recording(folder / "examples.mcap")]).usable, DEFAULT)
    model.save(folder / "model.npz")
    return model


def stream() -> list[Message]:
    """Skeletons and marks of the simulated scene; the marks without labels."""
    messages = labelled_stream(Simulator(balanced_programme(REPETITIONS, 2), 0, 2, image_hz=0))
    kept = [message for message in messages if not isinstance(message, Truth)]
    return [m.model_copy(update={"label": None}) if isinstance(m, Segment) else m for m in kept]


def payload_sizes(model: Model) -> dict[str, int]:
    """The median payload of each stream, bytes."""
    sizes: dict[str, list[int]] = defaultdict(list)
    preprocessor, classifier = PosePreprocessor(PoseSettings.defaults()), SomClassifier(model)
    for message in stream()[:300]:
        postures = list(preprocessor.handle(message)) if isinstance(message, Skeleton) else [message]
        actions = [action for posture in postures for action in classifier.handle(posture)]
        for each in (message, *postures, *actions):
            sizes[keys.address_of(each).topic.leaf.removesuffix("/{}")].append(len(codec.encode(each).payload))
    medians = {name: int(np.median(values)) for name, values in sizes.items()}
    return {**medians, "event": medians["action"] + 300}


def live(folder: Path, sizes: Mapping[str, int]) -> Stopwatch:
    """Play the scene through the processes and the bare chain."""
    watch = Stopwatch()
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "log"))
        services = processes.services(SETTINGS, folder / "model.npz", {})
        for program in (processes.router(SETTINGS), *services):
            supervisor.start(program)
        stack.enter_context(bare_chain(sizes))
        client = stack.enter_context(Client(SETTINGS, wait_s=30.0))
        for topic in (keys.SEGMENT, keys.SKELETON, keys.OBJECTS):
            assert client.wait_for_subscriber(topic, 30.0)
        for pattern in (*map(keys.pattern, (keys.POSTURE, keys.ACTION, keys.EVENT)), "bench/**"):
            client.tap(pattern, watch.arrived)
        time.sleep(LEAD_IN_S)
        play(client, watch, sizes)
        time.sleep(PATIENCE_S)
    return watch


@contextmanager
def bare_chain(sizes: Mapping[str, int]) -> Iterator[None]:
    """Run a bare relay for each hop."""
    chain = list(BARE_SIZES)
    hops = [(a, b) for a, b in pairwise(chain) if a.rpartition("/")[0] == b.rpartition("/")[0]]
    relay = Path(__file__).with_name("bare_relay.py")
    running = [subprocess.Popen([sys.executable, str(relay), a, b, str(sizes[BARE_SIZES[b]])]) for a, b in hops]
    try:
        yield
    finally:
        for process in running:
            process.terminate()
        for process in running:
            process.wait()


def play(client: Client, watch: Stopwatch, sizes: Mapping[str, int]) -> None:
    """Put everything when it is due."""
    began_ns = time.perf_counter_ns()
    todo = [(offset_ns, number, put) for number, (offset_ns, put) in enumerate(agenda(client, watch, sizes))]
    heapq.heapify(todo)
    while todo:
        offset_ns, _, put = heapq.heappop(todo)
        time.sleep(max(began_ns + offset_ns - time.perf_counter_ns(), 0) / 1e9)
        put()


def agenda(client: Client, watch: Stopwatch, sizes: Mapping[str, int]) -> Iterator[tuple[int, Callable[[], None]]]:
    """List what is to be put at which offset from the beginning."""
    bare = {key: bytes(sizes[stream]) for key, stream in BARE_SIZES.items() if key.endswith("/0")}
    frame = 0
    for message in stream():
        at_ns = message.stamp_ns
        if isinstance(message, Segment):
            mark = message.model_copy(update={"stamp_ns": None})
            yield at_ns + MARK_AFTER_NS, ours(client, watch, "mark", mark.segment_id, mark)
            if mark.kind == "end":
                bare_mark = theirs(client, watch, "bench/mark/0", mark.segment_id, bare["bench/mark/0"])
                yield at_ns + MARK_AFTER_NS + BARE_AFTER_NS, bare_mark
            continue
        yield at_ns, ours(client, watch, "frame", at_ns, message)
        yield at_ns + BARE_AFTER_NS, theirs(client, watch, "bench/frame/0", at_ns, bare["bench/frame/0"])
        if frame % 2 == 0:
            yield at_ns + OBJECTS_AFTER_NS, ours(client, watch, "objects", at_ns, objects(at_ns))
        frame += 1


def ours(client: Client, watch: Stopwatch, what: str, name: object, message: Message) -> Callable[[], None]:
    """Put a message of ours, and note when."""

    def put() -> None:
        watch.put(what, name)
        client.put(message)

    return put


def theirs(client: Client, watch: Stopwatch, key: str, name: object, payload: bytes) -> Callable[[], None]:
    """Put a bare payload, and note when."""

    def put() -> None:
        watch.put(key.rpartition("/")[0], name)
        client.put_raw(key, payload, attachment=msgpack.packb(name))

    return put


def objects(stamp_ns: int) -> Objects:
    """Three objects in front of the person."""
    placed = [
        TrackedObject(
            id=number,
            name=f"object {number}",
            position_m=[0.2 * number, 0.3, 1.7],
            quaternion_xyzw=[0.0, 0.0, 0.0, 1.0],
            confidence=1.0,
            seen=True,
        )
        for number in (1, 2, 3)
    ]
    return Objects(stamp_ns=stamp_ns, sensor=SETTINGS.sensor, objects=placed)


def latency_table(took_ms: Times) -> Table:
    """Percentiles of each hop beside the bare chain's, and the ratio of the medians."""
    table = Table("milliseconds", title="latency, and a bare Zenoh chain of the same hops and sizes in the same run")
    for heading in ("p50", "p95", "p99", "bare p50", "p95", "p99", "p50 ratio"):
        table.add_column(heading, justify="right")
    for title, row, bare in ROWS:
        here = percentiles(took_ms[row])
        there = percentiles(took_ms[bare]) if bare else []
        ratio = f"{here[0] / there[0]:.2f}" if there else ""
        table.add_row(
            title, *map("{:.2f}".format, here), *(map("{:.2f}".format, there) if there else ("", "", "")), ratio
        )
    return table


def percentiles(values_ms: Sequence[float]) -> list[float]:
    """The median and the tail."""
    result: list[float] = np.percentile(values_ms, [50, 95, 99]).tolist()
    return result


if __name__ == "__main__":
    main()
