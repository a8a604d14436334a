"""From a picture's capture to the event, through live processes, beside the pose model's own time.

A clip of a real person is played to and fro as a camera of 640x480 at 30 frames/s. All five services run, as they would
with one webcam and printed markers. Needs ACTUM_DATA, ACTUM_POSE_MODEL and the extra `camera`.
"""

import os
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Literal

import cv2
import zenoh
from benchmarks.latency.__main__ import trained
from benchmarks.latency.stopwatch import percentiles
from benchmarks.originals import original
from rich.console import Console
from rich.table import Table

from actum import codec, keys
from actum.messages import Action, Event, Message, Segment, Skeleton
from actum.node import SECOND_NS
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.supervising import Supervisor
from sensor_gateway.devices.video import pictures_of
from sensor_gateway.people.pose_estimator import PoseEstimator

SETTINGS = ServiceSettings(connect="tcp/127.0.0.1:7458")
CLIP = "florence3d_rgb/GestureRecording_Id1actor1idAction1category1.mp4"
SIZE = 640, 480
FRAMES_PER_SECOND = 30
SECONDS = 30
ALONE_FRAMES = 200
SEGMENT_FRAMES, PAUSE_FRAMES, LEAD_IN_FRAMES = 30, 5, 60
HALF_FRAME_NS = SECOND_NS // FRAMES_PER_SECOND // 2
PATIENCE_S = 4.0
ROWS = (
    ("capture → image put and received", keys.COLOR),
    ("capture → skeleton", keys.SKELETON),
    ("capture → posture", keys.POSTURE),
    ("capture → partial action", keys.ACTION),
    ("capture of a segment's last picture → event", keys.EVENT),
)


class Stopwatch:
    """How long after its capture what a picture led to arrived, milliseconds; stamps are this machine's clock."""

    def __init__(self) -> None:
        self.took_ms: dict[str, list[float]] = defaultdict(list)
        self.skeletons: list[tuple[int, int]] = []
        self.last_pictures_ns: dict[str, int] = {}
        self._lock = threading.Lock()

    def arrived(self, sample: zenoh.Sample) -> None:
        """Note what arrives."""
        now_ns = time.time_ns()
        message = codec.decode(str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding))
        with self._lock:
            if not (isinstance(message, Action) and message.final):
                captured_ns = self._captured_ns(message)
                self.took_ms[keys.address_of(message).topic.leaf].append((now_ns - captured_ns) / 1e6)
            if isinstance(message, Skeleton):
                self.skeletons.append((message.stamp_ns, now_ns))

    def _captured_ns(self, message: Message) -> int:
        return self.last_pictures_ns[message.segment_id] if isinstance(message, Event) else message.stamp_ns


def main() -> None:
    """Run everything and print the table."""
    os.environ.update(processes.common(SETTINGS))
    pose_model = Path(os.environ["ACTUM_POSE_MODEL"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        video = write_video(original(CLIP), folder / "camera.avi")
        alone = {people: list(alone_ms(video, pose_model, people)) for people in (1, 2)}
        trained(folder)
        watch = live(folder, video)
    console = Console(highlight=False, width=110)
    console.print(table(alone, watch))
    arrivals_ns = [at_ns for _, at_ns in watch.skeletons[LEAD_IN_FRAMES:]]
    rate = (len(arrivals_ns) - 1) / (arrivals_ns[-1] - arrivals_ns[0]) * 1e9
    events = len(watch.took_ms[keys.EVENT.leaf])
    console.print(
        f"{rate:.1f} skeletons/s of {FRAMES_PER_SECOND} pictures/s (aim: 15), {events} events, {os.cpu_count()} cores"
    )


def write_video(clip: Path, path: Path) -> Path:
    """Write a clip to and fro until it is long enough, as the JPEGs that a webcam gives."""
    once = [picture.image_bgr for picture in pictures_of(clip)]
    to_and_fro = once + once[-2:0:-1]
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), FRAMES_PER_SECOND, SIZE)
    for i in range(SECONDS * FRAMES_PER_SECOND):
        writer.write(to_and_fro[i % len(to_and_fro)])
    writer.release()
    return path


def alone_ms(video: Path, pose_model: Path, people: int) -> Iterator[float]:
    """Time the pose model on the video's pictures and nothing else."""
    with PoseEstimator(pose_model, people) as estimator:
        for number, picture in zip(range(ALONE_FRAMES), pictures_of(video), strict=False):
            began_ns = time.perf_counter_ns()
            estimator.people(picture.image_bgr, picture.stamp_ns)
            if number >= FRAMES_PER_SECOND:
                yield (time.perf_counter_ns() - began_ns) / 1e6


def live(folder: Path, video: Path) -> Stopwatch:
    """Play the video through the processes, with marks."""
    watch = Stopwatch()
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "log"))
        supervisor.start(processes.router(SETTINGS), *processes.services(SETTINGS, folder / "model.npz", {}))
        client = stack.enter_context(Client(SETTINGS, wait_s=30.0))
        for topic in (keys.SEGMENT, keys.SKELETON, keys.OBJECTS, keys.COLOR):
            assert client.wait_for_subscriber(topic, 30.0)
        for _, topic in ROWS:
            client.tap(keys.pattern(topic), watch.arrived)
        supervisor.start(processes.gateway(SETTINGS, ["--source", "camera", "--camera", str(video)]))
        while not watch.skeletons:
            time.sleep(0.01)
        mark(client, watch, watch.skeletons[0][0])
        time.sleep(PATIENCE_S)
    return watch


def mark(client: Client, watch: Stopwatch, first_ns: int) -> None:
    """Mark segments a second ahead: each ends just before a picture, whose capture is what the event is late by."""
    first = LEAD_IN_FRAMES
    while first + SEGMENT_FRAMES < SECONDS * FRAMES_PER_SECOND:
        segment_id, last_ns = f"s{first}", stamp_of(first_ns, first + SEGMENT_FRAMES)
        watch.last_pictures_ns[segment_id] = last_ns
        time.sleep(max(stamp_of(first_ns, first) - time.time_ns(), 0) / SECOND_NS)
        bounds: dict[Literal["start", "end"], int] = {"start": stamp_of(first_ns, first), "end": last_ns}
        for kind, stamp_ns in bounds.items():
            client.put(
                Segment(
                    stamp_ns=stamp_ns - HALF_FRAME_NS, sensor=client.sensor, kind=kind, segment_id=segment_id, agent=1
                )
            )
        first += SEGMENT_FRAMES + PAUSE_FRAMES


def stamp_of(first_ns: int, frame: int) -> int:
    """Tell when a picture is captured."""
    return first_ns + round(frame * SECOND_NS / FRAMES_PER_SECOND)


def table(alone: dict[int, list[float]], watch: Stopwatch) -> Table:
    """Lay the percentiles out."""
    result = Table("milliseconds", title="from a picture's capture to the event, and the pose model's own time")
    for heading in ("p50", "p95", "p99"):
        result.add_column(heading, justify="right")
    for people, took_ms in alone.items():
        title = f"the pose model alone, {people} looked for, one there"
        result.add_row(title, *map("{:.1f}".format, percentiles(took_ms)))
    for title, topic in ROWS:
        result.add_row(title, *map("{:.1f}".format, percentiles(watch.took_ms[topic.leaf])))
    return result


if __name__ == "__main__":
    main()
