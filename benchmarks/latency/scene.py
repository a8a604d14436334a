"""What is put, and when: the simulated scene's frames and marks, objects as a tracker puts them, and bare payloads."""

import heapq
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping

import msgpack
import numpy as np
from benchmarks.latency.stopwatch import Stopwatch

from actum import codec, keys
from actum.messages import Message, Objects, Segment, Skeleton, TrackedObject, Truth
from actum.runtime import Client
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream
from som_classifier.model import Model
from som_classifier.node import SomClassifier

SENSOR = "kinect0"
REPETITIONS = 6
MILLISECOND_NS = 1_000_000
MARK_AFTER_NS, BARE_AFTER_NS, OBJECTS_AFTER_NS = 8 * MILLISECOND_NS, 17 * MILLISECOND_NS, 40 * MILLISECOND_NS
BARE_SIZES = {
    "bench/frame/0": "skeleton",
    "bench/frame/1": "posture",
    "bench/frame/2": "action",
    "bench/mark/0": "segment",
    "bench/mark/1": "action",
    "bench/mark/2": "event",
}
"""Keys of the bare chains, each with the stream whose size its payload has."""
Due = tuple[int, Callable[[], None]]
"""What is to be done, after its offset from the beginning (ns)."""


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


def play(agenda: Iterable[Due]) -> None:
    """Do everything when it is due."""
    began_ns = time.perf_counter_ns()
    todo = [(offset_ns, number, put) for number, (offset_ns, put) in enumerate(agenda)]
    heapq.heapify(todo)
    while todo:
        offset_ns, _, put = heapq.heappop(todo)
        time.sleep(max(began_ns + offset_ns - time.perf_counter_ns(), 0) / 1e9)
        put()


def ours(put: Callable[[Message], None], watch: Stopwatch) -> Iterator[Due]:
    """List what is put of ours; objects with every second frame."""
    frame = 0
    for message in stream():
        at_ns = message.stamp_ns
        if isinstance(message, Segment):
            mark = message.model_copy(update={"stamp_ns": None})
            yield at_ns + MARK_AFTER_NS, noted(put, watch, "mark", mark.segment_id, mark)
            continue
        yield at_ns, noted(put, watch, "frame", at_ns, message)
        if frame % 2 == 0:
            yield at_ns + OBJECTS_AFTER_NS, noted(put, watch, "objects", at_ns, objects(at_ns))
        frame += 1


def bare(client: Client, watch: Stopwatch, sizes: Mapping[str, int]) -> Iterator[Due]:
    """List the bare payloads, one halfway between two frames and one after each end mark."""
    payload = {key: bytes(sizes[name]) for key, name in BARE_SIZES.items() if key.endswith("/0")}

    def due(key: str, name: object) -> Callable[[], None]:
        def put() -> None:
            watch.put(key.rpartition("/")[0], name)
            client.put_raw(key, payload[key], attachment=msgpack.packb(name))

        return put

    for message in stream():
        if not isinstance(message, Segment):
            yield message.stamp_ns + BARE_AFTER_NS, due("bench/frame/0", message.stamp_ns)
        elif message.kind == "end" and message.stamp_ns is not None:
            yield message.stamp_ns + MARK_AFTER_NS + BARE_AFTER_NS, due("bench/mark/0", message.segment_id)


def noted(
    put: Callable[[Message], None], watch: Stopwatch, what: str, name: object, message: Message
) -> Callable[[], None]:
    """Put a message of ours, and note when."""

    def note_and_put() -> None:
        watch.put(what, name)
        put(message)

    return note_and_put


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
    return Objects(stamp_ns=stamp_ns, sensor=SENSOR, objects=placed)
